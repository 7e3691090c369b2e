#include "server/lab/delay/contact_delay.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "devices/omni/sim_omni.h"
#include "server/base/units.h"
#include "server/kinematics/arm_of.h"
#include "server/kinematics/rv2a.h"
#include "server/lab/cell/cell.h"
#include "server/master/haptic_settings.h"
#include "server/slave/follow_settings.h"

namespace handrail {
namespace {

constexpr double kGap = 10.0 * kMm;   // from the tip to the surface, as the run starts [m]
constexpr double kDeep = 8.0 * kMm;   // that the hand means to go past it, at the hand [m]
constexpr double kPressTime = 1.5;    // [s]
constexpr double kArm = 60e3;         // in series with the surface: the rig's arm [N/m]
constexpr Nanos kHold = 4 * kSecond;  // and twice the round trip
constexpr Nanos kPatience = 20 * kSecond;

Scene scene_of(const DelayCase& of) {
  Scene scene;
  scene.name = "contact-delay";
  scene.limits.joints = rv2a_limits();
  scene.guidance.local_surface = of.local;
  const ArmGeometry arm = arm_of(scene);
  PlaneSpec plane;
  plane.at = forward(arm, ServoArmOptions::default_start()).p - kGap * Vec3::UnitZ();
  plane.surface.stiffness = of.stiffness;
  plane.surface.damping = std::min(plane.surface.damping, of.stiffness * 5e-3);
  scene.simulate = {{ServoLagSpec(), ArmComplianceSpec{kArm}, plane, SensorSaturationSpec()}};
  return scene;
}

LinkFaults faults_of(const DelayCase& of) {
  LinkFaults faults;
  faults.delay = static_cast<Nanos>(of.round_trip_ms * 0.5e6);
  faults.jitter = static_cast<Nanos>(of.jitter_ms * 1e6);
  faults.loss = of.loss;
  faults.reorder = 1.0;  // each takes its own way
  return faults;
}

std::unique_ptr<Cell> make_cell(const Scene& scene, std::uint64_t seed) {
  auto options = std::make_unique<CellOptions>();
  options->haptic = haptic_settings(scene, omni_capabilities(false), true);
  options->haptic.ladder.good_for = kSecond;
  options->haptic.ladder.fade_loop = kForever;  // the force stays, however old the loop
  // The motors' heat is another limit, of long presses.
  options->haptic.force.continuous = options->haptic.force.peak;
  options->follow = follow_settings(scene, options->rig.controller.period, true, 1000.0);
  options->rig.controller.arm.geometry = arm_of(scene);
  run_only_listed(scene, options->rig);
  options->rig.controller.arm.seed = seed;
  options->rig.sensor.seed = seed + 1;
  options->net = CellNetOptions{.seed = seed + 2};
  return std::make_unique<Cell>(*options);
}

HandOptions still_hand(std::uint64_t seed) {
  HandOptions hand;
  hand.seed = seed;
  hand.tremor_rms = hand.drift_rms = hand.drift_rotation_rms = 0.0;
  return hand;
}

class DelayRun {
 public:
  explicit DelayRun(const DelayCase& of)
      : of_(of),
        scene_(scene_of(of)),
        surface_(scene_.simulate->find<PlaneSpec>()->at.z()),
        cell_(make_cell(scene_, of.seed)),
        omni_(still_hand(of.seed), false) {
    const double series = of.stiffness * kArm / (of.stiffness + kArm);
    const double scale = scene_.mapping.scale;
    const GuideSettings guide = haptic_settings(scene_, omni_.capabilities(), true).guide;
    out_.true_stiffness = std::min({series * scale * scale, guide.stiffness, guide.most_stiffness});
    (void)omni_.open();
  }

  DelayFigures run() {
    // No engagement begins over a lossy link: it becomes one afterwards.
    DelayCase clean = of_;
    clean.loss = clean.jitter_ms = 0.0;
    set(faults_of(clean));
    engage();
    if (!out_.engaged) return out_;
    set(faults_of(of_));
    pass(kSecond + trip());
    ticks_ = held_ = 0;
    for (TouchFigures& touch : out_.touch) touch_once(touch);
    out_.held_share = static_cast<double>(held_) / static_cast<double>(ticks_);
    out_.off_mm = std::abs(cell_->slave().X_ST.p.z() - asked()) / kMm;
    return out_;
  }

