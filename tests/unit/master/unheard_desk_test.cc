// What operators are answered when the slave does not do what was asked, or none hears them.
#include "tests/unit/master/desk_bench.h"

namespace handrail {
namespace {

class UnheardDeskTest : public DeskBench {};

TEST_F(UnheardDeskTest, WithASlaveThatAnotherMasterLeadsEveryAnswerNamesIt) {
  tick();
  connected = false;
  link.refusal = {1, true, fixed_text<LeaderName>("process 4711"), 5 * kSecond};
  const auto later = [&] {
    tick(250 * kMillisecond);
    link.refused_at = now;
  };
  later();
  const std::string who =
      "the slave is led by another master (process 4711, for 5 s): end that master: "
      "then the slave takes this one, without a restart, ";
  Answer answer = ask("engage: true");
  loop(Reason::kOtherMaster);
  tick();
  EXPECT_EQ(text(answer), "refused: " + who + "then engage");
  later();
  answer = ask("stop: true");
  loop();
  stand(SessionState::kFault, Desired::kOff, Reason::kStopRequested);
  tick();
  EXPECT_EQ(text(answer),
            "refused: the stop stands here and stops nobody: " + who + "then reset and engage");
  later();
  answer = ask("engage: true");
  loop(Reason::kOtherMaster);
  tick();
  EXPECT_EQ(text(answer), "refused: " + who + "then reset and engage");
  later();
  answer = ask("reset: true");
  loop();
  stand(SessionState::kOff);
  tick();
  EXPECT_EQ(text(answer), "done: " + who + "then engage");
}

TEST_F(UnheardDeskTest, AnEngageWaitsForASessionThatIsOnItsWayAndNoLongerThanItIs) {
  connected = false;
  link.peer_epoch = 0;
  LinkIdentity peer;
  peer.encrypted = true;
  desk->set_link([&peer](Nanos) { return peer; });
  tick();
  const Answer waits = ask("engage: true");
  loop(Reason::kNoPeer);
  tick();
  EXPECT_FALSE(waits->has_value());
  peer.problem = "nobody answers: start it";
  tick(20 * kMillisecond);
  loop(Reason::kNoPeer);
  tick();
  EXPECT_EQ(text(waits),
            std::string("refused: ") + describe(Reason::kNoPeer) + ": " + peer.problem);
  peer.encrypted = false;
  peer.problem.clear();
  const Answer plain = ask("engage: true");
  loop(Reason::kNoPeer);
  tick();
  EXPECT_EQ(text(plain),
            std::string("refused: ") + describe(Reason::kNoPeer) +
                ": no slave has answered at /run/link.sock: start handrail-slave there");
}

TEST_F(UnheardDeskTest, WithoutAnArmInTheSceneNobodyIsWaitedFor) {
  report.walls.present = true;
  tick();
  Answer answer = ask("stop: true");
  loop();
  report.out.link.stop_epoch = 7;
  tick();
  EXPECT_EQ(text(answer), std::string("done: ") + describe(Reason::kNoArmInScene));
  slave.state = SessionState::kFault;
  answer = ask("reset: true");
  loop();
  tick();
  EXPECT_EQ(text(answer), "done: the walls are felt again");
}

// The stop circuit is open: what was reset is latched anew.
TEST_F(UnheardDeskTest, AResetThatMeetsTheSameCauseAgainIsRefusedAtOnceWithIt) {
  slave.state = SessionState::kFault;
  slave.fault = Reason::kLinkLost;
  slave.fault_epoch = 41;
  tick();
  const Answer answer = ask("reset: true");
  loop();
  report.out.link.fault_reset = 41;
  for (int i = 0; i < 5; ++i) tick();
  ASSERT_FALSE(answer->has_value());
  slave.fault = Reason::kStopInput;
  slave.fault_epoch = 42;
  tick();
  EXPECT_EQ(text(answer),
            std::string("refused: the slave stays in fault: ") + describe(Reason::kStopInput));
}

// The stop makes a new fault of the slave's. A reset that overtook it would be for the old one.
TEST_F(UnheardDeskTest, AResetWaitsUntilTheSlaveHasTheStopBeforeIt) {
  slave.state = SessionState::kFault;
  tick();
  const Answer stop = ask("stop: true");
  const Answer reset = ask("reset: true");
  report.out.link.stop_epoch = 7;
  report.out.link.released_epoch = 6;
  for (int i = 0; i < 10; ++i) {
    loop();
    EXPECT_EQ(last_order(), OrderKind::kStop);
    tick();
  }
  slave.stop_epoch = 7;
  tick();
  loop();
  EXPECT_EQ(last_order(), OrderKind::kReset);
  slave.state = SessionState::kOff;
  tick();
  EXPECT_EQ(text(reset), "done: engage to go on");
}

TEST_F(UnheardDeskTest, AStopThatIsNeverAnsweredHoldsNoResetUp) {
  report.out.link.stop_epoch = 7;
  report.out.link.released_epoch = 6;
  tick();
  const Answer first = ask("reset: true");
  const Answer second = ask("reset: true");
  EXPECT_EQ(text(first), "refused: another reset came after this one");
  tick(OrderDesk::kStopPatience);
  loop();
  EXPECT_TRUE(taken.empty());
  tick(1);
  loop();
  EXPECT_EQ(last_order(), OrderKind::kReset);
}

TEST_F(UnheardDeskTest, AnEngageWhoseSlaveGetsReadyIsToldWhatItWaitsFor) {
  tick();
  const Answer answer = ask("engage: true");
  loop();
  stand(SessionState::kAligning, Desired::kEngaged, Reason::kHoming);
  slave.reason = Reason::kRobotNotConnected;
  tick();
  tick(OrderDesk::kEngagePatience);
  tick(1);
  EXPECT_EQ(text(answer), std::string("refused: ") + describe(Reason::kRobotNotConnected));
}

}  // namespace
}  // namespace handrail
