// The session of each side as a pure transition function.
#pragma once

#include "server/model/link_state.h"

namespace handrail {

// How old the newest datagram is, in the words of the degradation ladder.
enum class LinkRung : std::uint8_t { kNone, kFresh, kSlow, kHold, kLost, kClosed };
// The arm moves, be it slowed.
constexpr bool flowing(LinkRung rung) noexcept {
  return rung == LinkRung::kFresh || rung == LinkRung::kSlow;
}

// How old what the other side has said is, at least: `age` [ns], but after a time `unseen` [ns]
// between two steps of a loop of over 20 ms, as long as an equally old datagram would be taken for
// alive, nothing the loop knows is younger than that. Real-time safe.
Nanos age_after(Nanos unseen, Nanos age) noexcept;

// What the ladder says of `age` [ns]: fresh to 5 ms, slow to 20 ms, hold to 200 ms, lost to 1 s,
// then closed; kNone when no datagram has come yet (`ever` false). Real-time safe.
LinkRung rung_of(bool ever, Nanos age) noexcept;

// Why a rung keeps a side that is off from driving; kNone for a fresh link. Real-time safe.
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
  bool reset = false;               // the operator has just asked for a reset
  bool ready = true;                // the device is calibrated
  bool confirmed = true;            // the slave has answered this session
  bool overdue = false;             // homing and aligning have taken too long
  bool same_engagement = true;      // `peer` is of the present engagement, of no earlier one
  Reason obstacle = Reason::kNone;  // why the slave cannot be engaged now, as it says
};

// Next state of the master's session. Real-time safe.
//   off -> homing or aligning: engage wanted, link fresh and confirmed, peer healthy,
//     configurations equal; homing -> aligning: the device is ready; both -> off when overdue or
//     when the slave says that it cannot
//   aligning -> engaged: the slave stands on the pose it will be led from, in this engagement
//   engaged <-> clutched: as desired;   engaged, clutched -> hold -> back: link age, by itself
//   any -> fault: stop, lost link, peer in fault or gone;   fault -> off: reset
SessionStep next_master(SessionState state, const MasterSessionInput& in) noexcept;

struct SlaveSessionInput {
  Desired desired = Desired::kOff;  // the master's newest
  SessionState master = SessionState::kOff;
  LinkRung link = LinkRung::kNone;
  bool same_engagement = true;  // the master's engagement is the one we are in
  bool aligned = false;         // its command stands on the held pose
  bool robot_ready = false;
  Reason fault = Reason::kNone;  // a fault of this side, now
  bool stop_latched = false;
  bool fault_released = false;      // the operator has reset the newest fault
  bool shutdown = false;            // this daemon is ending
  bool confirmed = true;            // the master has answered this session
  Reason obstacle = Reason::kNone;  // why this side cannot be engaged now
  Reason mismatch = Reason::kNone;  // first section in which the master differs
};

// Next state of the slave's session. A master that differs is not followed, from the start or any
// more; while it wants to lead, the reason says in what. Homing is becoming ready, never a motion:
// as aligning, but the robot is not there yet. Real-time safe.
SessionStep next_slave(SessionState state, const SlaveSessionInput& in) noexcept;

// The first of scene, mapping, limits and robot in which two sides differ; kNone: none. Tools are
// compared as they change. Real-time safe.
template <typename A, typename B>
Reason first_difference(const A& a, const B& b) noexcept {
  if (a.scene != b.scene) return Reason::kSceneDiffers;
  if (a.hashes.mapping != b.hashes.mapping) return Reason::kHashMapping;
  if (a.hashes.limits != b.hashes.limits) return Reason::kHashLimits;
  if (a.hashes.robot != b.hashes.robot) return Reason::kHashRobot;
  return Reason::kNone;
}

// True while the slave moves toward commands.
constexpr bool follows(SessionState state) noexcept {
  return state == SessionState::kEngaged || state == SessionState::kClutched;
}

}  // namespace handrail
