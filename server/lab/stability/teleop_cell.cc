#include "server/lab/stability/teleop_cell.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "devices/omni/omni_data.h"
#include "server/base/units.h"
#include "server/kinematics/arm_of.h"
#include "server/kinematics/rv2a.h"
#include "server/lab/stability/bench_device.h"
#include "server/lab/stability/whole_loop.h"

namespace handrail {
namespace {

constexpr double kGap = 10.0 * kMm;  // from the tip to the surface, as the run starts [m]
constexpr double kDeep = 8.0 * kMm;  // that the hand means to go past it, at the hand [m]
constexpr double kPressTime = 1.5;   // [s]
constexpr double kSettle = 1.0;      // before a kick, and the round trip [s]
// After a kick, and two round trips; chosen: a hand's own swing is gone in one, the last is judged
// [s].
constexpr double kRest = 3.0;
constexpr double kTouchKick = 0.5;          // as of the bare devices [m/s]
constexpr double kTouchAngle = 0.35;        // of a kick from straight [rad]
constexpr double kPatience = 6.0;           // to engage, and six round trips [s]
constexpr double kServoLag = 0.045 * 1.03;  // of the rig's slowest joint [s]
// Of the arm, beside v/a: 2.5 a/j of 20 ms, which is what the plan of a stop keeps to, are 7.04
// cycles (server/motion/MOTION.md).
constexpr int kCyclesToStop = 8;
// The finest step that the controller can be told: joints go to it as 32 bits, 6e-8 rad at 1 to 2
// rad, and three of them lift the tip by levers of 0.55 m, before a step and after it [m].
constexpr double kFinest = 2.0 * 3.0 * 6e-8 * 0.55;
constexpr double kArm = 60e3;  // in series with the surface [N/m]

constexpr double kMostSwing = 2.0 * kOmniResolution;  // as of the bare devices, two counts [m]
constexpr double kTouchGives = 1e-3;                  // as of the bare devices [J]
constexpr double kMostDrift = 0.5 * kMm;              // as contact-delay asks [m]

Scene scene_of(const TeleopCell& of) {
  Scene scene;
  scene.name = "teleoperation";
  scene.limits.joints = rv2a_limits();
  scene.guidance.local_surface = of.local;
  Simulate world{{ServoLagSpec(), ArmComplianceSpec{kArm}, SensorSaturationSpec()}};
  if (of.stiffness > 0.0) {
    const ArmGeometry arm = arm_of(scene);
    PlaneSpec plane;
    plane.at = forward(arm, ServoArmOptions::default_start()).p - kGap * Vec3::UnitZ();
    plane.surface.stiffness = of.stiffness;
    plane.surface.damping = std::min(plane.surface.damping, of.stiffness * 5e-3);
    world.effects.push_back(plane);
  }
  scene.simulate = world;
  return scene;
}

LinkFaults way_of(const TeleopCell& of, bool clean) {
  LinkFaults way;
  if (!clean) way = of.faults;
  way.delay = from_seconds(0.5 * of.round_trip);
  if (way.jitter > 0) way.reorder = 1.0;  // each takes its own way
  return way;
}

WholeLoopOptions options_of(const TeleopCell& of, std::uint64_t seed) {
  WholeLoopOptions out;
  out.scene = scene_of(of);
  out.grip = stylus_grip(of.grip);
  out.way = way_of(of, of.later);
  out.seed = seed;
  return out;
}

bool of_link(Reason why) {
  return why == Reason::kLinkLost || why == Reason::kLinkQuality || why == Reason::kLinkStale ||
         why == Reason::kLinkHold || why == Reason::kNoPeer || why == Reason::kNotConfirmed ||
         why == Reason::kSessionClosed;
}

class TeleopRun {
 public:
  TeleopRun(const TeleopCell& of, std::uint64_t seed)
      : of_(of), random_(seed), loop_(options_of(of, seed)) {
    const Scene scene = scene_of(of);
    surface_ = forward_start(scene) - kGap;
    scale_ = scene.mapping.scale;
    if (of.stiffness > 0.0) series_ = of.stiffness * kArm / (of.stiffness + kArm);
    const GuideSettings& guide = loop_.settings().guide;
    true_stiffness_ = std::min({series_ * scale_ * scale_, guide.stiffness, guide.most_stiffness});
    threshold_ = scene.bumper.threshold;
  }

  TeleopFigures run();

 private:
  static double forward_start(const Scene& scene) {
    const ArmGeometry arm = arm_of(scene);
    return forward(arm, ServoArmOptions::default_start()).p.z();
  }
  bool pass(double seconds);
  void look();
  bool rest(double way, double kick);
  void touch(bool second);

