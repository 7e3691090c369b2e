// What master and slave tell each other: absolute state, whole in every datagram.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "server/base/joints.h"
#include "server/base/reason.h"
#include "server/base/spatial.h"
#include "server/base/time.h"
#include "server/base/tool.h"

namespace handrail {

// Current state of one side's session.
enum class SessionState : std::uint8_t {
  kOff,       // not following; the arm holds
  kAligning,  // engage wanted; waiting until both sides stand on the same pose
  kEngaged,   // hand drives the arm
  kClutched,  // hand free, arm holds
  kHold,      // link older than 20 ms: arm stopped on its path, resumes by itself
  kFault,     // latched; needs reset, then engage
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

// Scene name, fixed capacity so that a state can be copied in a step. UTF-8, zero-terminated.
using SceneName = std::array<char, 48>;
// `name`, cut to what fits.
SceneName scene_name(std::string_view name) noexcept;
// The text in `name`, up to its first zero.
std::string_view text_of(const SceneName& name) noexcept;

// Master to slave.
struct MasterState {
  Desired desired = Desired::kOff;
  SessionState state = SessionState::kOff;
  Pose X_SU;                          // commanded tip; meaningful when has_command
  bool has_command = false;
  std::uint32_t stop_epoch = 0;       // stops requested; the stop stands while > released_epoch
  std::uint32_t released_epoch = 0;   // stops the operator has reset
  std::uint32_t fault_reset = 0;      // slave fault epoch the operator has reset
  ToolDefinition position_tool;
  ToolDefinition orientation_tool;
  SectionHashes hashes;
  SceneName scene{};
};

// Slave to master.
struct SlaveState {
  SessionState state = SessionState::kOff;
  Reason reason = Reason::kNone;      // why the arm is held, slowed or clamped, newest cycle
  Reason fault = Reason::kNone;       // why state is kFault
  Pose X_ST_command;                  // tip the joints were last commanded to
  Pose X_ST;                          // tip by forward kinematics of the measured joints
  bool has_pose = false;              // both poses are meaningful
  JointVector q_measured = JointVector::Zero();
  Wrench f_E_S;                       // measured contact wrench on the tip
  bool has_wrench = false;
  std::uint32_t stop_epoch = 0;       // newest stop epoch taken over from the master
  std::uint32_t fault_epoch = 0;      // faults latched so far
  std::uint32_t position_tool_epoch = 0;     // newest tool epochs seen
  std::uint32_t orientation_tool_epoch = 0;
  Nanos oldest_applied = 0;           // greatest age of a command any cycle has moved toward
  std::uint64_t cycles = 0;           // controller replies served since the daemon started
  std::uint64_t silences = 0;         // times the held target was sent again
  SectionHashes hashes;
  SceneName scene{};
};

}  // namespace handrail
