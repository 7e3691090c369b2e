// Checks that the lab can leave out, to show that the fault matrix needs every one of them.
#pragma once

#include <cstdint>

namespace handrail {

enum class Check : std::uint8_t {
  kFinite,        // the guard's
  kWorkspace,     //
  kRange,         //
  kSpeed,         //
  kAcceleration,  //
  kJerk,          //
  kFollowing,     // the arm does not follow
  kSensor,        // no or bad readings of the force sensor
  kStuck,         // it repeats itself although it has noise
  kUnchanged,     // it repeats itself although its load must have changed
  kEncoder,       // bad measured joints
  kWatchdog,      // nothing fresh for 20 ms: slow, hold, poor
  kLatch,         // nothing fresh for 200 ms: an operator has to engage again
  kSequence,      // only a rising sequence is newest
  kConfirmed,     // a session that has not answered this one is not obeyed
  kStopEpoch,     // the operator's stop in every datagram
  kPresence,      // somebody is there
  kLoopAge,       // the loop's age is said and fades the force
  kQuality,       // a poor link holds, engaging waits for a good one
  kStaleSend,     // what a loop has not renewed is not sent
  kToolTube,      // the slave's own hold on the tools
  kLease,         // one operator drives
  kStopInput,     // the local stop circuit
  kContact,       // the bumper
  kSensorSign,    // a force that grows the way the tip goes
  kRelief,        // a force that backing off does not relieve
  kHashes,        // the slave's own look at the master's scene
  kToolReach,     // no tool is called further from the tip than the scene says
  kToolLatch,     // a hand that a tool held back does not take the arm along once it lets go
  kStay,          // no tip leaves a target that stands out of reach
  kReach,         // a target is a rated step from all that the controller may hold
  kWay,           // no session opens over too long a way to the controller
  kPhase,         // a reply before its cycle is not taken for the next one's
  kPrompt,        // an answer that may be of the cycle before shows no queue
  kInTime,        // a target that may miss its cycle is not sent
  kBegun,         // no cycle is counted before it has surely begun
  kHeardEnd,      // a motion's end that the controller was not heard to hold is not sent again
  kUnseen,        // after time that passed unseen nothing known is younger
  kMasterHold,    // a master in hold leads nobody
  kArmRange,      // an arm is nowhere beyond its ranges
  kEpochs,        // a program's epochs begin at a number of its own
  kResetSeen,     // a reset counts for the fault it has seen
  kOneMaster,     // another master waits until the present one is silent
  kLag,           // a promise reckons with how late the arm may be
  kCount
};

// Whether a check is made. Always, but in a build with HANDRAIL_DELETABLE, which no daemon accepts.
#ifdef HANDRAIL_DELETABLE
inline constexpr bool kDeletable = true;
inline std::uint64_t deleted_checks = 0;  // a bit for each; changed only while nothing else runs
inline bool kept(Check check) noexcept {
  return ((deleted_checks >> static_cast<unsigned>(check)) & 1u) == 0;
}
#else
inline constexpr bool kDeletable = false;
constexpr bool kept(Check) noexcept { return true; }
#endif

}  // namespace handrail
