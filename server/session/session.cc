#include "server/session/session.h"

#include <algorithm>

#include "server/base/deletable.h"

namespace handrail {
namespace {

constexpr SessionState kOff = SessionState::kOff;
constexpr SessionState kAligning = SessionState::kAligning;
constexpr SessionState kEngaged = SessionState::kEngaged;
constexpr SessionState kClutched = SessionState::kClutched;
constexpr SessionState kHold = SessionState::kHold;
constexpr SessionState kFault = SessionState::kFault;
constexpr SessionState kHoming = SessionState::kHoming;

// Of age_after() [ns].
constexpr Nanos kUnseenAge = 20 * kMillisecond;

bool lost(LinkRung link) {
  return link == LinkRung::kNone || link == LinkRung::kLost || link == LinkRung::kClosed;
}

template <typename Input>
bool confirmed(const Input& in) {
  return in.confirmed || !kept(Check::kConfirmed);
}

SessionState driving(Desired desired) {
  return desired == Desired::kClutched ? kClutched : kEngaged;
}

}  // namespace

Reason reason_of(LinkRung link) noexcept {
  switch (link) {
    case LinkRung::kNone:
    case LinkRung::kLost: return Reason::kNoPeer;
    case LinkRung::kFresh: return Reason::kNone;
    case LinkRung::kSlow: return Reason::kLinkStale;
    case LinkRung::kHold: return Reason::kLinkHold;
    case LinkRung::kClosed: return Reason::kSessionClosed;
  }
  return Reason::kNone;
}

Nanos age_after(Nanos unseen, Nanos age) noexcept {
  return unseen > kUnseenAge && kept(Check::kUnseen) ? std::max(age, unseen) : age;
}

LinkRung rung_of(bool ever, Nanos age) noexcept {
  if (!ever) return LinkRung::kNone;
  if (age <= 5 * kMillisecond) return LinkRung::kFresh;
  if (age <= 20 * kMillisecond || !kept(Check::kWatchdog)) return LinkRung::kSlow;
  if (age <= 200 * kMillisecond || !kept(Check::kLatch)) return LinkRung::kHold;
  if (age <= kSecond) return LinkRung::kLost;
  return LinkRung::kClosed;
}

SessionStep next_master(SessionState state, const MasterSessionInput& in) noexcept {
  if (in.stop_latched) return {kFault, Reason::kStopRequested};
  switch (state) {
    case kOff:
    case kHoming:
      if (in.desired == Desired::kOff) return {kOff, Reason::kNotEngaged};
      if (!flowing(in.link)) return {kOff, reason_of(in.link)};
      if (!confirmed(in)) return {kOff, Reason::kNotConfirmed};
      if (in.peer == kFault) return {kOff, Reason::kPeerFault};
      if (in.mismatch != Reason::kNone) return {kOff, in.mismatch};
      if (in.obstacle != Reason::kNone) return {kOff, in.obstacle};
      if (in.ready) return {kAligning, Reason::kNone};
      return {in.overdue ? kOff : kHoming, Reason::kHoming};
    case kAligning:
      if (in.desired == Desired::kOff) return {kOff, Reason::kNotEngaged};
      if (in.peer == kFault) return {kFault, Reason::kPeerFault};
      if (lost(in.link)) return {kOff, reason_of(in.link)};
      if (flowing(in.link) && follows(in.peer) && in.same_engagement) {
        return {driving(in.desired), Reason::kNone};
      }
      if (in.obstacle != Reason::kNone) return {kOff, in.obstacle};
      if (in.overdue) {
        return {kOff, in.peer == kHoming ? Reason::kHoming : Reason::kAlignmentMismatch};
      }
      return {kAligning, in.peer == kHoming ? Reason::kHoming : Reason::kNone};
    case kEngaged:
    case kClutched:
    case kHold:
      if (in.desired == Desired::kOff) return {kOff, Reason::kNotEngaged};
      if (lost(in.link)) return {kFault, Reason::kLinkLost};
      if (in.peer == kFault) return {kFault, Reason::kPeerFault};
      // The slave left the engagement without a fault: it restarted.
      if (in.peer == kOff || in.peer == kAligning || in.peer == kHoming || !in.same_engagement)
        return {kFault, Reason::kSessionClosed};
      if (!flowing(in.link) || in.peer == kHold) return {kHold, Reason::kLinkHold};
      if (!confirmed(in)) return {kHold, Reason::kNotConfirmed};
      return {driving(in.desired),
              in.desired == Desired::kClutched ? Reason::kClutched : reason_of(in.link)};
    case kFault:
      if (in.reset) return {kOff, Reason::kNotEngaged};
      return {kFault, Reason::kNone};  // the reason stays the one that led here
    case SessionState::kCount: break;
  }
  return {kFault, Reason::kNone};
}

SessionStep next_slave(SessionState state, const SlaveSessionInput& in) noexcept {
  if (in.stop_latched) return {kFault, Reason::kStopRequested};
  if (in.fault != Reason::kNone) return {kFault, in.fault};
  if (in.shutdown && state != kFault) return {kOff, Reason::kShutdown};
  switch (state) {
    case kOff:
    case kHoming: {
      const bool differs = in.desired != Desired::kOff && in.mismatch != Reason::kNone;
      const bool asked = flowing(in.link) && confirmed(in) && !differs &&
                         in.desired != Desired::kOff && in.master == kAligning;
      if (!in.robot_ready) return {asked ? kHoming : kOff, Reason::kRobotNotConnected};
      if (!flowing(in.link)) return {kOff, reason_of(in.link)};
      if (!confirmed(in)) return {kOff, Reason::kNotConfirmed};
      if (differs) return {kOff, in.mismatch};
      if (in.obstacle != Reason::kNone) return {kOff, in.obstacle};
      if (!asked) return {kOff, Reason::kNotEngaged};
      return {kAligning, Reason::kNone};
    }
    case kAligning:
      if (!in.same_engagement || in.desired == Desired::kOff || in.master == kFault) {
        return {kOff, Reason::kNotEngaged};
      }
      if (!flowing(in.link)) return {kOff, reason_of(in.link)};
      if (!confirmed(in)) return {kOff, Reason::kNotConfirmed};
      if (in.mismatch != Reason::kNone) return {kOff, in.mismatch};
      if (!in.robot_ready) return {kOff, Reason::kRobotNotConnected};
      if (in.obstacle != Reason::kNone) return {kOff, in.obstacle};
      if (!in.aligned) return {kAligning, Reason::kAlignmentMismatch};
      return {kEngaged, Reason::kNone};
    case kEngaged:
    case kClutched:
    case kHold:
      if (!in.same_engagement) return {kOff, Reason::kSessionClosed};
      if (lost(in.link)) return {kFault, Reason::kLinkLost};
      if (!flowing(in.link)) return {kHold, Reason::kLinkHold};
      if (!confirmed(in)) return {kHold, Reason::kNotConfirmed};
      if (in.desired == Desired::kOff || in.master == kOff || in.master == kFault) {
        return {kOff, Reason::kNotEngaged};
      }
      if (in.mismatch != Reason::kNone) return {kOff, in.mismatch};
      return {driving(in.desired),
              in.desired == Desired::kClutched ? Reason::kClutched : reason_of(in.link)};
    case kFault:
      if (in.fault_released && in.robot_ready) return {kOff, Reason::kNotEngaged};
      return {kFault, Reason::kNone};
    case SessionState::kCount: break;
  }
  return {kFault, Reason::kNone};
}

}  // namespace handrail