 private:
  Nanos trip() const { return static_cast<Nanos>(of_.round_trip_ms * 1e6); }
  void set(const LinkFaults& faults) {
    cell_->net()->link().to_slave().faults = cell_->net()->link().to_master().faults = faults;
  }
  void tick(const HapticOrder& order = {}) {
    cell_->tick(hand_reading(omni_.read(cell_->now() + kMillisecond)), order);
    omni_.write(cell_->master().f_H_M);
    cell_->net()->link().to_slave().clear_deliveries();
    cell_->net()->link().to_master().clear_deliveries();
    if (!out_.engaged) return;
    const SessionState session = cell_->master_state().lead.session;
    out_.ended |= session == SessionState::kOff || session == SessionState::kFault;
    ++ticks_;
    held_ += session == SessionState::kHold;
  }
  void pass(Nanos span) {
    for (Nanos t = 0; t < span; t += kMillisecond) tick();
  }
  void engage() {
    for (int i = 0; cell_->now() < kPatience && !out_.engaged; ++i) {
      HapticOrder order;
      if (i % 100 == 0) order.kind = OrderKind::kEngage;
      tick(order);
      out_.engaged = cell_->master_state().lead.session == SessionState::kEngaged &&
                     cell_->slave().state == SessionState::kEngaged;
    }
  }
  // Height of the tip that the hand asks for, unsmoothed [m].
  double asked() const {
    const HapticState& s = cell_->master_state();
    return s.command.engagement.to_slave(s.hand.X_MH).p.z();
  }
  // Of the hand, behind the surface [m], and the force on it out of there [N]. Up is the device's
  // Y.
  double depth() const { return (surface_ - asked()) / scene_.mapping.scale; }
  double force() const { return cell_->master().f_H_M.force.y(); }
  void steer(double down) {
    HandIntent intent;
    intent.displacement_M = {0.0, -down, 0.0};
    intent.duration = kPressTime;
    omni_.hand()->steer(intent);
  }
  void touch_once(TouchFigures& touch);

  DelayCase of_;
  Scene scene_;
  double surface_;  // height [m]
  std::unique_ptr<Cell> cell_;
  SimOmni omni_;
  DelayFigures out_;
  std::int64_t ticks_ = 0, held_ = 0;
};

// Force per depth, by least squares through the surface.
struct Slope {
  double fx = 0.0, xx = 0.0;
  void add(double force, double depth) { fx += force * depth, xx += depth * depth; }
  double value() const { return xx > 0.0 ? fx / xx : 0.0; }
};

void DelayRun::touch_once(TouchFigures& touch) {
  const double way = kGap / scene_.mapping.scale + kDeep;
  steer(way);
  const auto press = static_cast<Nanos>(kPressTime * 1e9);
  const Nanos end = press + kHold + 2 * trip();
  Slope felt, held;
  double squares = 0.0, low = 1e9, high = -1e9, last = 0.0;
  std::pair<double, double> places{1e9, -1e9};
  Nanos inside = 0, touched = 0;
  for (Nanos t = 0; t < end; t += kMillisecond) {
    tick();
    const double x = std::max(0.0, depth()), f = force();
    if (x > 0.0 || touched > 0) {
      touched += kMillisecond;
      squares += std::pow(f - out_.true_stiffness * x, 2);
    }
    if (x > 0.0 && inside < kSecond) {
      inside += kMillisecond;
      felt.add(f, x);
    }
    last = asked();
    if (t >= press + kSecond / 2) {
      places = {std::min(places.first, last), std::max(places.second, last)};
    }
    if (t < end - kSecond) continue;
    held.add(f, x);
    low = std::min(low, f);
    high = std::max(high, f);
  }
  touch.felt = felt.value();
  touch.held = held.value();
  touch.error = std::sqrt(squares * 1e6 / static_cast<double>(std::max<Nanos>(touched, 1)));
  touch.drift = std::max(places.second - last, last - places.first) / kMm;
  touch.swing = high - low;
  steer(-way);
  pass(press + kSecond + trip());
}

}  // namespace

DelayFigures measure_delay(const DelayCase& of) { return DelayRun(of).run(); }

}  // namespace handrail
