// The narrow interface under the robot loop: absolute joint targets out, measured joints in, paced by
// the controller's replies.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/joints.h"
#include "server/base/reason.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

struct RobotCapabilities {
  std::string name;
  Nanos period = 0;        // the controller's cycle, > 0
};

// One reply of the controller.
struct RobotReply {
  JointVector q_measured = JointVector::Zero();  // encoder feedback [rad]
  JointVector q_commanded = JointVector::Zero(); // the controller's own target; else q_measured [rad]
  std::uint32_t missed_cycles = 0;               // cycles the controller says it waited for us
};

enum class RobotEvent : std::uint8_t {
  kReply,     // `reply` is fresh: compute the next target and send it
  kSilence,   // two periods without a reply: the driver has sent the held target again
  kRejected,  // a packet of the wrong size or type came and was dropped
  kLost,      // 100 replies missed in a row: the session has ended
};

// A robot under real-time external control. Called from the robot thread only.
class Robot {
 public:
  virtual ~Robot() = default;
  virtual const RobotCapabilities& capabilities() const = 0;
  // Opens the session and fetches the current joints; no motion. May block up to `patience` and may
  // allocate. The error names address and cause.
  virtual Status connect(Nanos patience, RobotReply& first) = 0;
  // Blocks until the controller answers or falls silent. Real-time safe apart from the wait.
  virtual RobotEvent wait(RobotReply& reply) noexcept = 0;
  // Sends one absolute target [rad] and holds it for repeats. Real-time safe.
  virtual void send(const JointVector& q_target) noexcept = 0;
  // Ends external control; the controller's program goes on. Safe to call twice.
  virtual void end() noexcept = 0;
};

}  // namespace handrail
