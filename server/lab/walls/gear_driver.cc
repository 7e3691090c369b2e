#include "server/lab/walls/gear_driver.h"

#include <algorithm>

#include "devices/hand/min_jerk.h"

namespace handrail {
namespace {

constexpr double kGearReach = 0.4;    // a move takes this and [s]
constexpr double kSpeed = 0.11;       // its length over this [m/s]
constexpr double kRest = 0.5;         // in gear [s]
constexpr double kPatience = 3.0;     // for a lock to close, for the lever to come along [s]
constexpr double kLongestWay = 10.0;  // of a lever let go [s]
constexpr double kThere = 0.010;      // nearer than this is where it should be [m]

}  // namespace

GearDriver::GearDriver(const GearGate& gate, double pace)
    : gate_(gate), pace_(pace), p_(gate.neutral()) {
  set_out(Phase::kMove, gate.neutral(), gate.places()[0], kRest);
}

Vec2 GearDriver::foot() const { return {gate_.places()[next_].x(), gate_.neutral().y()}; }

void GearDriver::set_out(Phase phase, const Vec2& from, const Vec2& to, double t) {
  way_ = gate_.way(from, to);
  length_ = 0.0;
  for (std::size_t i = 1; i < way_.size(); ++i) length_ += (way_[i] - way_[i - 1]).norm();
  duration_ = (kGearReach + length_ / kSpeed) / pace_;
  phase_ = phase;
  since_ = t;
}

void GearDriver::set_out_for_next(double t) {
  const Vec2 from = gate_.places()[next_];
  const Vec2 out = foot();
  tries_ = 0;
  ++next_;
  set_out(Phase::kMove, from, home() ? out : gate_.places()[next_], t);
}

void GearDriver::go(const WallTick& tick) {
  const double t = tick.t;
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
  const double over = t - since_ - duration_;
  if (over < 0.0) return;
  if (phase_ == Phase::kBack) {
    set_out(Phase::kMove, foot(), gate_.places()[next_], t);
    return;
  }
  // Nobody lets go of a lever that is still in gear.
  if (home() && (tick.hand - p_).norm() > kThere && over < kPatience) return;
  phase_ = home() ? Phase::kLetGo : Phase::kFeel;
  since_ = locked_since_ = t;
}

void GearDriver::feel(const WallTick& tick) {
  const double t = tick.t;
  if (!tick.effects.locked) locked_since_ = t;
  if (t - locked_since_ >= kRest) {
    set_out_for_next(t);
  } else if (t - since_ >= kPatience) {
    if (++tries_ < kTries) {
      set_out(Phase::kBack, gate_.places()[next_], foot(), t);
    } else {
      set_out_for_next(t);
    }
  }
}

void GearDriver::drive(const WallTick& tick) {
  if (phase_ == Phase::kMove || phase_ == Phase::kBack) {
    go(tick);
  } else if (phase_ == Phase::kFeel) {
    feel(tick);
  } else {
    p_ = tick.hand;
    v_ = tick.velocity;
    rest_.see(tick);
    if (rest_.rests() || tick.t - since_ > kLongestWay) phase_ = Phase::kDone;
  }
}

}  // namespace handrail
