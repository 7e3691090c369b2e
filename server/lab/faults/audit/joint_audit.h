// The judge of joint commands by the limits alone.
#pragma once

#include <array>
#include <cstdint>

#include "server/base/joints.h"
#include "server/base/time.h"
#include "server/kinematics/rv2a.h"

namespace handrail {

struct AuditLimits {
  JointLimits joints;
  JointVector max_jerk = JointVector::Zero();  // third difference of commands / dt^3 [rad/s^3]
  ArmGeometry arm;
  Vec3 low = Vec3::Constant(-2.0);  // where the tip may be, frame S [m]
  Vec3 high = Vec3::Constant(2.0);
  double catch_up = 0.060;              // at most, of a tip onto a tool that is called [m/s]
  double force = 3.3;                   // on the hand [N]
  Nanos period = 7'100 * kMicrosecond;  // of the commands
};

// What a command can do wrong.
enum class Breach : std::uint8_t {
  kNotFinite,
  kRange,
  kWorkspace,
  kSpeed,
  kAcceleration,
  kJerk,
  kUnled,     // moved while nothing let it
  kLateStop,  // still moving after the stop bound
  kUnasked,   // the tip is where no command of the last seconds was
  kOffTool,
  kForce,     // on the hand, not finite or too large
  kBackward,  // the slave names an older datagram than before as the one it follows
  kCount
};
const char* name_of(Breach breach) noexcept;

using BreachCounts = std::array<std::uint64_t, static_cast<std::size_t>(Breach::kCount)>;

// The arm stands on the first command. Real-time safe.
class JointAudit {
 public:
  explicit JointAudit(const AuditLimits& limits) noexcept;

  // One command a period. False: it was not finite, and nothing else was judged.
  bool commanded(const JointVector& q, BreachCounts& breaches) noexcept;

  // Time any joint needs to rest, at most: v/a + 2.5 a/j of the slowest-stopping one, a/j two
  // cycles at least [s].
  double time_to_stop() const noexcept;
  // How far from here the tip gets while every joint brakes, no softer than the stop bound asks
  // [m].
  double way_of_joints() const noexcept;
  const JointVector& q() const noexcept { return q_; }
  const JointVector& step() const noexcept { return step_; }
  bool moving() const noexcept { return moving_; }
  // Neither moves nor turns back: where an arm turns it stands for a moment, and what is left of
  // its acceleration still takes it away.
  bool at_rest() const noexcept { return at_rest_; }
  const Vec3& tip() const noexcept { return tip_; }

  // Largest of any joint and cycle, 1 = the limit.
  double speed() const noexcept { return speed_; }
  double acceleration() const noexcept { return acceleration_; }
  double jerk() const noexcept { return jerk_; }

 private:
  AuditLimits limits_;
  double dt_;
  bool placed_ = false;
  JointVector q_ = JointVector::Zero();
  JointVector step_ = JointVector::Zero();
  JointVector change_ = JointVector::Zero();
  bool moving_ = false;
  bool at_rest_ = true;
  Vec3 tip_ = Vec3::Zero();
  double speed_ = 0.0;
  double acceleration_ = 0.0;
  double jerk_ = 0.0;
};

}  // namespace handrail
