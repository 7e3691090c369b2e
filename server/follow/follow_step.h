// One cycle of the slave: the controller's reply and the master's newest command in, joint target
// and state out.
#pragma once

#include "server/follow/bumper.h"
#include "server/follow/command_train.h"
#include "server/follow/contact_monitor.h"
#include "server/follow/force_filter.h"
#include "server/follow/lag_estimate.h"
#include "server/follow/monitors.h"
#include "server/follow/surface_estimate.h"
#include "server/follow/tool_tube.h"
#include "server/model/link_state.h"
#include "server/model/payload.h"
#include "server/model/rv2a_limits.h"
#include "server/motion/tip_motion.h"
#include "server/session/ladder.h"

namespace handrail {

// Everything a cycle needs to know beforehand. Constant while a scene is loaded.
struct FollowSettings {
  ArmMotion motion;
  BumperSettings bumper;
  double sensor_range = 1000.0;  // a larger component is a fault of the sensor [N]
  Payload payload;               // taken out of what the sensor reads
  double force_lag = 0.0;        // of the force's low pass; 0: none. Part of bumper.sensor_lag [s]
  bool sensor_required = false;  // true: without valid readings the arm holds
  FollowingSettings following;
  JointLimits rated = rv2a_limits();  // what the arm itself has: ranges, and a cycle's step at most
  double catch_up = 0.060;  // bound on riding to a tool that is called beside the tip [m/s]
  double catch_up_rotation = 0.262;  // the same for orientation [rad/s]
  SectionHashes hashes;              // of mapping, limits and robot
  SceneName scene{};
  std::uint32_t number = 0;  // of the scenes that the program has loaded
};

// What the controller has said since the last step.
enum class Answer : std::uint8_t {
  kOnTime,  // of its newest cycle
  kLate,    // of that or of an earlier one
  kNone,    // nothing: what is known of the arm is old
};

struct FollowInput {
  JointVector q_measured = JointVector::Zero();   // [rad]
  JointVector q_commanded = JointVector::Zero();  // the target the controller holds [rad]
  bool has_measured = true;                       // the answer says where the arm is
  bool has_commanded = true;  // ... and which target is held; one that does not confirms nothing
  Answer answer = Answer::kOnTime;
  // The controller was silent for 0.1 s and may be another one. Until it answers it is told
  // nothing.
  bool anew = false;
  int cycles = 1;    // of the controller since the last step, at least 1
  Nanos unseen = 0;  // since the last step, by a clock that goes on while the computer sleeps [ns]
  bool robot_ready = false;
  MasterState master;  // newest from the link; meaningful when master_known
  bool master_known = false;
  Nanos master_age = kForever;        // since that datagram came [ns]
  std::uint64_t master_sequence = 0;  // of that datagram
  LinkView link;
  GripperState gripper = GripperState::kNone;  // as the controller said last
  Wrench f_E_T;                                // sensor reading as it is, axes of the flange
  bool wrench_valid = false;                   // fresh and without a fault flag
  bool wrench_overrange = false;               // fresh, and the sensor says: beyond its range
  Reason fault = Reason::kNone;                // a fault of robot or daemon, now
  bool shutdown = false;                       // come to a stop, take no more commands
  bool stop_input = false;                     // the local stop circuit is open
};

// What the controller gets in this cycle.
enum class Send : std::uint8_t {
  kNothing,   // no packet: it still has targets to take, or the arm is to stay as it holds it
  kTarget,    // q_target
  kQuestion,  // where it holds the arm
};

struct FollowOutput {
  JointVector q_target = JointVector::Zero();  // [rad], through the guard
  Send send = Send::kNothing;
  Grip grip = Grip::kAsItIs;  // what every packet says of the gripper
  SlaveState link;            // for the master
};

struct FollowState {
  SessionState session = SessionState::kOff;
  Reason session_reason = Reason::kNotEngaged;
  Reason fault = Reason::kNone;
  MotionState motion;
  bool placed = false;  // motion stands on a pose the controller confirmed
  CommandTrain train;   // what was sent, from what the controller has confirmed on
  bool gap = false;  // the arm was halted; it goes on from rest, from where the controller has it
  bool halted = false;  // the motion was not over then
  int waited = 0;       // cycles since then
  int owed = 0;         // answers to what was sent before the first question
  // By which joint most, a gap has ended where nobody sent the arm: another controller, or somebody
  // moved it. -1: it has not, or the session was off since.
  int elsewhere = -1;
  bool another = false;     // the controller may be another one than before
  int queued_for = 0;       // answers in a row that show the controller keeps targets for later
  std::uint64_t halts = 0;  // of an arm in motion
  std::uint64_t stop_epoch = 0;
  std::uint64_t fault_epoch = 0;  // the program begins it at a random number of its own
  std::uint64_t engagement_epoch = 0;
  Grip grip = Grip::kAsItIs;
  int invalid_wrenches = 0;        // in a row
  Vec3 f_E_S = Vec3::Zero();       // of the valid readings, without the payload's, filtered [N]
  Vec3 torque_E_S = Vec3::Zero();  // of the last valid one, without the payload's [N m]
  ForceFilter filter;
  Nanos oldest_applied = 0;
  std::uint64_t cycles = 0;
  ToolTube tube;
  WrenchMonitor wrench;
  JointMonitor joints;
  FollowingMonitor following;
  BumperState bumper;
  SurfaceEstimate surface;
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
//
// Time that passed unseen has one rule, whatever made it pass (lost packets, a silent controller, a
// paused program, a computer asleep). The motion is planned on by the controller's cycles as long
// as its next target is within one rated step of all the controller may hold. Where that ends the
// arm is left as the controller holds it, which is asked where, and goes on from there, at rest.
// What the master said counts as at least as old as the time unseen.
void follow_step(const FollowSettings& settings, const FollowInput& in, FollowState& state,
                 FollowOutput& out) noexcept;

}  // namespace handrail
