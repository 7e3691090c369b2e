#include "server/follow/follow_judges.h"

#include <algorithm>

#include "server/base/deletable.h"
#include "server/follow/follow_gap.h"

namespace handrail {
namespace {

// One bad reading costs nothing, a third in a row is a sensor not to be worked with.
constexpr int kInvalidWrenches = 3;  // [readings, one a cycle of the controller]

}  // namespace

Reason read_force(const FollowSettings& settings, const FollowInput& in, const Pose& X_ST,
                  FollowState& s) noexcept {
  const bool still = s.placed && standing(s.motion);
  // The sensor and what hangs on it are turned as the flange.
  const Pose sensor{X_ST.p, settings.motion->arm.turn_of_flange(X_ST.q)};
  const WrenchReading reading{in.f_E_T, in.wrench_valid, in.wrench_overrange,
                              sensor,   still,           settings.payload.reading(sensor.q).force};
  const Reason wrong =
      s.wrench.judge(settings.bumper, settings.sensor_range, settings.motion->dt, reading);
  if (wrong == Reason::kNone) {
    s.invalid_wrenches = 0;
    const Wrench f_E_T = settings.payload.remove(in.f_E_T, sensor.q);
    s.f_E_S = s.filter.pass(sensor.q * f_E_T.force, settings.force_lag, settings.motion->dt);
    s.torque_E_S = sensor.q * f_E_T.torque;
    return Reason::kNone;
  }
  s.invalid_wrenches = std::min(s.invalid_wrenches + 1, kInvalidWrenches);
  if (wrong == Reason::kSensorStuck) s.invalid_wrenches = kInvalidWrenches;
  if (s.invalid_wrenches < kInvalidWrenches) return Reason::kNone;  // the last reading stands
  s.f_E_S.setZero();
  s.filter.restart();
  return wrong;
}

Reason judge_arm(const FollowSettings& settings, const FollowInput& in,
                 const JointVector& q_measured, FollowState& s, std::int8_t& joint) noexcept {
  const double dt = settings.motion->dt;
  const bool answered = in.answer != Answer::kNone && in.has_measured;
  const bool judged = s.placed && !s.gap;
  for (int i = answered ? 1 : 0; judged && i < in.cycles; ++i) {
    s.following.pass(settings.following, s.motion.joints.q, dt);
  }
  if (!answered) return Reason::kNone;
  const bool lost =
      judged && s.following.lost(settings.following, s.motion.joints.q, q_measured, dt);
  if (s.joints.broken()) {
    joint = static_cast<std::int8_t>(s.joints.joint());
    return Reason::kEncoderInvalid;
  }
  if (const int i = joint_out_of_range(settings, q_measured); in.robot_ready && i >= 0) {
    joint = static_cast<std::int8_t>(i);
    return Reason::kEncoderInvalid;
  }
  if (!lost) return Reason::kNone;
  joint = static_cast<std::int8_t>(s.following.joint());
  return Reason::kFollowingError;
}

Reason judge_contact(const FollowSettings& settings, const Vec3& p_measured,
                     FollowState& s) noexcept {
  const Vec3 moved = p_measured - s.p_measured;
  s.p_measured = p_measured;
  if (!settings.bumper.enabled || settings.bumper.form == BumperSettings::Form::kPublished ||
      !s.placed) {
    return Reason::kNone;
  }
  if (!follows(s.session)) {
    s.contact = ContactMonitor();
    return Reason::kNone;
  }
  const Reason found =
      s.contact.judge(settings.bumper, s.f_E_S, moved, rest_place(s.motion), settings.motion->dt);
  if (found == Reason::kSensorSign && !kept(Check::kSensorSign)) return Reason::kNone;
  if (found == Reason::kContactUnrelieved && !kept(Check::kRelief)) return Reason::kNone;
  return found;
}

}  // namespace handrail
