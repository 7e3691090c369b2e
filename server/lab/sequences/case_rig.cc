#include "server/lab/sequences/case_rig.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "devices/omni/omni_data.h"
#include "server/lab/sequences/played_slave.h"
#include "server/master/haptic_settings.h"

namespace handrail {
namespace {

constexpr double kCaseTick = 1e-3;      // [s]
constexpr int kRest = 10'000;           // [ticks]
constexpr int kLongestEasing = 30'000;  // half a turn takes twelve seconds and its end [ticks]
constexpr double kStill = 1e-9;         // a command that drifts less stands [m], [rad]
constexpr double kOnTool = 1e-6;        // as the easing's end, 0.1 um, and rounding [m]

HapticSettings case_settings(bool governor) {
  Scene scene;
  scene.name = "cases";
  HapticSettings out = haptic_settings(scene, omni_capabilities(true), governor);
  out.guide.reach = 0.060;
  return out;
}

// Of a move of length 1 at `t` of 0 to 1, at rest at both ends.
double smooth(double t) { return t * t * t * (10.0 + t * (-15.0 + 6.0 * t)); }

}  // namespace

CaseRig::CaseRig(const std::string& name, bool governor)
    : settings_(case_settings(governor)),
      state_(std::make_unique<HapticState>()),
      watch_(settings_) {
  row_.name = name + (governor ? ", governed" : "");
  in_.hand.valid = true;
  in_.hand.X_MH.p = Vec3(0.01, -0.02, 0.03);
  in_.hand.X_MH.q = rotation_exp({0.3, -0.2, 0.5});
  in_.slave = played_slave({Vec3(0.35, 0.05, 0.43), rotation_exp({0.1, 3.0, 0.2})});
  in_.slave_known = true;
  in_.slave_age = 0;
  tick(in_.hand.X_MH);  // says which scene and settings the slave has to share
  in_.order.kind = OrderKind::kEngage;
  stand(6);
  if (out_.link.state != SessionState::kEngaged) fail("does not engage");
}

void CaseRig::fail(const std::string& what) {
  if (row_.failure.empty()) row_.failure = what;
}

void CaseRig::tick(const Pose& X_MH) {
  in_.hand.v_MH = (X_MH.p - in_.hand.X_MH.p) / kCaseTick;
  in_.hand.X_MH = X_MH;
  haptic_step(settings_, in_, kCaseTick, *state_, out_);
  in_.order = HapticOrder();
  watch_.see(in_, kCaseTick, *state_, out_);
  for (std::size_t i = 0; i < kBounds; ++i) {
    const Judged& now = watch_.judged()[i];
    if (now.ratio > row_.worst[i].ratio) row_.worst[i] = now;
  }
  play_slave(out_.link, in_.slave);
}

void CaseRig::stand(int ticks) {
  for (int i = 0; i < ticks; ++i) tick(Pose(in_.hand.X_MH));
}

void CaseRig::go(const Vec3& way, const Vec3& turn, int ticks) {
  const Pose from = in_.hand.X_MH;
  for (int i = 1; i <= ticks; ++i) {
    const double share = smooth(static_cast<double>(i) / ticks);
    tick({from.p + share * way, (rotation_exp(share * turn) * from.q).normalized()});
  }
}

void CaseRig::order(const HapticOrder& order, Reason expected) {
  in_.order = order;
  stand(1);
  if (out_.order_result != expected) {
    fail(fmt::format("order answered with {}, expected {}", describe(out_.order_result),
                     describe(expected)));
  }
}

void CaseRig::call(const ToolCall& tool, Reason expected) {
  HapticOrder out;
  out.kind = OrderKind::kTool;
  out.tool = tool;
  order(out, expected);
}

void CaseRig::drop(bool position, bool orientation) {
  HapticOrder out;
  out.kind = OrderKind::kToolOff;
  out.drop_position = position;
  out.drop_orientation = orientation;
  order(out, Reason::kNone);
}

void CaseRig::rest() {
  // The mean still moves for as many samples as it has.
  int easing = 0, quiet = 0;
  while (quiet < settings_.guide.smoother_length && easing < kLongestEasing) {
    stand(1);
    ++easing;
    quiet = out_.blending ? 0 : quiet + 1;
  }
  row_.settled = easing * kCaseTick;
  if (easing == kLongestEasing) fail("easing does not end within 30 s");
  const Pose start = command();
  const double owed = out_.energy_made;
  for (int i = 0; i < kRest; ++i) {
    const Vec3 told = out_.f_H_M.force, before = hand().p;
    stand(1);
    row_.energy += told.dot(hand().p - before);
    row_.drift = std::max(row_.drift, (command().p - start.p).norm());
    row_.drift_angle = std::max(row_.drift_angle, angle_between(command().q, start.q));
  }
  row_.energy += std::max(out_.energy_made - owed, 0.0);
  row_.off_tool = state_->command.guide.position().distance(command().p);
  if (row_.drift > kStill || row_.drift_angle > kStill) fail("the command drifts");
  if (row_.off_tool > kOnTool) fail("the command is not on the tool");
  if (row_.energy != 0.0) fail("a hand at rest is given energy");
}

ToolCase CaseRig::finish() {
  for (std::size_t i = 0; i < kBounds; ++i) {
    if (breaks(row_.worst[i].ratio)) {
      fail(fmt::format("{}: {:.6g}, allowed {:.6g}", name_of(static_cast<Bound>(i)),
                       row_.worst[i].measured, row_.worst[i].allowed));
    }
  }
  return row_;
}

}  // namespace handrail
