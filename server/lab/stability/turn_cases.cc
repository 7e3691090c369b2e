// The torque of orientation tools: a stylus that is kicked while one holds it.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "devices/hand/hand_model.h"
#include "devices/omni/omni_data.h"
#include "server/base/random.h"
#include "server/base/units.h"
#include "server/lab/stability/bare_device.h"
#include "server/lab/stability/bench_device.h"
#include "server/lab/stability/contact_meter.h"
#include "server/lab/stability/engaged_step.h"
#include "server/lab/stability/stability_case.h"
#include "server/lab/stability/wall_cell.h"
#include "server/master/governing.h"
#include "server/master/haptic_settings.h"

namespace handrail {
namespace {

// What a swing may be anyway: two counts of what the device reads, as at walls [rad].
constexpr double kFine = kSwingCounts * kOmniTurnResolution;

// SI.
struct TurnCell {
  ToolKind tool = ToolKind::kNRotation;
  GripKind grip = GripKind::kNone;
  double stiffness = 0.5;  // K_N, K_F [N m/rad]
  double kick = 2.0;       // [rad/s], within a fifth; later again by half of it, either way
  Governing governing = Governing::kOff;
};

HapticSettings settings_of(const TurnCell& cell, const HapticCapabilities& device) {
  Scene scene;
  scene.guidance.torque_stiffness = cell.stiffness;
  HapticSettings out = haptic_settings(scene, device, cell.governing != Governing::kOff);
  if (cell.governing == Governing::kEnergy) out.guide.most_torque_stiffness = 1e9;
  return out;
}

// The hand's part of turning, passive. The simulated hand's grip is a light one; a firm one is as
// many times as stiff as those that were measured along a stylus.
PassiveGrip turning_grip(GripKind kind) {
  if (kind == GripKind::kNone) return {};
  const HandOptions hand;
  const double stiffness =
      hand.rotation_stiffness * (kind == GripKind::kFirm ? kFirmest / kLightest : 1.0);
  return {hand.rotation_inertia,
          2.0 * hand.rotation_damping_ratio * std::sqrt(stiffness * hand.rotation_inertia),
          stiffness, Vec2::Zero()};
}

// A stylus that turns about an axis that is drawn, as in a gimbal: what of a torque is across it
// does nothing.
class TurnBench {
 public:
  TurnBench(const TurnCell& cell, std::uint64_t seed);
  CaseFigures run();

 private:
  void tick();

  const HapticCapabilities device_ = omni_capabilities(true);
  Random random_;
  double kick_;      // [rad/s]
  Vec3 axis_M_;      // unit
  BareDevice body_;  // turned by the X of its position [rad]
  EngagedStep master_;
  ContactMeter meter_{true, 0.0};
  std::array<Swing, static_cast<std::size_t>(kSeconds / kWindow)> windows_;
  double t_ = 0.0;  // [s]
};

TurnBench::TurnBench(const TurnCell& cell, std::uint64_t seed)
    : random_(seed),
      kick_(cell.kick * (0.8 + 0.4 * random_.uniform())),
      axis_M_(Vec3(random_.normal(), random_.normal(), random_.normal()).normalized()),
      body_({device_.turning.mass, device_.turning.damping, device_.turning.friction},
            turning_grip(cell.grip), Vec2::Zero()),
      master_(settings_of(cell, device_)) {
  ToolCall tool;
  tool.kind = cell.tool;
  master_.call(tool);
}

void TurnBench::tick() {
  const Pose X_MH{Vec3::Zero(), rotation_exp(body_.position().x() * axis_M_)};
  const Vec2 torque(master_.step(X_MH, Vec3::Zero(), master_.period()).torque.dot(axis_M_), 0.0);
  const double work = body_.given(), taken = body_.lost(), period = master_.period();
  body_.advance(period, torque);
  meter_.add(true, torque.norm(), body_.given() - work, body_.lost() - taken, 0.0);
  t_ += period;
  const auto window = static_cast<std::size_t>(t_ / kWindow);
  windows_[std::min(window, windows_.size() - 1)].add(body_.position());
}

CaseFigures TurnBench::run() {
  body_.kick({kick_, 0.0});
  bool again = true;
  while (t_ < kSeconds) {
    tick();
    if (!again || t_ < kSecondKick) continue;
    again = false;
    body_.kick({random_.uniform() < 0.5 ? -0.5 * kick_ : 0.5 * kick_, 0.0});
  }
  const double before = windows_[1].peak_to_peak(), last = windows_[2].peak_to_peak();
  return {judged("over_mj", 1e3 * meter_.over(), 1e3 * kMostGiven),
          judged("swing_deg", last / kDeg, (kMoreSwing * before + kFine) / kDeg),
          judged("drift_deg", (windows_[2].mean() - windows_[1].mean()).norm() / kDeg,
                 (0.5 * before + kFine) / kDeg),
          judged("engaged", master_.engaged() ? 0.0 : 1.0, 0.0),
          told("given_mj", 1e3 * meter_.worst()),
          told("rendered_n_m_rad",
               master_.state().command.guide.torque_stiffness(master_.settings().guide))};
}

}  // namespace

std::vector<StabilityCase> turn_cases() {
  std::vector<StabilityCase> out;
  TurnCell cell;
  const auto put = [&out, &cell](const char* tool) {
    for (const auto& [governing, name] : kGoverning) {
      cell.governing = governing;
      out.push_back({fmt::format("turning/{}/{}/K{:g}/{:g}rad_s/{}", name_of(cell.grip), tool,
                                 cell.stiffness, cell.kick, name),
                     governing == Governing::kOn, true,
                     [cell](std::uint64_t seed) { return TurnBench(cell, seed).run(); }});
    }
  };
  for (const GripKind grip : kGripKinds) {
    cell.grip = grip;
    for (const double stiffness : {0.1, 0.5, 1.0, 2.0, 10.0}) {
      cell.stiffness = stiffness;
      for (const double kick : {2.0, 10.0, 20.0}) {
        cell.kick = kick;
        cell.tool = ToolKind::kNRotation, put("n_rotation");
        cell.tool = ToolKind::kFRotation, put("f_rotation");
      }
    }
  }
  return out;
}

}  // namespace handrail
