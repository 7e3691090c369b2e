// Why something was held, clamped or refused. Every intervention carries one of these codes into
// the status, so that nobody has to guess why the robot is not where the hand is.
#pragma once

#include <cstdint>

namespace handrail {

enum class Reason : std::uint8_t {
  kNone = 0,
  // Session and link
  kNotEngaged,
  kNoPeer,         // no datagram from the other side within the link's patience
  kLinkStale,      // newest datagram older than 5 ms: slowed
  kLinkHold,       // older than 20 ms: stopped on the path, resumes by itself
  kLinkLost,       // older than 200 ms: latched until reset
  kSessionClosed,  // older than 1 s, or the peer restarted
  kHashTools,      // the two sides hold different tools
  kHashMapping,
  kHashLimits,
  kHashRobot,
  kSceneDiffers,       // the two sides hold different scenes
  kAlignmentMismatch,  // first command too far from the held pose
  kStopRequested,      // latched stop epoch
  kPeerFault,
  // Robot and sensor
  kRobotNotConnected,
  kRobotSilent,     // cycles of the controller missed: the arm was halted, goes on from rest
  kRobotLost,       // no reply from the controller for 1.4 s
  kRobotBadPacket,  // wrong size or type from the controller
  kSensorMissing,   // silent or in fault: bumper inactive
  kSensorInvalid,   // non-finite reading, or a spike
  // Motion limits
  kCommandInvalid,  // non-finite or not a rotation: previous one kept
  kOutOfReach,      // no joint solution further along the path
  kJointRange,
  kJointSpeed,
  kJointAcceleration,
  kTipSpeed,
  kSingularity,  // near a singular pose: slowed
  kBumper,       // contact force above the threshold
  kShutdown,     // the daemon was told to end
  // Master side
  kClutched,
  kToolBlending,     // the guide is still easing toward a new tool
  kForceClamped,     // device force limit
  kForceContinuous,  // continuous (thermal) force limit
  kForceRate,        // force step limited
  kForceBudget,      // spring reduced so that the tool keeps its share
  kForceFaded,       // force faded because the link or the device is not to be trusted
  kDeviceInvalid,    // the haptic device reported a non-finite pose
  kToolEndBehindStart,
  kToolDirectionZero,
  kToolValueInvalid,  // non-finite or out of range
  kNoSuchTool,
  kBusy,            // only possible when disengaged
  kNotStopped,      // nothing to reset
  kNotSimulated,    // only possible with a simulated device
  kSceneNotLoaded,  // the slave cannot load the master's scene
  kNoArmInScene,    // the scene has walls for the hand, no robot takes part
  kNoSuchStage,     // the scene's walls have no such stage
  // Session, presence and monitors
  kHoming,        // robot not placed or device not calibrated yet
  kPresence,      // nobody holds the enabling device
  kLinkQuality,   // the link is POOR, or was not good enough to engage over
  kLoopAge,       // a command's way there and back takes longer than the scene allows
  kNotConfirmed,  // the other side has not answered this session yet
  kToolTube,      // the slave moved the command onto the active tool
  kWorkspace,     // the tip is at the end of the workspace
  kJointJerk,
  kFollowingError,  // the robot does not follow its command
  kSensorStuck,     // the force sensor repeats itself
  kEncoderInvalid,  // joint positions not finite, jumped or out of range
  kThreadStalled,   // a control loop of this side stood still
  kStopInput,       // the local stop circuit is open
  kLeaseLost,       // the lease of whoever engaged has ended
  // Contact
  kApproach,           // slower than commanded, so that a contact stays below the promised force
  kSensorSign,         // the force points the way the tip goes in: no surface does that
  kContactUnrelieved,  // the force stays over the bumper's threshold although the arm backs off
  kToolFar,            // further from the tip than a call may be
  // Two masters
  kOtherMaster,  // the slave is led by another master
  // Energy at the hand
  kForceEnergy,  // force lowered so that what is rendered makes no energy
  // The touched surface at the hand
  kSurfaceElsewhere,  // it is told where it cannot have gone to: its model fades
  kSurfaceNotFelt,    // the tip is behind it and is not pushed: its model fades
  // The mapping
  kHandElsewhere,  // absolute mapping: the hand is not where the arm is
  // Why a robot controller is silent, as its own switches tell
  kRobotStopPressed,
  kRobotAlarm,
  kRobotTeaching,
  kRobotMachineLock,
  kRobotProgram,  // none runs that could answer, or another one
  kRobotSlow,     // its speed override is below 100 %
  kRobotServosOff,
  // The force sensor again
  kSensorOverrange,  // an axis is at the end of its range: how large the force is nobody knows
  kCount
};

// One short English sentence fragment for `reason`, static storage. Never null.
const char* describe(Reason reason) noexcept;

}  // namespace handrail