  const TeleopCell& of_;
  Random random_;
  WholeLoop loop_;
  TeleopFigures out_;
  double surface_ = 0.0, scale_ = 1.0, series_ = 0.0, true_stiffness_ = 0.0, threshold_ = 0.0;
  double command_ = 0.0;  // height of the slave's newest command [m]
  double fastest_ = 0.0;  // of it downward, above the surface or in it [m/s]
  double peak_ = 0.0;     // [N]
  int above_ = 0;         // cycles in a row with more than the threshold
  bool second_ = false;
  int inside_ = 0, touched_ = 0;  // ticks
  double fx_ = 0.0, xx_ = 0.0, errors_ = 0.0;
};

bool TeleopRun::pass(double seconds) {
  const auto ticks = static_cast<std::int64_t>(std::lround(seconds * 1e3));
  for (std::int64_t i = 0; i < ticks && !loop_.ended(); ++i) {
    loop_.tick();
    look();
  }
  return !loop_.ended();
}

// What happens at the surface.
void TeleopRun::look() {
  if (of_.stiffness <= 0.0) return;
  const Cell& cell = loop_.cell();
  const double command = cell.slave().X_ST_command.p.z();
  if (cell.robot_cycle()) {
    const double step = command_ - command;
    above_ = cell.follow_state().f_E_S.norm() > threshold_ ? above_ + 1 : 0;
    if (command_ != 0.0) {
      fastest_ = std::max(fastest_, step / to_seconds(kMxtPeriod));
      if (above_ > kCyclesToStop) out_.inward = std::max(out_.inward, step);
    }
    command_ = command;
  }
  if (const World* world = cell.rig().world()) {
    peak_ = std::max(peak_, world->on_tip().force.norm());
  }
  const double depth = std::max(0.0, surface_ - loop_.asked().z()) / scale_;
  if (!second_ || (depth <= 0.0 && touched_ == 0)) return;
  const double force = -loop_.force().x();
  ++touched_;
  errors_ += std::pow(force - true_stiffness_ * depth, 2);
  // What is hardly inside says little: the encoder tells it in counts.
  if (depth <= kMostSwing || inside_ >= 1000) return;
  ++inside_;
  fx_ += force * depth;
  xx_ += depth * depth;
}

// The hand goes by `way` and is kicked there; then it is to be still.
bool TeleopRun::rest(double way, double kick) {
  loop_.lead({way, 0.0}, kPressTime);
  if (!pass(kPressTime + kSettle + of_.round_trip)) return false;
  const double speed = kick * (0.8 + 0.4 * random_.uniform());
  const double angle = kTouchAngle * (2.0 * random_.uniform() - 1.0);
  loop_.kick(speed * Vec2(std::cos(angle), std::sin(angle)));
  if (!pass(kRest + 2.0 * of_.round_trip - 1.0)) return false;
  LoopWindow& last = loop_.window();
  last.hand = last.tip = Swing();
  if (!pass(1.0)) return false;
  out_.hand_swing = std::max(out_.hand_swing, last.hand.peak_to_peak());
  out_.tip_swing = std::max(out_.tip_swing, last.tip.peak_to_peak());
  return true;
}

void TeleopRun::touch(bool second) {
  second_ = second;
  const double way = kGap / scale_ + kDeep;
  loop_.begin_window();
  if (!rest(way, kTouchKick) || !rest(-way, -kTouchKick)) return;
  if (second || !of_.local) out_.energy = std::max(out_.energy, loop_.window().most_given);
  out_.drift = std::max(out_.drift, loop_.off());
}

TeleopFigures TeleopRun::run() {
  if (!loop_.engage(kPatience + 6.0 * of_.round_trip)) {
    out_.refused = std::string("refused: ") + describe(loop_.why());
    return out_;
  }
  loop_.set(way_of(of_, false));
  if (pass(kSettle + of_.round_trip)) {
    touch(false);
    if (!loop_.ended()) touch(true);
  }
  if (loop_.ended()) {
    (of_link(loop_.why()) ? out_.refused : out_.ended) = loop_.ended_by();
  }
  out_.bounds = loop_.bounds();
  out_.most_step = loop_.most_step();
  out_.held = loop_.share_held();
  const double bound =
      threshold_ + series_ * std::max(fastest_, 0.0) * (kServoLag + 2.5 * to_seconds(kMxtPeriod));
  out_.peak = peak_ / bound;
  out_.felt = xx_ > 0.0 ? fx_ / xx_ : 0.0;
  out_.error = touched_ > 0 ? std::sqrt(errors_ / touched_) : 0.0;
  return out_;
}

CaseFigures figures_of(const TeleopFigures& f) {
  const double tip = kMostSwing * Scene::Mapping().scale;
  return {judged("hand_swing_mm", f.hand_swing / kMm, kMostSwing / kMm),
          judged("tip_swing_mm", f.tip_swing / kMm, tip / kMm),
          judged("energy_mj", 1e3 * f.energy, 1e3 * kTouchGives),
          judged("bounds", f.bounds, 1.0 + 1e-9),
          judged("inward_um", 1e6 * f.inward, 1e6 * kFinest),
          judged("peak_share", f.peak, 1.0),
          judged("drift_mm", f.drift / kMm, kMostDrift / kMm),
          judged("ended", f.ended.empty() ? 0.0 : 1.0, 0.0),
          told("held_share", f.held),
          told("force_step_n", f.most_step),
          told("felt_n_mm", f.felt / kNewtonPerMm),
          told("force_error_n", f.error)};
}

}  // namespace

bool TeleopFigures::stable() const { return refused.empty() && all_hold(figures_of(*this)); }

TeleopFigures measure_teleop(const TeleopCell& cell, std::uint64_t seed) {
  return TeleopRun(cell, seed).run();
}

CaseOutcome run_teleop_cell(const TeleopCell& cell, std::uint64_t seed) {
  const TeleopFigures f = measure_teleop(cell, seed);
  if (!f.refused.empty()) return Refused{f.refused};
  return {figures_of(f), f.ended};
}

}  // namespace handrail
