#include "server/lab/contact/bumper_bench.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace handrail {
namespace {

constexpr int kSubsteps = 10;                            // of the world, a cycle
constexpr double kHold = 20.0;                           // either hold [s]
constexpr double kSlide = 1.0;                           // there, and back again [s]
constexpr double kOut = 0.1, kRetreat = 4.0;             // [s]
constexpr double kLast = 1.0;                            // of a hold, judged [s]
constexpr double kFastestSlide = 0.05, kDeepest = 0.25;  // [m/s], [m]

// Out of the surface: no axis of the base frame, so that nothing is right by chance.
const Vec3 kNormal = Vec3(0.36, -0.48, 0.8);

// Holds values back for a number of steps.
class Delay {
 public:
  explicit Delay(int steps) : line_(static_cast<std::size_t>(steps) + 1, Vec3::Zero()) {}
  void fill(const Vec3& v) { std::fill(line_.begin(), line_.end(), v); }
  const Vec3& pass(const Vec3& v) {
    line_[at_] = v;
    at_ = (at_ + 1) % line_.size();
    return line_[at_];
  }

 private:
  std::vector<Vec3> line_;
  std::size_t at_ = 0;
};

// A plane through the origin whose friction sticks by a spring as stiff as the contact.
class Surface {
 public:
  Surface(const Vec3& n, double stiffness, double friction)
      : n_(n), stiffness_(stiffness), friction_(friction) {}

  // Force on the tip that moved to `p` [N].
  Vec3 force(const Vec3& p) {
    const Vec3 moved = p - last_;
    last_ = p;
    const double depth = -p.dot(n_);
    if (depth <= 0.0) {
      stretch_.setZero();
      return Vec3::Zero();
    }
    stretch_ += moved - moved.dot(n_) * n_;
    const double length = stretch_.norm(), most = friction_ * depth;
    if (length > most) stretch_ *= most / length;
    return stiffness_ * (depth * n_ - stretch_);
  }

 private:
  Vec3 n_;
  double stiffness_, friction_;
  Vec3 last_ = Vec3::Zero();
  Vec3 stretch_ = Vec3::Zero();
};

// Range and mean of a signal.
class Swing {
 public:
  void add(double v) {
    low_ = std::min(low_, v);
    high_ = std::max(high_, v);
    sum_ += v;
    ++count_;
  }
  double swing() const { return high_ - low_; }
  double mean() const { return count_ > 0 ? sum_ / count_ : 0.0; }

 private:
  double low_ = 1e12, high_ = -1e12, sum_ = 0.0;
  int count_ = 0;
};

// One push: world and arm, a substep at a time.
class Bench {
 public:
  Bench(const BumperSettings& settings, const BumperCase& of)
      : settings_(settings),
        of_(of),
        surface_(kNormal, of.stiffness, of.friction),
        late_command_(steps_of(of.late_sensor ? 0.0 : of.delay)),
        late_force_(steps_of(of.late_sensor ? of.delay : 0.0)),
        follow_(of.servo_lag > 0.0 ? 1.0 - std::exp(-of.cycle / kSubsteps / of.servo_lag) : 1.0) {
    settings_.sensor_lag = of.late_sensor ? of.delay : 0.0;
    const Mat3 axes =
        (Mat3() << kNormal.unitOrthogonal(), kNormal.cross(kNormal.unitOrthogonal()), kNormal)
            .finished();
    const double away = std::max(1e-3, 0.4 * of.speed);
    const double depth = of.gentle ? 30.0 / of.stiffness : std::max(3e-3, 150.0 / of.stiffness);
    into_ = of.slanted ? Vec3((axes.col(0) - kNormal) * std::sqrt(0.5)) : Vec3(-kNormal);
    along_ = (axes.col(0) + 2.0 * axes.col(1)).normalized();
    p_SU_ = p_SB_ = p_ST_ = away * kNormal;
    late_command_.fill(p_SB_);
    cycle_ago_.fill(p_ST_);
    if (settings.promise > 0.0) {
      allowed_ = approach_speed(settings, settings.promise - settings.threshold, delay(), of.cycle);
    }
    const double way = (away + std::min(depth, kDeepest)) / -into_.dot(kNormal);
    hold_ = way / of.speed;
    slide_ = way / std::min(of.speed, allowed_) + kHold;
    hold_again_ = slide_ + 2.0 * kSlide;
    out_ = hold_again_ + kHold;
    // No faster than the promise lets the arm follow.
    along_speed_ = std::min({of.speed, kFastestSlide, 0.5 * allowed_});
    retreat_ = std::min(kOut, 0.5 * allowed_);
    end_ = out_ + kRetreat + (retreat_ < kOut ? 2.0 * way / retreat_ : 0.0);
  }

