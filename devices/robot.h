// The narrow interface under the robot loop: absolute joint targets out, measured joints in, paced
// by the controller's replies.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/joints.h"
#include "server/base/status.h"
#include "server/base/time.h"
#include "server/model/gripper.h"
#include "server/model/reason.h"

namespace handrail {

struct RobotCapabilities {
  std::string name;
  Nanos period = 0;  // the controller's cycle, > 0
};

// What the controller has said, up to its newest cycle.
struct RobotReply {
  JointVector q_measured = JointVector::Zero();   // encoder feedback [rad]
  JointVector q_commanded = JointVector::Zero();  // the target it holds, in 32 bits [rad]
  bool has_measured = false;                      // q_measured is of a reply since the event before
  bool has_commanded = false;                     // ... and q_commanded
  bool fresh = false;                             // either
  bool prompt = false;                            // ... as its cycle began: it is of no earlier one
  // It was silent for 0.1 s and may be another controller: what was sent before is over. Until
  // `fresh` nothing is sent, and it is asked when its cycles begin.
  bool anew = false;
  GripperState gripper = GripperState::kNone;
  int cycles = 1;                   // of the controller since the event before, 1 or more
  std::uint32_t missed_cycles = 0;  // cycles the controller says it waited for us
};

// A cycle of the controller has begun with kReply and kSilence: compute one target and send it.
enum class RobotEvent : std::uint8_t {
  kReply,     // it answered in time
  kSilence,   // it did not; `reply` may hold what came too late for the cycle before
  kRejected,  // a packet of the wrong size or type came and was dropped
  kLost,      // no reply for a second and a half: the session has ended
};

// A robot under real-time external control. Called from the robot thread only.
class Robot {
 public:
  virtual ~Robot() = default;
  virtual const RobotCapabilities& capabilities() const = 0;
  // Opens the session and fetches the current joints; no motion. May block up to `patience` and may
  // allocate. The error names address and cause.
  virtual Status connect(Nanos patience, RobotReply& first) = 0;
  // Blocks until the controller's next cycle has begun. Real-time safe apart from the wait.
  virtual RobotEvent wait(RobotReply& reply) noexcept = 0;
  // Sends one absolute target [rad], at most once an event: two in a cycle could be twice the step
  // that a joint can make. For the same reason one that may miss its cycle, as the program was
  // paused, is left out: it is as good as lost. Real-time safe.
  virtual void send(const JointVector& q_target) noexcept = 0;
  // Instead of a target: asks where the controller holds the arm, and moves nothing. Real-time
  // safe.
  virtual void ask() noexcept = 0;
  // What the gripper is to be from the next packet on, said with every one; nothing where the arm
  // has none. Real-time safe.
  virtual void grip(Grip /*wanted*/) noexcept {}
  // Ends external control; the controller's program goes on. Safe to call twice.
  virtual void end() noexcept = 0;
};

}  // namespace handrail
