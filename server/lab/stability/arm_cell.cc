#include "server/lab/stability/arm_cell.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "devices/omni/omni_data.h"
#include "server/base/units.h"
#include "server/kinematics/arm_of.h"
#include "server/lab/faults/audit/joint_audit.h"
#include "server/lab/stability/bench_device.h"
#include "server/lab/stability/whole_loop.h"
#include "server/model/rv2a_limits.h"

namespace handrail {
namespace {

constexpr double kArmGrip = 250.0;     // the middle of what is published [N/m]
constexpr double kArmTurning = 2.0;    // of the stylus at most, chosen: a quick wrist [rad/s]
constexpr double kPeakOfMean = 1.875;  // of a minimum-jerk move's speed
constexpr double kArmSettle = 1.0;     // before a kick [s]
constexpr double kArmKick = 0.5;       // as of the bare devices [m/s]
constexpr double kArmShake = 0.3;      // chosen [rad]
constexpr double kArmRest = 2.0;       // after it, before what is judged [s]
constexpr double kEngageIn = 5.0;      // [s]
constexpr double kStill = 1e-3;        // a joint's target: 0.3 mm at the end of the arm [rad]
// An arm that is not still is watched on, second by second, for as long as a kicked device is at
// first. A count of the encoder that comes late moves a joint once, J1 by 3 mrad where the wrist is
// near its axis; what swings goes on. Chosen [s].
constexpr int kArmWatched = 6;
// A count of the encoder is 0.11 mm at the tip, which comes as near as 0.12 m to J1's axis: one
// that comes in the last second is no growth [rad].
constexpr double kNoGrowth = 2.0 * kOmniResolution / 0.12;
constexpr double kArmGiven = 1e-3;  // as of the bare devices [J]

Scene arm_scene() {
  Scene scene;
  scene.name = "arm";
  scene.limits.joints = rv2a_limits();
  scene.simulate = Simulate{{ServoLagSpec(), SensorSaturationSpec()}};
  return scene;
}

WholeLoopOptions arm_options(const ArmWay& way, std::uint64_t seed) {
  WholeLoopOptions out;
  out.scene = arm_scene();
  out.grip = stylus_grip(kArmGrip);
  out.q_start = way.from;
  out.seed = seed;
  const Mat3 R_MS = out.scene.mapping.R_SM.transpose();
  if (way.by.norm() > 0.0) {
    out.along_M = R_MS * way.by.normalized();
    out.across_M = out.along_M.unitOrthogonal();
  }
  return out;
}

AuditLimits audit_limits() {
  AuditLimits out;
  out.joints = rv2a_limits();
  out.max_jerk = out.joints.max_jerk;
  out.arm = arm_of(arm_scene());
  return out;
}

// How far the targets of the joints lie apart.
struct JointSwing {
  JointVector low = JointVector::Constant(1e9), high = JointVector::Constant(-1e9);
  void add(const JointVector& q) { low = low.cwiseMin(q), high = high.cwiseMax(q); }
  double most() const { return std::max(0.0, (high - low).maxCoeff()); }
};

class ArmRun {
 public:
  ArmRun(const ArmWay& way, std::uint64_t seed)
      : way_(way), random_(seed), loop_(arm_options(way, seed)), audit_(audit_limits()) {}

  CaseOutcome run();

 private:
  bool pass(double seconds, JointSwing* into = nullptr);
  bool go(double sign);
  double seconds() const {
    return kPeakOfMean * std::max({way_.by.norm() / way_.tip_speed,
                                   way_.turn.norm() / (kArmTurning * way_.tip_speed), 0.1});
  }

  const ArmWay& way_;
  Random random_;
  WholeLoop loop_;
  JointAudit audit_;
  BreachCounts breaches_{};
  double still_ = 0.0, growth_ = 0.0, tip_ = 0.0, energy_ = 0.0;
};

bool ArmRun::pass(double seconds, JointSwing* into) {
  const auto ticks = static_cast<std::int64_t>(std::lround(seconds * 1e3));
  for (std::int64_t i = 0; i < ticks && !loop_.ended(); ++i) {
    loop_.tick();
    for (const JointVector& q : loop_.cell().targets()) {
      (void)audit_.commanded(q, breaches_);
      if (into != nullptr) into->add(q);
    }
  }
  return !loop_.ended();
}

bool ArmRun::go(double sign) {
  const Scene scene = arm_scene();
  const Mat3 R_MS = scene.mapping.R_SM.transpose();
  loop_.lead({sign * way_.by.norm() / scene.mapping.scale, 0.0}, seconds(),
             sign * (R_MS * way_.turn));
  if (!pass(seconds() + kArmSettle)) return false;
  const double anywhere = 2.0 * std::numbers::pi * random_.uniform();
  loop_.kick(kArmKick * Vec2(std::cos(anywhere), std::sin(anywhere)));
  loop_.shake(
      kArmShake *
      Vec3(random_.uniform() - 0.5, random_.uniform() - 0.5, random_.uniform() - 0.5).normalized());
  JointSwing before, last;
  if (!pass(kArmRest) || !pass(1.0, &last)) return false;
  for (int second = 0; second == 0 || (last.most() > kStill && second < kArmWatched); ++second) {
    before = std::exchange(last, JointSwing());
    loop_.window().tip = Swing();
    if (!pass(1.0, &last)) return false;
  }
  still_ = std::max(still_, last.most());
  growth_ = std::max(growth_, last.most() - before.most());
  tip_ = std::max(tip_, loop_.window().tip.peak_to_peak());
  return true;
}

CaseOutcome ArmRun::run() {
  if (!loop_.engage(kEngageIn)) return Refused{std::string("refused: ") + describe(loop_.why())};
  if (pass(kArmSettle)) {
    loop_.begin_window();
    if (go(1.0)) (void)go(-1.0);
    energy_ = loop_.window().most_given;
  }
  const double share = std::max({audit_.speed(), audit_.acceleration(), audit_.jerk()});
  std::uint64_t breaches = 0;
  for (const std::uint64_t n : breaches_) breaches += n;
  return {CaseFigures{judged("joint_share", share, 1.0 + 1e-9),
                      judged("breaches", static_cast<double>(breaches), 0.0),
                      judged("bounds", loop_.bounds(), 1.0 + 1e-9),
                      judged("still_mrad", 1e3 * still_, 1e3 * kStill),
                      judged("tip_swing_mm", tip_ / kMm,
                             2.0 * kOmniResolution * arm_scene().mapping.scale / kMm),
                      judged("growth_mrad", 1e3 * growth_, 1e3 * kNoGrowth),
                      judged("energy_mj", 1e3 * energy_, 1e3 * kArmGiven),
                      judged("ended", loop_.ended() ? 1.0 : 0.0, 0.0),
                      told("off_mm", loop_.off() / kMm), told("force_step_n", loop_.most_step())},
          loop_.ended_by()};
}

}  // namespace

CaseOutcome run_arm_way(const ArmWay& way, std::uint64_t seed) { return ArmRun(way, seed).run(); }

}  // namespace handrail
