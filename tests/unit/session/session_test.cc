#include "server/session/session.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace handrail {
namespace {

constexpr LinkRung kRungs[] = {LinkRung::kNone, LinkRung::kFresh, LinkRung::kSlow,
                               LinkRung::kHold, LinkRung::kLost,  LinkRung::kClosed};
constexpr SessionState kStates[] = {
    SessionState::kOff,  SessionState::kAligning, SessionState::kEngaged, SessionState::kClutched,
    SessionState::kHold, SessionState::kFault,    SessionState::kHoming};
constexpr Desired kWishes[] = {Desired::kOff, Desired::kEngaged, Desired::kClutched};

bool one_of(SessionState state, std::initializer_list<SessionState> set) {
  return std::find(set.begin(), set.end(), state) != set.end();
}

// What the master may do next, by name; everything not named here stays where it is.
bool master_may(SessionState from, SessionState to) {
  using enum SessionState;
  switch (from) {
    case kOff:
    case kHoming: return one_of(to, {kOff, kHoming, kAligning, kFault});
    case kAligning: return one_of(to, {kAligning, kOff, kEngaged, kClutched, kFault});
    case kEngaged:
    case kClutched:
    case kHold: return one_of(to, {kOff, kEngaged, kClutched, kHold, kFault});
    case kFault: return one_of(to, {kFault, kOff});
    case kCount: break;
  }
  return false;
}

bool slave_may(SessionState from, SessionState to) {
  using enum SessionState;
  switch (from) {
    case kOff:
    case kHoming: return one_of(to, {kOff, kHoming, kAligning, kFault});
    case kAligning: return one_of(to, {kAligning, kOff, kEngaged, kFault});
    case kEngaged:
    case kClutched:
    case kHold: return one_of(to, {kOff, kEngaged, kClutched, kHold, kFault});
    case kFault: return one_of(to, {kFault, kOff});
    case kCount: break;
  }
  return false;
}

template <typename F>
void for_every_master_input(F&& f) {
  for (const Desired desired : kWishes) {
    for (const LinkRung link : kRungs) {
      for (const SessionState peer : kStates) {
        for (const Reason mismatch : {Reason::kNone, Reason::kHashRobot}) {
          for (const bool stop : {false, true}) {
            for (const bool reset : {false, true}) {
              for (int bits = 0; bits < 32; ++bits) {
                f(MasterSessionInput{desired, link, peer, mismatch, stop, reset, (bits & 1) != 0,
                                     (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0,
                                     (bits & 16) != 0 ? Reason::kSensorMissing : Reason::kNone});
              }
            }
          }
        }
      }
    }
  }
}

template <typename F>
void for_every_slave_input(F&& f) {
  for (const Desired desired : kWishes) {
    for (const SessionState master : kStates) {
      for (const LinkRung link : kRungs) {
        for (int bits = 0; bits < 1024; ++bits) {
          const auto bit = [bits](int i) { return (bits >> i & 1) != 0; };
          f(SlaveSessionInput{desired, master, link, bit(0), bit(1), bit(2),
                              bit(3) ? Reason::kRobotBadPacket : Reason::kNone, bit(4), bit(5),
                              bit(6), bit(7), bit(8) ? Reason::kSensorMissing : Reason::kNone,
                              bit(9) ? Reason::kHashLimits : Reason::kNone});
        }
      }
    }
  }
}

TEST(Ladder, ChangesExactlyAt5And20And200And1000Milliseconds) {
  EXPECT_EQ(rung_of(false, 0), LinkRung::kNone);
  EXPECT_EQ(rung_of(true, 0), LinkRung::kFresh);
  EXPECT_EQ(rung_of(true, 5 * kMillisecond), LinkRung::kFresh);
  EXPECT_EQ(rung_of(true, 5 * kMillisecond + 1), LinkRung::kSlow);
  EXPECT_EQ(rung_of(true, 20 * kMillisecond), LinkRung::kSlow);
  EXPECT_EQ(rung_of(true, 20 * kMillisecond + 1), LinkRung::kHold);
  EXPECT_EQ(rung_of(true, 200 * kMillisecond), LinkRung::kHold);
  EXPECT_EQ(rung_of(true, 200 * kMillisecond + 1), LinkRung::kLost);
  EXPECT_EQ(rung_of(true, kSecond), LinkRung::kLost);
  EXPECT_EQ(rung_of(true, kSecond + 1), LinkRung::kClosed);
  EXPECT_EQ(rung_of(true, kForever), LinkRung::kClosed);
}

TEST(MasterSession, OnlyNamedTransitionsHappenForEveryInput) {
  for (const SessionState from : kStates) {
    for_every_master_input([from](const MasterSessionInput& in) {
      const SessionStep next = next_master(from, in);
      EXPECT_TRUE(master_may(from, next.state)) << name_of(from) << " -> " << name_of(next.state);
    });
  }
}

TEST(MasterSession, AStopFaultsFromEveryStateAndOutranksAReset) {
  for (const SessionState from : kStates) {
    for_every_master_input([from](MasterSessionInput in) {
      in.stop_latched = true;
      EXPECT_EQ(next_master(from, in).state, SessionState::kFault);
      EXPECT_EQ(next_master(from, in).reason, Reason::kStopRequested);
    });
  }
}

TEST(MasterSession, AlignsOnlyWithAFlowingConfirmedLinkAHealthyPeerAndEqualConfigurations) {
  for_every_master_input([](const MasterSessionInput& in) {
    const bool may = in.desired != Desired::kOff && !in.stop_latched &&
                     (in.link == LinkRung::kFresh || in.link == LinkRung::kSlow) &&
                     in.peer != SessionState::kFault && in.mismatch == Reason::kNone &&
                     in.confirmed && in.obstacle == Reason::kNone;
    for (const SessionState from : {SessionState::kOff, SessionState::kHoming}) {
      const SessionState next = next_master(from, in).state;
      EXPECT_EQ(next == SessionState::kAligning, may && in.ready);
      EXPECT_EQ(next == SessionState::kHoming, may && !in.ready && !in.overdue);
    }
  });
}

TEST(MasterSession, SaysWhyItStaysOff) {
  MasterSessionInput in;
  EXPECT_EQ(next_master(SessionState::kOff, in).reason, Reason::kNotEngaged);
  in.desired = Desired::kEngaged;
  EXPECT_EQ(next_master(SessionState::kOff, in).reason, Reason::kNoPeer);
  in.link = LinkRung::kFresh;
  in.peer = SessionState::kFault;
  EXPECT_EQ(next_master(SessionState::kOff, in).reason, Reason::kPeerFault);
  in.peer = SessionState::kOff;
  in.mismatch = Reason::kHashLimits;
  EXPECT_EQ(next_master(SessionState::kOff, in).reason, Reason::kHashLimits);
}

TEST(MasterSession, EngagesOnlyWhenTheSlaveFollowsInThisEngagement) {
  for_every_master_input([](const MasterSessionInput& in) {
    const SessionState next = next_master(SessionState::kAligning, in).state;
    if (next == SessionState::kEngaged || next == SessionState::kClutched) {
      EXPECT_TRUE(follows(in.peer) && in.same_engagement);
      EXPECT_EQ(next == SessionState::kClutched, in.desired == Desired::kClutched);
    }
  });
}

TEST(MasterSession, DrivesOnlyWhileTheLinkFlowsAndThePeerFollows) {
  for (const SessionState from :
       {SessionState::kEngaged, SessionState::kClutched, SessionState::kHold}) {
    for_every_master_input([from](const MasterSessionInput& in) {
      const SessionState next = next_master(from, in).state;
      const bool flowing = in.link == LinkRung::kFresh || in.link == LinkRung::kSlow;
      if (follows(next)) {
        EXPECT_TRUE(flowing && in.confirmed && follows(in.peer) && in.desired != Desired::kOff);
        EXPECT_TRUE(in.same_engagement);
      }
      if (in.desired == Desired::kOff && !in.stop_latched) {
        EXPECT_EQ(next, SessionState::kOff);
      }
    });
  }
}

TEST(MasterSession, HoldsOnAShortGapAndComesBackByItself) {
  MasterSessionInput in{Desired::kEngaged, LinkRung::kHold, SessionState::kEngaged,
                        Reason::kNone,     false,           false};
  EXPECT_EQ(next_master(SessionState::kEngaged, in).state, SessionState::kHold);
  EXPECT_EQ(next_master(SessionState::kEngaged, in).reason, Reason::kLinkHold);
  in.link = LinkRung::kFresh;
  EXPECT_EQ(next_master(SessionState::kHold, in).state, SessionState::kEngaged);
}

TEST(MasterSession, ALostLinkAFaultyPeerAndARestartedPeerLatch) {
  for (const SessionState from :
       {SessionState::kEngaged, SessionState::kClutched, SessionState::kHold}) {
    MasterSessionInput in{
        Desired::kEngaged, LinkRung::kFresh, SessionState::kEngaged, Reason::kNone, false, false};
    in.link = LinkRung::kLost;
    EXPECT_EQ(next_master(from, in).reason, Reason::kLinkLost);
    EXPECT_EQ(next_master(from, in).state, SessionState::kFault);
    in.link = LinkRung::kFresh;
    in.peer = SessionState::kFault;
    EXPECT_EQ(next_master(from, in).state, SessionState::kFault);
    in.peer = SessionState::kOff;
    EXPECT_EQ(next_master(from, in).state, SessionState::kFault);
  }
}

TEST(MasterSession, LeavesAFaultOnlyByReset) {
  for_every_master_input([](const MasterSessionInput& in) {
    const bool left = next_master(SessionState::kFault, in).state != SessionState::kFault;
    EXPECT_EQ(left, in.reset && !in.stop_latched);
  });
}

TEST(SlaveSession, OnlyNamedTransitionsHappenForEveryInput) {
  for (const SessionState from : kStates) {
    for_every_slave_input([from](const SlaveSessionInput& in) {
      const SessionStep next = next_slave(from, in);
      EXPECT_TRUE(slave_may(from, next.state)) << name_of(from) << " -> " << name_of(next.state);
    });
  }
}

TEST(SlaveSession, AStopAndAFaultLatchFromEveryState) {
  for (const SessionState from : kStates) {
    for_every_slave_input([from](const SlaveSessionInput& in) {
      if (!in.stop_latched && in.fault == Reason::kNone) return;
      const SessionStep next = next_slave(from, in);
      EXPECT_EQ(next.state, SessionState::kFault);
      EXPECT_EQ(next.reason, in.stop_latched ? Reason::kStopRequested : in.fault);
    });
  }
}

TEST(SlaveSession, EngagesOnlyFromAlignmentOnTheHeldPose) {
  for (const SessionState from : kStates) {
    for_every_slave_input([from](const SlaveSessionInput& in) {
      if (!follows(next_slave(from, in).state) || follows(from) || from == SessionState::kHold) {
        return;
      }
      EXPECT_EQ(from, SessionState::kAligning);
      EXPECT_TRUE(in.aligned);
      EXPECT_TRUE(in.same_engagement);
      EXPECT_EQ(in.obstacle, Reason::kNone);
      EXPECT_EQ(in.mismatch, Reason::kNone);
      EXPECT_TRUE(in.confirmed && in.robot_ready);
      EXPECT_TRUE(in.link == LinkRung::kFresh || in.link == LinkRung::kSlow);
    });
  }
}

TEST(SlaveSession, FollowsOnlyAFlowingLinkAndAMasterThatWantsIt) {
  for (const SessionState from :
       {SessionState::kEngaged, SessionState::kClutched, SessionState::kHold}) {
    for_every_slave_input([from](const SlaveSessionInput& in) {
      if (!follows(next_slave(from, in).state)) return;
      EXPECT_TRUE(in.link == LinkRung::kFresh || in.link == LinkRung::kSlow);
      EXPECT_NE(in.desired, Desired::kOff);
      EXPECT_TRUE(in.confirmed);
      EXPECT_TRUE(in.same_engagement);
      EXPECT_FALSE(in.shutdown);
      EXPECT_FALSE(in.master == SessionState::kOff || in.master == SessionState::kFault);
    });
  }
}

TEST(SlaveSession, AMasterThatDiffersIsNotAlignedWithAndNotFollowedAnyMore) {
  SlaveSessionInput in;
  in.desired = Desired::kEngaged;
  in.link = LinkRung::kFresh;
  in.robot_ready = in.aligned = true;
  for (const SessionState from :
       {SessionState::kOff, SessionState::kHoming, SessionState::kAligning, SessionState::kEngaged,
        SessionState::kClutched, SessionState::kHold}) {
    in.master = follows(from) ? SessionState::kEngaged : SessionState::kAligning;
    in.mismatch = Reason::kNone;
    EXPECT_NE(next_slave(from, in).state, SessionState::kOff) << name_of(from);
    for (const Reason mismatch : {Reason::kSceneDiffers, Reason::kHashMapping}) {
      in.mismatch = mismatch;
      EXPECT_EQ(next_slave(from, in).state, SessionState::kOff) << name_of(from);
      EXPECT_EQ(next_slave(from, in).reason, mismatch) << name_of(from);
    }
  }
  // One that wants nothing may differ: it is about to load its scene.
  in.desired = Desired::kOff;
  EXPECT_EQ(next_slave(SessionState::kOff, in).reason, Reason::kNotEngaged);
}

TEST(SlaveSession, ADifferenceNeverHidesAHoldOrALostLink) {
  for (const SessionState from :
       {SessionState::kEngaged, SessionState::kClutched, SessionState::kHold}) {
    for_every_slave_input([from](SlaveSessionInput in) {
      const SessionState without = next_slave(from, in).state;
      in.mismatch = Reason::kHashRobot;
      const SessionState with = next_slave(from, in).state;
      EXPECT_TRUE(with == without || (follows(without) && with == SessionState::kOff));
    });
  }
}

TEST(SlaveSession, ARestartedMasterHasToEngageAgain) {
  for (const SessionState from :
       {SessionState::kEngaged, SessionState::kClutched, SessionState::kHold}) {
    SlaveSessionInput in;
    in.desired = Desired::kEngaged;
    in.master = SessionState::kEngaged;
    in.link = LinkRung::kFresh;
    in.robot_ready = in.aligned = true;
    in.same_engagement = false;
    EXPECT_EQ(next_slave(from, in).state, SessionState::kOff);
    in.same_engagement = true;
    // From off, a master that claims to be engaged already is not followed.
    EXPECT_EQ(next_slave(SessionState::kOff, in).state, SessionState::kOff);
  }
}

TEST(SlaveSession, AGapOfMoreThan200MillisecondsLatches) {
  SlaveSessionInput in;
  in.desired = Desired::kEngaged;
  in.master = SessionState::kEngaged;
  in.robot_ready = true;
  in.link = LinkRung::kHold;
  EXPECT_EQ(next_slave(SessionState::kEngaged, in).state, SessionState::kHold);
  for (const LinkRung link : {LinkRung::kLost, LinkRung::kClosed, LinkRung::kNone}) {
    in.link = link;
    EXPECT_EQ(next_slave(SessionState::kHold, in).state, SessionState::kFault);
    EXPECT_EQ(next_slave(SessionState::kHold, in).reason, Reason::kLinkLost);
  }
  in.link = LinkRung::kFresh;
  EXPECT_EQ(next_slave(SessionState::kFault, in).state, SessionState::kFault);
  in.fault_released = true;
  EXPECT_EQ(next_slave(SessionState::kFault, in).state, SessionState::kOff);
}

TEST(MasterSession, HomingAndAligningEndWhenTheyTakeTooLong) {
  MasterSessionInput in;
  in.desired = Desired::kEngaged;
  in.link = LinkRung::kFresh;
  in.ready = false;
  EXPECT_EQ(next_master(SessionState::kOff, in).state, SessionState::kHoming);
  in.overdue = true;
  EXPECT_EQ(next_master(SessionState::kHoming, in).state, SessionState::kOff);
  EXPECT_EQ(next_master(SessionState::kHoming, in).reason, Reason::kHoming);
  in.ready = true;
  in.peer = SessionState::kHoming;
  EXPECT_EQ(next_master(SessionState::kAligning, in).state, SessionState::kOff);
  EXPECT_EQ(next_master(SessionState::kAligning, in).reason, Reason::kHoming);
}

TEST(SlaveSession, HomesOnlyWhileTheRobotIsNotReadyAndSomebodyConfirmedAsks) {
  for_every_slave_input([](const SlaveSessionInput& in) {
    const bool homing = next_slave(SessionState::kOff, in).state == SessionState::kHoming;
    if (!homing) return;
    EXPECT_FALSE(in.robot_ready);
    EXPECT_TRUE(in.confirmed && in.desired != Desired::kOff);
    EXPECT_EQ(in.master, SessionState::kAligning);
  });
  SlaveSessionInput in;
  in.desired = Desired::kEngaged;
  in.master = SessionState::kAligning;
  in.link = LinkRung::kFresh;
  EXPECT_EQ(next_slave(SessionState::kOff, in).state, SessionState::kHoming);
  EXPECT_EQ(next_slave(SessionState::kHoming, in).state, SessionState::kHoming);
  in.robot_ready = true;
  EXPECT_EQ(next_slave(SessionState::kHoming, in).state, SessionState::kAligning);
}

TEST(SlaveSession, NeitherAlignsNorEngagesWithAnObstacleAndNamesIt) {
  SlaveSessionInput in;
  in.desired = Desired::kEngaged;
  in.master = SessionState::kAligning;
  in.link = LinkRung::kFresh;
  in.robot_ready = in.aligned = true;
  for (const SessionState from :
       {SessionState::kOff, SessionState::kHoming, SessionState::kAligning}) {
    in.obstacle = Reason::kSensorMissing;
    EXPECT_EQ(next_slave(from, in).state, SessionState::kOff);
    EXPECT_EQ(next_slave(from, in).reason, Reason::kSensorMissing);
    in.obstacle = Reason::kNone;
    EXPECT_NE(next_slave(from, in).state, SessionState::kOff);
  }
}

TEST(SlaveSession, AFaultIsNotReleasedWhileTheRobotIsNotReady) {
  SlaveSessionInput in;
  in.fault_released = true;
  EXPECT_EQ(next_slave(SessionState::kFault, in).state, SessionState::kFault);
}

}  // namespace
}  // namespace handrail
