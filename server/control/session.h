// The session of each side as a pure transition function.
#pragma once

#include "server/base/link_state.h"

namespace handrail {

// How old the newest datagram is, in the words of the degradation ladder.
enum class LinkRung : std::uint8_t { kNone, kFresh, kSlow, kHold, kLost, kClosed };

// Time between two steps of a loop from which on nothing it knows is younger: as long as the other
// side would take an equally old datagram for alive [ns].
inline constexpr Nanos kUnseenAge = 20 * kMillisecond;

// What the ladder says of `age` [ns]: fresh to 5 ms, slow to 20 ms, hold to 200 ms, lost to 1 s,
// then closed; kNone when no datagram has come yet (`ever` false). Real-time safe.
LinkRung rung_of(bool ever, Nanos age) noexcept;

// Why a rung keeps a side from driving; kNone for a fresh link. Real-time safe.
Reason reason_of(LinkRung link) noexcept;

struct SessionStep {
  SessionState state = SessionState::kOff;
  Reason reason = Reason::kNone;  // why the state is not what is wanted; kNone when it is
};

struct MasterSessionInput {
  Desired desired = Desired::kOff;
  LinkRung link = LinkRung::kNone;
  SessionState peer = SessionState::kOff;
  Reason mismatch = Reason::kNone;  // first configuration section that differs
  bool stop_latched = false;
  bool reset = false;     // the operator has just asked for a reset
  bool ready = true;      // the device is calibrated
  bool confirmed = true;  // the slave has answered this session
  bool overdue = false;   // homing and aligning have taken too long
};

// Next state of the master's session. Real-time safe.
//   off -> homing or aligning: engage wanted, link fresh and confirmed, peer healthy,
//     configurations equal; homing -> aligning: the device is ready; both -> off when overdue
//   aligning -> engaged: the slave stands on the pose it will be led from
//   engaged <-> clutched: as desired;   engaged, clutched -> hold -> back: link age, by itself
//   any -> fault: stop, lost link, peer in fault or gone;   fault -> off: reset
SessionStep next_master(SessionState state, const MasterSessionInput& in) noexcept;

struct SlaveSessionInput {
  Desired desired = Desired::kOff;  // the master's newest
  SessionState master = SessionState::kOff;
  LinkRung link = LinkRung::kNone;
  bool new_session = false;  // the master restarted since the last cycle
  bool aligned = false;      // its command stands on the held pose
  bool robot_ready = false;
  Reason fault = Reason::kNone;  // a fault of this side, now
  bool stop_latched = false;
  bool fault_released = false;  // the operator has reset the newest fault
  bool shutdown = false;        // this daemon is ending
  bool confirmed = true;        // the master has answered this session
};

// Next state of the slave's session. Homing is becoming ready, never a motion: as aligning, but the
// robot is not there yet. Real-time safe.
SessionStep next_slave(SessionState state, const SlaveSessionInput& in) noexcept;

// True while the slave moves toward commands.
constexpr bool follows(SessionState state) noexcept {
  return state == SessionState::kEngaged || state == SessionState::kClutched;
}

}  // namespace handrail
