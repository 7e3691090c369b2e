#include "server/model/reason.h"

#include <array>
#include <cstddef>

namespace handrail {
namespace {

struct Sentence {
  Reason reason;
  const char* text;
};

constexpr auto kSentences = std::to_array<Sentence>({
    {Reason::kNone, "none"},
    {Reason::kNotEngaged, "not engaged"},
    {Reason::kNoPeer, "no datagram from the other side"},
    {Reason::kLinkStale, "newest datagram is over 5 ms old: slowing"},
    {Reason::kLinkHold, "newest datagram is over 20 ms old: stopped on the path"},
    {Reason::kLinkLost, "link lost for over 200 ms: reset, then engage again"},
    {Reason::kSessionClosed, "the other side was silent for over 1 s or restarted: engage again"},
    {Reason::kHashTools, "master and slave hold different tools"},
    {Reason::kHashMapping, "master and slave hold different workspace mappings"},
    {Reason::kHashLimits, "master and slave hold different limits"},
    {Reason::kHashRobot, "master and slave describe different robots"},
    {Reason::kSceneDiffers, "master and slave have different scenes loaded"},
    {Reason::kAlignmentMismatch, "the first command is too far from the held pose"},
    {Reason::kStopRequested, "stop was requested: reset, then engage again"},
    {Reason::kPeerFault, "the other side is in fault"},
    {Reason::kRobotNotConnected, "the robot controller is not connected"},
    {Reason::kRobotSilent,
     "the controller misses cycles: the arm is held where it is and goes on from rest"},
    {Reason::kRobotLost, "the controller has not replied for a second and a half"},
    {Reason::kRobotBadPacket, "the controller sent a packet of the wrong size or type"},
    {Reason::kSensorMissing, "no valid force reading: bumper inactive"},
    {Reason::kSensorInvalid, "the force sensor reported an invalid value"},
    {Reason::kCommandInvalid,
     "a command was not finite or not a rotation: the previous one is kept"},
    {Reason::kOutOfReach, "out of reach: held at the boundary, move back toward the base"},
    {Reason::kJointRange, "a joint is at the end of its range: move back"},
    {Reason::kJointSpeed, "joint speed limit: following more slowly"},
    {Reason::kJointAcceleration, "joint acceleration limit: following more slowly"},
    {Reason::kTipSpeed, "tip speed limit: following more slowly"},
    {Reason::kSingularity, "near a singular pose: following more slowly"},
    {Reason::kBumper, "contact force over the bumper's threshold: not pushing further"},
    {Reason::kShutdown, "shutting down"},
    {Reason::kClutched, "clutched: hand free, arm holds"},
    {Reason::kToolBlending, "easing after a change of tool"},
    {Reason::kForceClamped, "device force limit reached"},
    {Reason::kForceContinuous, "device continuous force limit reached"},
    {Reason::kForceRate, "force step limited"},
    {Reason::kForceBudget, "spring reduced so that the tool keeps its share of the force"},
    {Reason::kForceFaded, "force faded"},
    {Reason::kDeviceInvalid, "the haptic device reported an invalid pose"},
    {Reason::kToolEndBehindStart, "the end point lies behind the start"},
    {Reason::kToolDirectionZero, "the direction has no length"},
    {Reason::kToolValueInvalid, "a tool value is not finite or out of range"},
    {Reason::kNoSuchTool, "no such tool"},
    {Reason::kBusy, "only possible when disengaged"},
    {Reason::kNotStopped, "nothing to reset"},
    {Reason::kNotSimulated, "only possible with a simulated device"},
    {Reason::kSceneNotLoaded, "the slave cannot load the master's scene: its log says why"},
    {Reason::kNoArmInScene, "the scene has walls for the hand alone: no robot takes part"},
    {Reason::kNoSuchStage, "the scene's walls have no such stage"},
    {Reason::kHoming, "getting ready: robot not placed or device not calibrated"},
    {Reason::kPresence, "the enabling device is not held"},
    {Reason::kLinkQuality, "the link is not good enough"},
    {Reason::kLoopAge, "commands take long there and back"},
    {Reason::kNotConfirmed, "the other side has not answered this session yet"},
    {Reason::kToolTube, "kept on the active tool"},
    {Reason::kWorkspace, "end of the workspace: move back"},
    {Reason::kJointJerk, "joint jerk limit: following more slowly"},
    {Reason::kFollowingError, "the robot does not follow its command"},
    {Reason::kSensorStuck, "the force sensor repeats itself"},
    {Reason::kEncoderInvalid,
     "the robot reports joint positions that cannot be: not finite, jumped or out of range"},
    {Reason::kThreadStalled, "a control loop stood still"},
    {Reason::kStopInput, "the stop circuit is open"},
    {Reason::kLeaseLost, "the operator's lease has ended"},
    {Reason::kApproach, "slow approach: a contact stays below the promised force"},
    {Reason::kSensorSign, "the force sensor pulls where a surface must push: wrong sign"},
    {Reason::kContactUnrelieved, "backing off does not relieve the contact force"},
    {Reason::kToolFar, "the tool is too far from the tip"},
    {Reason::kOtherMaster, "the slave is led by another master"},
    {Reason::kForceEnergy, "force lowered so that it makes no energy"},
    {Reason::kSurfaceElsewhere, "the touched surface is told elsewhere: its model fades"},
    {Reason::kSurfaceNotFelt, "nothing is felt behind the touched surface: its model fades"},
    {Reason::kHandElsewhere, "absolute mapping: the hand is not where the arm is"},
    {Reason::kRobotStopPressed, "the robot controller is silent: its emergency stop is pressed"},
    {Reason::kRobotAlarm, "the robot controller is silent: an alarm stands"},
    {Reason::kRobotTeaching, "the robot controller is silent: it is in TEACH, not in AUTOMATIC"},
    {Reason::kRobotMachineLock, "the robot controller is silent: its machine lock is on"},
    {Reason::kRobotProgram,
     "the robot controller is silent: the program that answers does not run"},
    {Reason::kRobotSlow, "the robot controller is silent: its speed override is below 100 %"},
    {Reason::kRobotServosOff, "the robot controller is silent: its servos are off"},
    {Reason::kSensorOverrange, "the force sensor is over its range"},
});

// One for every reason, in their order.
constexpr bool complete() {
  for (std::size_t i = 0; i < kSentences.size(); ++i) {
    if (kSentences[i].reason != static_cast<Reason>(i)) return false;
  }
  return kSentences.size() == static_cast<std::size_t>(Reason::kCount);
}
static_assert(complete());

}  // namespace

const char* describe(Reason reason) noexcept {
  const auto at = static_cast<std::size_t>(reason);
  return at < kSentences.size() ? kSentences[at].text : "unknown reason";
}

}  // namespace handrail
