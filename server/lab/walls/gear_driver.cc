#include "server/lab/walls/gear_driver.h"

#include <algorithm>

#include "devices/hand/min_jerk.h"

namespace handrail {
namespace {

constexpr double kReach = 0.4;        // a move takes this and [s]
constexpr double kSpeed = 0.11;       // its length over this [m/s]
constexpr double kRest = 0.5;         // in gear [s]
constexpr double kPatience = 3.0;     // for a lock to close [s]
constexpr double kLongestWay = 10.0;  // of a lever let go [s]
constexpr double kGiveWay = 4e-3;     // to the force felt, letting go [m/N]
constexpr double kThere = 0.010;      // nearer than this is where it should be [m]

}  // namespace

GearDriver::GearDriver(const GearGate& gate, double pace)
    : gate_(gate), pace_(pace), p_(gate.neutral()) {
  set_out(kRest);
}

void GearDriver::set_out(double t) {
  const bool home = next_ == gate_.places().size();
  const Vec2 from = next_ == 0 ? gate_.neutral() : gate_.places()[next_ - 1];
  const Vec2 to = home ? Vec2(from.x(), gate_.neutral().y()) : gate_.places()[next_];
  way_ = gate_.way(from, to);
  length_ = 0.0;
  for (std::size_t i = 1; i < way_.size(); ++i) length_ += (way_[i] - way_[i - 1]).norm();
  duration_ = (kReach + length_ / kSpeed) / pace_;
  phase_ = Phase::kMove;
  since_ = t;
}

void GearDriver::go(double t, const WallTick& tick) {
  const MinJerk move(VectorMotion{}, Vec3(length_, 0.0, 0.0), duration_);
  const VectorMotion along = move.at(std::max(t - since_, 0.0));
  double left = along.p.x();
  std::size_t i = 1;
  while (i + 1 < way_.size() && left > (way_[i] - way_[i - 1]).norm()) {
    left -= (way_[i] - way_[i - 1]).norm();
    ++i;
  }
  const Vec2 tangent = (way_[i] - way_[i - 1]).normalized();
  p_ = way_[i - 1] + left * tangent;
  v_ = along.v.x() * tangent;
  // Nobody lets go of a lever that is still in gear.
  const bool home = next_ == gate_.places().size();
  if (t - since_ < duration_ || (home && (tick.hand - p_).norm() > kThere)) return;
  phase_ = home ? Phase::kLetGo : Phase::kFeel;
  since_ = locked_since_ = t;
}

void GearDriver::drive(const WallTick& tick) {
  const double t = tick.t;
  if (phase_ == Phase::kMove) {
    go(t, tick);
  } else if (phase_ == Phase::kFeel) {
    if (!tick.effects.locked) locked_since_ = t;
    if (t - locked_since_ < kRest && t - since_ < kPatience) return;
    ++next_;
    set_out(t);
  } else {
    p_ = tick.hand - kGiveWay * tick.handle;
    v_ = tick.velocity;
    rest_.see(tick);
    if (rest_.rests() || t - since_ > kLongestWay) phase_ = Phase::kDone;
  }
}

}  // namespace handrail
