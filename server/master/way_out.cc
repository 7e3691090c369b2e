#include "server/master/way_out.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "server/base/units.h"
#include "server/kinematics/rv2a.h"

namespace handrail {
namespace {

std::string then_engage(const std::string& first, Stand stand) {
  return first + (stand == Stand::kLatched ? ", then reset and engage"
                  : stand == Stand::kOff   ? ", then engage"
                                           : "");
}

// What has to be put right, somewhere, before anything else; empty: nothing.
std::string put_right(Reason reason, int joint, const JointVector& q) {
  switch (reason) {
    case Reason::kHoming: return "calibrate the haptic device, wait for the arm";
    case Reason::kRobotLost:
    case Reason::kRobotNotConnected:
      return "at the controller: clear its alarm, if there is one, and start its program in "
             "AUTOMATIC; the slave's log names other causes";
    case Reason::kRobotStopPressed:
      return "release the controller's emergency stop, and clear its alarm";
    case Reason::kRobotAlarm:
      return "take the cause of the controller's alarm away, and clear it; 'handrail robot status' "
             "names it";
    case Reason::kRobotTeaching: return "turn the controller's key to AUTOMATIC";
    case Reason::kRobotMachineLock: return "take the machine lock away at the controller";
    case Reason::kRobotProgram:
    case Reason::kRobotServosOff: return "'handrail robot on', or at the controller";
    case Reason::kRobotSlow: return "'handrail robot on --override 100'";
    case Reason::kRobotBadPacket: return "correct packet_bytes in the slave's configuration";
    case Reason::kEncoderInvalid:
    case Reason::kFollowingError:
      if (joint < 0) return "look at the encoders";
      return fmt::format("look at J{}, which reads {:.1f} deg", joint + 1, q[joint] / kDeg);
    case Reason::kSensorStuck:
    case Reason::kSensorInvalid:
    case Reason::kSensorMissing:
    case Reason::kSensorSign:
    case Reason::kContactUnrelieved: return "check the force sensor";
    case Reason::kSensorOverrange:
      return "move the arm off what it presses on, at the controller or led in a scene without a "
             "bumper; where it presses on nothing, check the force sensor";
    case Reason::kHashTools:
    case Reason::kHashMapping:
    case Reason::kHashLimits:
    case Reason::kHashRobot:
    case Reason::kSceneDiffers:
    case Reason::kSceneNotLoaded: return "give both sides the same scene and version";
    case Reason::kDeviceInvalid: return "check the haptic device";
    case Reason::kNoArmInScene: return "load a scene with an arm: 'handrail scene load NAME'";
    case Reason::kNoPeer: return "start the slave, or check the network";
    case Reason::kShutdown:
    case Reason::kSessionClosed: return "start the slave if it does not run";
    case Reason::kOtherMaster:
      return "end that master: then the slave takes this one, without a restart";
    case Reason::kStopInput: return "close the stop circuit";
    default: return {};
  }
}

// What is done at the master alone: orders, the enabling button, patience; empty: nothing.
std::string order_to_give(Reason reason, Stand stand) {
  switch (reason) {
    case Reason::kNotEngaged: return "engage";
    case Reason::kStopRequested:
    case Reason::kLinkLost:
    case Reason::kPeerFault:  // of a slave that has been started anew since
      return stand == Stand::kLatched ? "reset, then engage" : "engage";
    case Reason::kAlignmentMismatch: return stand == Stand::kLed ? "wait" : "engage";
    case Reason::kThreadStalled: return "wait; if it lasts, start the master anew";
    case Reason::kLinkStale:
    case Reason::kLinkHold:
    case Reason::kLinkQuality:
    case Reason::kNotConfirmed:
      return stand == Stand::kLed ? "wait for the link, or move slower"
                                  : then_engage("wait for the link", stand);
    case Reason::kClutched: return "let the clutch go";
    case Reason::kHandElsewhere:
      return stand == Stand::kLed ? "lead the hand to where the arm is"
                                  : then_engage("lead the hand to where the arm is", stand);
    case Reason::kPresence:
      if (stand == Stand::kLed) {
        return "hold the enabling button, or keep 'handrail engage --hold' running";
      }
      return std::string(stand == Stand::kLatched ? "reset, then " : "") +
             "hold the enabling button and engage, or keep 'handrail engage --hold' running";
    case Reason::kLeaseLost: return "take the lease and engage: 'handrail lease take'";
    default: return {};
  }
}

// Out of the singular configuration that the arm is nearest to, each by what counts as near.
const char* way_out_of_singularity(const JointVector& q) {
  constexpr double kNearSine = 0.1, kNearAxis = 0.020;  // [m]
  const SingularityMargin margin = singularity_margin(ArmGeometry(), q);
  const double wrist = margin.wrist / kNearSine, shoulder = margin.shoulder / kNearAxis;
  if (margin.elbow / kNearSine < std::min(wrist, shoulder)) return "come back toward the base";
  return wrist <= shoulder ? "tilt the tip away from the forearm's axis"
                           : "move out from the base axis";
}

// How the hand should move while it leads the arm; empty: as it likes.
std::string way_of_the_hand(Reason reason, int joint, const JointVector& q) {
  switch (reason) {
    case Reason::kRobotSilent:
      return "wait: it goes on by itself; if it comes again, look at the controller's cable, its "
             "network and the load of the slave's computer";
    case Reason::kLoopAge: return "move slower: what you see is old";
    case Reason::kOutOfReach: return "come back toward the base";
    case Reason::kWorkspace: return "come back into the workspace";
    case Reason::kJointRange:
      return joint >= 0 ? fmt::format("turn J{} back", joint + 1) : "turn back";
    case Reason::kSingularity: return way_out_of_singularity(q);
    case Reason::kJointSpeed:
    case Reason::kJointAcceleration:
    case Reason::kJointJerk:
    case Reason::kTipSpeed:
    case Reason::kApproach: return "wait, or move slower";
    case Reason::kToolBlending: return "wait";
    case Reason::kBumper: return "move away from the contact";
    default: return {};
  }
}

}  // namespace

std::string way_out_of(Reason reason, int joint, const JointVector& q, Stand stand) {
  const std::string first = put_right(reason, joint, q);
  if (!first.empty()) return then_engage(first, stand);
  const std::string order = order_to_give(reason, stand);
  return order.empty() ? way_of_the_hand(reason, joint, q) : order;
}

std::vector<WayOutOrder> orders_out_of(Reason reason, Stand stand) {
  using enum WayOutOrder;
  switch (reason) {
    case Reason::kNone:
    case Reason::kNoArmInScene:
    case Reason::kThreadStalled: return {};
    case Reason::kClutched: return {kClutchOff};
    default: break;
  }
  if (stand == Stand::kLed) return {};
  std::vector<WayOutOrder> out;
  if (reason == Reason::kLeaseLost) out.push_back(kTakeLease);
  if (stand == Stand::kLatched) out.push_back(kReset);
  out.push_back(kEngage);
  return out;
}

}  // namespace handrail