  BumperRun run() {
    const int cycles = static_cast<int>(end_ / of_.cycle);
    for (int i = 0; i < cycles; ++i) cycle(i * of_.cycle);
    run_.swing = std::max(first_.swing(), second_.swing());
    run_.settled = second_.mean();
    run_.released = p_SB_ == p_SU_;
    return run_;
  }

 private:
  int steps_of(double seconds) const {
    return static_cast<int>(std::lround(seconds / of_.cycle * kSubsteps));
  }

  // What the law takes for the delay [s].
  double delay() const { return (of_.delay + of_.servo_lag) * (1.0 + of_.lag_error); }

  void command(double t) {
    if (t < hold_) {
      p_SU_ += of_.cycle * of_.speed * into_;
    } else if (t >= slide_ && t < hold_again_) {
      p_SU_ += of_.cycle * (t < slide_ + kSlide ? along_speed_ : -along_speed_) * along_;
    } else if (t >= out_) {
      p_SU_ += of_.cycle * retreat_ * kNormal;
    }
  }

  void cycle(double t) {
    command(t);
    BumperInput in;
    in.p_SU = p_SU_;
    in.f_E_S = f_measured_ + of_.noise * Vec3(normal_(random_), normal_(random_), normal_(random_));
    in.p_last = p_SB_;
    in.p_ST = p_ST_;
    in.delay = delay();
    in.dt = of_.cycle;
    p_SB_ = bump(settings_, in, state_).p_SB;
    if (in.f_E_S.norm() > settings_.threshold) {
      run_.inward = std::max(run_.inward, (in.p_last - p_SB_).dot(kNormal));
    }
    for (int i = 0; i < kSubsteps; ++i) substep(t + i * of_.cycle / kSubsteps);
  }

  void substep(double t) {
    p_ST_ += follow_ * (late_command_.pass(p_SB_) - p_ST_);
    const Vec3 f = surface_.force(p_ST_);
    f_measured_ = late_force_.pass(f);
    const double force = f.dot(kNormal);
    const Vec3 moved = p_ST_ - std::exchange(cycle_ago_[newest_], p_ST_);
    newest_ = (newest_ + 1) % cycle_ago_.size();
    if (run_.peak == 0.0 && force > 0.0) {
      run_.share = moved.norm() / (of_.cycle * std::min(of_.speed, allowed_));
    }
    run_.peak = std::max(run_.peak, force);
    if (t >= slide_ - kLast && t < slide_) first_.add(force);
    if (t >= out_ - kLast && t < out_) second_.add(force);
    if (t >= slide_ && t < hold_again_) {
      if (force <= 0.0 && !off_) ++run_.hops;
      off_ = force <= 0.0 || (off_ && force <= 1.0);
    }
  }

  BumperSettings settings_;
  BumperCase of_;
  Surface surface_;
  Delay late_command_, late_force_;
  double follow_;
  Vec3 into_, along_;
  double hold_ = 0.0, slide_ = 0.0, hold_again_ = 0.0, out_ = 0.0;  // when each part begins [s]
  double end_ = 0.0;
  double allowed_ = 1e9, along_speed_ = 0.0, retreat_ = kOut;  // [m/s]
  Vec3 p_SU_, p_SB_, p_ST_, f_measured_ = Vec3::Zero();
  std::array<Vec3, kSubsteps> cycle_ago_{};  // measured tip
  std::size_t newest_ = 0;
  BumperState state_;
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
  Swing first_, second_;
  bool off_ = false;
  BumperRun run_;
};

}  // namespace

double peak_bound(const BumperSettings& settings, const BumperCase& of) noexcept {
  return settings.threshold + of.stiffness * of.speed * (of.delay + of.servo_lag + 2.5 * of.cycle);
}

BumperRun run_bumper(const BumperSettings& settings, const BumperCase& of) {
  return Bench(settings, of).run();
}

}  // namespace handrail
