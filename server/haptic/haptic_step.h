// One tick of the master: device reading and the slave's newest state in, force and command out.
#pragma once

#include "server/haptic/arbiter.h"
#include "server/haptic/cue.h"
#include "server/haptic/guide.h"
#include "server/haptic/hand_reading.h"
#include "server/haptic/ledger.h"
#include "server/haptic/local_surface.h"
#include "server/haptic/mapping.h"
#include "server/model/link_state.h"
#include "server/model/reason_set.h"
#include "server/session/ladder.h"
#include "server/session/presence.h"
#include "server/session/session.h"
#include "server/stability/energy_governor.h"

namespace handrail {

// Everything a step needs to know beforehand. Constant while a scene is loaded.
struct HapticSettings {
  MappingSettings mapping;
  GuideSettings guide;
  double damping = 0.0;             // B of (2.1), tools only [N s/m]
  double spring_stiffness = 200.0;  // K_s of (3.3) at the hand [N/m]
  // Of the surface that the tip touches, rendered here at most so stiff; 0: it is felt through the
  // spring alone [N/m].
  double surface_stiffness = 0.0;
  ForceLimits force;
  GovernorSettings governor;       // of the energy at the hand; off unless set
  GovernorSettings turn_governor;  // the same of turning it, in N m and rad
  bool has_torque = false;         // the device can make torque
  double max_torque = 0.0;         // [N m]
  LadderSettings ladder;
  Presence presence = Presence::kNone;
  SectionHashes hashes;  // of mapping, limits and robot; tools are hashed as they change
  SceneName scene{};
  // False: a scene of walls. No arm takes part, and nothing engages.
  bool has_arm = true;
};

enum class OrderKind : std::uint8_t {
  kNone,
  kEngage,
  kDisengage,
  kClutchOn,
  kClutchOff,
  kStop,
  kReset,
  kTool,
  kToolOff,
  kStage,
  kScrew,
  kGrip
};

// An operator's order, applied at the start of a tick.
struct HapticOrder {
  OrderKind kind = OrderKind::kNone;
  ToolCall tool;              // kTool
  bool drop_position = true;  // kToolOff
  bool drop_orientation = true;
  int stage = 0;                     // kStage: of the scene's walls
  double screw_c = 0.0;              // kScrew: of (2.2) [N s/(m rad)]
  Grip grip = Grip::kAsItIs;         // kGrip
  Reason why = Reason::kNotEngaged;  // kDisengage: what the session says from then on
};

struct HapticInput {
  HandReading hand;
  HapticOrder order;
  SlaveState slave;  // newest from the link; meaningful when slave_known
  bool slave_known = false;
  Nanos slave_age = kForever;  // since that datagram came [ns]
  Nanos unseen = 0;  // since the last step, by a clock that goes on while the computer sleeps [ns]
  LinkView link;
  Nanos hold_heard = kForever;  // since `engage --hold` was last heard [ns]
  bool device_ready = true;     // false: not calibrated yet
};

struct HapticOutput {
  Wrench f_H_M;                         // for the device, within its limits, always finite
  MasterState link;                     // for the slave
  Reason order_result = Reason::kNone;  // kNone: the order was carried out (or there was none)
  double tool_distance = 0.0;  // kTool: of a position tool at its call, as in Guide::call [m]
  double tool_angle = 0.0;     // kTool: to the reference of an orientation tool at its call [rad]
                               // An engage refused with kHandElsewhere: both are of hand_off().
  std::uint32_t tool_id = 0;   // kTool: of the tool called
  double hand_latched = 0.0;   // how far off the hand was that an order has latched, frame S [m]
  Reason reason = Reason::kNone;  // why the session is not what is wanted
  // What an engage would be refused with, while off; while in fault, after a reset.
  Reason obstacle = Reason::kNone;
  // The slave's own fault behind a kPeerFault: of the slave as it is, and while this session is in
  // fault as it was when that began, whatever becomes of the slave meanwhile.
  Reason peer_fault = Reason::kNone;
  LinkShares link_shares;        // what an engage is refused for with kLinkQuality, over the last
  Nanos link_window = 0;         // so long [ns]
  ReasonSet reasons;             // every intervention of this tick
  ForceShares shares;            // device force, where it came from
  ForceLedger force;             // the same, stage by stage
  double energy_made = 0.0;      // at the hand, that the governor has yet to take back, >= 0 [J]
  MotionLedger motion;           // from the hand to the arm
  double deviation = 0.0;        // hand from the position tool's proxy, at the hand [m]
  double deviation_angle = 0.0;  // hand from the orientation tool [rad]
  bool blending = false;
  bool turning = false;  // the orientation tool's reference has yet to be reached
};

// The hand, and since when it is not heard.
struct HandTrack {
  Pose X_MH;                 // last valid
  Vec3 v_MH = Vec3::Zero();  // with it [m/s]
  bool known = false;
  HandGap gap;
  bool button_was_down = false;
};

// What the operator wants, and what has come of it.
struct LeadState {
  SessionState session = SessionState::kOff;
  Reason reason = Reason::kNotEngaged;
  Reason off_reason = Reason::kNotEngaged;  // what ended the last engagement, until the next order
  Reason peer_fault = Reason::kNone;        // as in HapticOutput
  bool want_engaged = false;
  bool want_clutched = false;
  bool hand_elsewhere = false;  // as good as a clutch held: an absolute mapping waits for the hand
  std::uint64_t stop_epoch = 0;
  std::uint64_t released_epoch = 0;
  std::uint64_t fault_reset = 0;
  std::uint64_t engagement_epoch = 0;
  Grip grip = Grip::kAsItIs;  // of this engagement
  bool present = true;
  double absent_for = 0.0;    // at most kAbsence [s]
  double aligning_for = 0.0;  // homing or aligning [s]

