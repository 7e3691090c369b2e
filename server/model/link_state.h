// What master and slave tell each other: absolute state, whole in every datagram.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "server/base/fixed_text.h"
#include "server/base/joints.h"
#include "server/base/spatial.h"
#include "server/base/time.h"
#include "server/model/gripper.h"
#include "server/model/reason.h"
#include "server/model/surface.h"
#include "server/model/tool.h"

namespace handrail {

// Current state of one side's session.
enum class SessionState : std::uint8_t {
  kOff,       // not following; the arm holds
  kAligning,  // engage wanted; waiting until both sides stand on the same pose
  kEngaged,   // hand drives the arm
  kClutched,  // hand free, arm holds
  kHold,      // link older than 20 ms: arm stopped on its path, resumes by itself
  kFault,     // latched; needs reset, then engage
  kHoming,    // engage wanted; waiting for the robot or the device to be ready
  kCount
};

// What the operator wants of the session.
enum class Desired : std::uint8_t { kOff, kEngaged, kClutched, kCount };

const char* name_of(SessionState state) noexcept;
const char* name_of(Desired desired) noexcept;

// Hashes of the sections both sides must agree on before they engage.
struct SectionHashes {
  std::uint64_t tools = 0;
  std::uint64_t mapping = 0;
  std::uint64_t limits = 0;
  std::uint64_t robot = 0;
};

// How much of what the other side sends arrives, of the last 100 datagrams that are not possibly
// still under way: under 40, under 75, under 99, and the rest.
enum class LinkGrade : std::uint8_t { kPoor, kFair, kGood, kExcellent };
const char* name_of(LinkGrade grade) noexcept;
// The grade of `received_of_100`. Real-time safe.
constexpr LinkGrade grade_of(int received_of_100) noexcept {
  if (received_of_100 < 40) return LinkGrade::kPoor;
  if (received_of_100 < 75) return LinkGrade::kFair;
  return received_of_100 < 99 ? LinkGrade::kGood : LinkGrade::kExcellent;
}

// What a side knows of its link besides the age of the newest datagram.
struct LinkView {
  Nanos loop_age = 0;  // of the newest own datagram the other side is known to have
  Nanos peer_age = 0;  // how long ago anything fresh had come there, when it said so last
  int received_of_100 = 100;
  int peer_received_of_100 = 100;  // the same there, as it says
  bool confirmed = true;           // the other side has answered this session of ours, and lately
  bool other_master = false;       // the slave says that it is led by another master
};

// Scene name, UTF-8.
using SceneName = FixedText<48>;
// `name`, cut to what fits.
inline SceneName scene_name(std::string_view name) noexcept { return fixed_text<SceneName>(name); }

// Master to slave. An epoch begins at a random number of its program's own start and rises by one,
// so that a number names one stop, fault or engagement and never one of another start: what names
// it has seen it.
struct MasterState {
  Desired desired = Desired::kOff;
  SessionState state = SessionState::kOff;
  Pose X_SU;  // commanded tip; meaningful when has_command
  bool has_command = false;
  std::uint64_t stop_epoch = 0;        // the newest stop; it stands until that one is released
  std::uint64_t released_epoch = 0;    // the stop the operator has reset last
  std::uint64_t fault_reset = 0;       // the slave's fault the operator saw and has reset last
  std::uint64_t engagement_epoch = 0;  // the newest engagement
  Grip grip = Grip::kAsItIs;           // of the gripper, while engaged
  bool record = false;  // the slave is to write down what happens, as the master does
  ToolDefinition position_tool;
  ToolDefinition orientation_tool;
  SectionHashes hashes;
  SceneName scene{};
};

// The slave's stages between the command it took and the command it gave, in order.
enum class FollowStage : std::uint8_t { kTube, kBumper, kReach, kLimits, kCount };

// How far each stage moved the commanded tip in the newest cycle. What leads from the command
// taken to X_ST_command; all zero while the arm does not follow.
struct FollowLedger {
  static constexpr int kStages = static_cast<int>(FollowStage::kCount);
  Eigen::Matrix<float, 3, kStages> off_S = Eigen::Matrix<float, 3, kStages>::Zero();  // [m]
  std::array<Reason, kStages> why{};
  std::int8_t joint = -1;  // 0 to 5: the joint that limits; -1: none or all
};

// What the system grants a daemon of what it asks for.
struct RealtimeGrants {
  bool control_fifo = false;   // SCHED_FIFO for the thread that it is there for
  bool memory_locked = false;  // all of it, now and later
  bool io_fifo = false;        // SCHED_FIFO for the thread that serves the link

  constexpr bool all() const noexcept { return control_fifo && memory_locked && io_fifo; }
  friend bool operator==(const RealtimeGrants&, const RealtimeGrants&) = default;
};

// What a program tells of itself and its computer, for people. Nothing is decided by it.
struct ProgramNews {
  Nanos calendar = 0;         // calendar_now() when it was said
  std::uint32_t version = 0;  // version_code()
  RealtimeGrants realtime;

  friend bool operator==(const ProgramNews&, const ProgramNews&) = default;
};

// Slave to master.
struct SlaveState {
  SessionState state = SessionState::kOff;
  Reason reason = Reason::kNone;  // why the arm is held, slowed or clamped, newest cycle
  Reason fault = Reason::kNone;   // why state is kFault
  Pose X_ST_command;              // tip the joints were last commanded to
  Pose X_ST;                      // tip by forward kinematics of the measured joints
  bool has_pose = false;          // both poses are meaningful
  JointVector q_measured = JointVector::Zero();
  Wrench f_E_S;  // measured contact wrench on the tip
  bool has_wrench = false;
  bool payload_removed = false;  // f_E_S is without what hangs on the sensor, by configuration
  bool log_lost = false;         // lines of the slave's log were lost since it started
  // Not engaged: why it cannot be, as long as that lasts; in fault: what a reset would meet again.
  Reason obstacle = Reason::kNone;
  std::uint64_t stop_epoch = 0;           // newest stop of a master that was latched here
  std::uint64_t fault_epoch = 0;          // newest fault or stop latched here; a reset names it
  std::uint64_t engagement_epoch = 0;     // of the master's, the one that `state` is of
  std::uint32_t position_tool_epoch = 0;  // newest tool epochs seen
  std::uint32_t orientation_tool_epoch = 0;
  Nanos oldest_applied = 0;            // greatest age of a command any cycle has moved toward
  std::uint64_t cycles = 0;            // controller replies served since the daemon started
  std::uint64_t silences = 0;          // times the held target was sent again
  std::uint64_t applied_sequence = 0;  // of the datagram the newest cycle moved toward; 0 = none
  FollowLedger ledger;
  std::optional<Surface> surface;  // that the tip touches, or touched last nearby
  GripperState gripper = GripperState::kNone;
  SectionHashes hashes;
  SceneName scene{};
  ProgramNews program;
};

}  // namespace handrail
