#include "server/model/reason.h"

namespace handrail {

const char* describe(Reason reason) noexcept {
  switch (reason) {
    case Reason::kNone: return "none";
    case Reason::kNotEngaged: return "not engaged";
    case Reason::kNoPeer: return "no datagram from the other side";
    case Reason::kLinkStale: return "newest datagram is over 5 ms old: slowing";
    case Reason::kLinkHold: return "newest datagram is over 20 ms old: stopped on the path";
    case Reason::kLinkLost: return "link lost for over 200 ms: reset, then engage again";
    case Reason::kSessionClosed:
      return "the other side was silent for over 1 s or restarted: engage again";
    case Reason::kHashTools: return "master and slave hold different tools";
    case Reason::kHashMapping: return "master and slave hold different workspace mappings";
    case Reason::kHashLimits: return "master and slave hold different limits";
    case Reason::kHashRobot: return "master and slave describe different robots";
    case Reason::kSceneDiffers: return "master and slave have different scenes loaded";
    case Reason::kAlignmentMismatch: return "the first command is too far from the held pose";
    case Reason::kStopRequested: return "stop was requested: reset, then engage again";
    case Reason::kPeerFault: return "the other side is in fault";
    case Reason::kRobotNotConnected: return "the robot controller is not connected";
    case Reason::kRobotSilent:
      return "the controller missed cycles in motion: the arm was halted and goes on from rest";
    case Reason::kRobotLost: return "the controller has not replied for a second and a half";
    case Reason::kRobotBadPacket: return "the controller sent a packet of the wrong size or type";
    case Reason::kSensorMissing: return "the force sensor is silent: bumper inactive";
    case Reason::kSensorInvalid: return "the force sensor reported an invalid value";
    case Reason::kCommandInvalid:
      return "a command was not finite or not a rotation: the previous one is kept";
    case Reason::kOutOfReach:
      return "out of reach: held at the boundary, move back toward the base";
    case Reason::kJointRange: return "a joint is at the end of its range: move back";
    case Reason::kJointSpeed: return "joint speed limit: following more slowly";
    case Reason::kJointAcceleration: return "joint acceleration limit: following more slowly";
    case Reason::kTipSpeed: return "tip speed limit: following more slowly";
    case Reason::kSingularity: return "near a singular pose: following more slowly";
    case Reason::kBumper: return "contact force over the bumper's threshold: not pushing further";
    case Reason::kShutdown: return "shutting down";
    case Reason::kClutched: return "clutched: hand free, arm holds";
    case Reason::kToolBlending: return "easing after a change of tool";
    case Reason::kForceClamped: return "device force limit reached";
    case Reason::kForceContinuous: return "device continuous force limit reached";
    case Reason::kForceRate: return "force step limited";
    case Reason::kForceBudget:
      return "spring reduced so that the tool keeps its share of the force";
    case Reason::kForceFaded: return "force faded";
    case Reason::kDeviceInvalid: return "the haptic device reported an invalid pose";
    case Reason::kToolEndBehindStart: return "the end point lies behind the start";
    case Reason::kToolDirectionZero: return "the direction has no length";
    case Reason::kToolValueInvalid: return "a tool value is not finite or out of range";
    case Reason::kNoSuchTool: return "no such tool";
    case Reason::kBusy: return "only possible when disengaged";
    case Reason::kNotStopped: return "nothing to reset";
    case Reason::kNotSimulated: return "only possible with a simulated device";
    case Reason::kSceneNotLoaded:
      return "the slave cannot load the master's scene: its log says why";
    case Reason::kNoArmInScene:
      return "the scene has walls for the hand alone: no robot takes part";
    case Reason::kNoSuchStage: return "the scene's walls have no such stage";
    case Reason::kHoming: return "getting ready: robot not placed or device not calibrated";
    case Reason::kPresence: return "the enabling device is not held";
    case Reason::kLinkQuality: return "the link was not good for a whole second";
    case Reason::kLoopAge: return "commands take long there and back";
    case Reason::kNotConfirmed: return "the other side has not answered this session yet";
    case Reason::kToolTube: return "kept on the active tool";
    case Reason::kWorkspace: return "end of the workspace: move back";
    case Reason::kJointJerk: return "joint jerk limit: following more slowly";
    case Reason::kFollowingError: return "the robot does not follow its command";
    case Reason::kSensorStuck: return "the force sensor repeats itself";
    case Reason::kEncoderInvalid:
      return "the robot reports joint positions that cannot be: not finite, jumped or out of range";
    case Reason::kThreadStalled: return "a control loop stood still";
    case Reason::kStopInput: return "the stop circuit is open";
    case Reason::kLeaseLost: return "the operator's lease has ended";
    case Reason::kApproach: return "slow approach: a contact stays below the promised force";
    case Reason::kSensorSign: return "the force sensor pulls where a surface must push: wrong sign";
    case Reason::kContactUnrelieved: return "backing off does not relieve the contact force";
    case Reason::kToolFar: return "the tool is too far from the tip";
    case Reason::kOtherMaster: return "the slave is led by another master";
    case Reason::kCount: break;
  }
  return "unknown reason";
}

}  // namespace handrail