  bool stop_latched() const noexcept { return stop_epoch != released_epoch; }
};

// Where the hand leads the tip.
struct CommandState {
  Engagement engagement;
  bool driving = false;  // the hand moves the command, by `engagement`
  Guide guide;
  Pose X_SU;  // last command
  bool has_command = false;
  std::uint64_t tools_hash = 0;
};

// What the device was told.
struct ForceState {
  LocalSurface surface;
  EnergyGovernor governor;  // of the force of tool and surface
  EnergyTank tank;          // of the spring to the tip, which is told over the link
  Arbiter arbiter;
  EnergyGovernor turn_governor;  // of the torque of an orientation tool
  Vec3 torque = Vec3::Zero();    // last torque on the hand, frame M [N m]
  KeptBack kept_back;
  CuePlayer cue;

  // The force is gone at once: the device does not say where the hand is, or has let go.
  void cut() noexcept {
    arbiter.cut();
    governor.restart();
    torque.setZero();
    turn_governor.restart();
    tank.restart();
  }
};

// What a step remembers. Large (the smoothers' windows): keep one, never copy it in a loop.
struct HapticState {
  HandTrack hand;
  LeadState lead;
  CommandState command;
  ForceState force;
  LadderState ladder;
};

// For a program that starts: its epochs begin at `unique`, random and not 0, so that none of its
// numbers is one of another start's.
void begin_epochs(std::uint64_t unique, HapticState& state) noexcept;

// Pure and bounded: no clock, lock, log or allocation. `dt` > 0 [s]. What the slave said counts as
// at least as old as a time unseen of over 20 ms. On an invalid reading the last
// valid hand is kept and the force is zero for that tick; after 20 ms of them, time unseen among
// them, or of 100 ms unseen alone the command freezes and the hand takes over again, wherever it
// comes back, as after a clutch.
void haptic_step(const HapticSettings& settings, const HapticInput& in, double dt,
                 HapticState& state, HapticOutput& out) noexcept;

}  // namespace handrail
