// One cycle of the slave: the controller's reply and the master's newest command in, joint target
// and state out.
#pragma once

#include "server/base/link_state.h"
#include "server/base/payload.h"
#include "server/control/bumper.h"
#include "server/control/contact_monitor.h"
#include "server/control/force_filter.h"
#include "server/control/ladder.h"
#include "server/control/lag_estimate.h"
#include "server/control/monitors.h"
#include "server/control/tip_motion.h"
#include "server/control/tool_tube.h"

namespace handrail {

// Everything a cycle needs to know beforehand. Constant while a scene is loaded.
struct FollowSettings {
  MotionSettings motion;
  BumperSettings bumper;
  double sensor_range = 1000.0;  // a larger component is a fault of the sensor [N]
  Payload payload;               // taken out of what the sensor reads
  double force_lag = 0.0;        // of the force's low pass; 0: none. Part of bumper.sensor_lag [s]
  bool sensor_required = false;  // true: without valid readings the arm holds
  FollowingSettings following;
  SectionHashes hashes;  // of mapping, limits and robot
  SceneName scene{};
};

struct FollowInput {
  JointVector q_measured = JointVector::Zero();  // [rad]
  bool robot_ready = false;
  MasterState master;  // newest from the link; meaningful when master_known
  bool master_known = false;
  Nanos master_age = kForever;        // since that datagram came [ns]
  std::uint64_t master_sequence = 0;  // of that datagram
  LinkView link;
  Wrench f_E_T;                  // sensor reading as it is, axes of the tip frame
  bool wrench_valid = false;     // fresh and without a fault flag
  Reason fault = Reason::kNone;  // a fault of robot or daemon, now
  bool shutdown = false;         // come to a stop, take no more commands
  bool stop_input = false;       // the local stop circuit is open
};

struct FollowOutput {
  JointVector q_target = JointVector::Zero();  // [rad], through the guard
  SlaveState link;                             // for the master
};

struct FollowState {
  SessionState session = SessionState::kOff;
  Reason session_reason = Reason::kNotEngaged;
  Reason fault = Reason::kNone;
  MotionState motion;
  bool placed = false;  // motion stands on a pose the controller confirmed
  std::uint64_t stop_epoch = 0;
  std::uint64_t fault_epoch = 0;  // the program begins it at a random number of its own
  std::uint64_t engagement_epoch = 0;
  int invalid_wrenches = 0;   // in a row
  Vec3 f_E_S = Vec3::Zero();  // of the valid readings, without the payload's, filtered [N]
  Vec3 torque_E_T = Vec3::Zero();  // of the last valid one, tip axes [N m]
  ForceFilter filter;
  Nanos oldest_applied = 0;
  std::uint64_t cycles = 0;
  ToolTube tube;
  WrenchMonitor wrench;
  JointMonitor joints;
  FollowingMonitor following;
  BumperState bumper;
  ContactMonitor contact;
  LagEstimate lag;
  Vec3 p_measured = Vec3::Zero();  // tip [m]
  std::uint64_t applied_sequence = 0;
  std::uint64_t guarded = 0;  // cycles in which the guard did not let the command pass
};

// Places the commands where the controller holds the arm; until then nothing is followed.
void place(const FollowSettings& settings, const JointVector& q, FollowState& state) noexcept;

// True when the operator has reset what is latched here, having seen it, and no stop stands.
bool released(const FollowInput& in, const FollowState& state) noexcept;

// Pure and bounded: no clock, lock, log or allocation. Before `place` the target is q_measured.
void follow_step(const FollowSettings& settings, const FollowInput& in, FollowState& state,
                 FollowOutput& out) noexcept;

}  // namespace handrail
