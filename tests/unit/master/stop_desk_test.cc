// Stops, from order to answer.
#include "tests/unit/master/desk_bench.h"

namespace handrail {
namespace {

class StopDeskTest : public DeskBench {};

// The loop stands still meanwhile, as one that is stopped or starved does.
TEST_F(StopDeskTest, AStopComesBeforeAllThatTheLoopHasNotGot) {
  tick();
  std::vector<Answer> others, stops;
  for (int i = 0; i < 100; ++i) others.push_back(ask("clutch: true"));
  EXPECT_EQ(text(others.back()), "refused: too many orders at once");
  for (int i = 0; i < 100; ++i) stops.push_back(ask("stop: true"));
  for (int i = OrderDesk::kOrdersInLoop; i < 64; ++i) {
    ASSERT_EQ(text(others[static_cast<std::size_t>(i)]), "refused: a stop came before it");
  }
  for (const Answer& stop : stops) ASSERT_FALSE(stop->has_value());
  loop();
  tick();
  loop();
  EXPECT_EQ(last_order(), OrderKind::kStop);
  EXPECT_EQ(taken.size(), OrderDesk::kOrdersInLoop + 1u);
  report.out.link.stop_epoch = slave.stop_epoch = 7;
  tick();
  for (const Answer& stop : stops) EXPECT_EQ(text(stop), "done: the slave has it after 2 ms");
}

// What was ordered in between must not have the last word.
TEST_F(StopDeskTest, AStopAfterOtherOrdersIsOneOfItsOwn) {
  const Answer first = ask("stop: true"), clutch = ask("clutch: true");
  const Answer second = ask("stop: true");
  loop();
  tick();
  loop();
  ASSERT_EQ(taken.size(), 3u);
  EXPECT_EQ(last_order(), OrderKind::kStop);
}

TEST_F(StopDeskTest, AStopThatWaitsIsJoinedAndDropsWhatCameAfterIt) {
  const Answer one = ask("clutch: true"), two = ask("clutch: true");
  const Answer first = ask("stop: true"), engage = ask("engage: true");
  const Answer second = ask("stop: true");
  EXPECT_EQ(text(engage), "refused: a stop came before it");
  tick();
  loop();
  tick();
  loop();
  EXPECT_EQ(taken.size(), 3u);
  EXPECT_EQ(last_order(), OrderKind::kStop);
}

// The lease ends, and with it the engagement, while the loop has more than enough to do.
TEST_F(StopDeskTest, AStopTakesThePlaceOfADisengageThatWaits) {
  tick();
  const Answer engage = ask("as: 'anna' engage: true");
  loop();
  stand(SessionState::kEngaged, Desired::kEngaged);
  tick();
  taken.clear();
  for (int i = 0; i < OrderDesk::kOrdersInLoop; ++i) ask("as: 'anna' clutch: true");
  ask("as: 'anna' lease { act: RELEASE }");
  ask("as: 'ben' stop: true");
  for (int i = 0; i < 4; ++i) {
    loop();
    tick();
  }
  ASSERT_EQ(taken.size(), OrderDesk::kOrdersInLoop + 1u);
  EXPECT_EQ(last_order(), OrderKind::kStop) << "nothing has the last word but the stop";
}

TEST_F(StopDeskTest, AStopIsAnsweredOnceTheSlaveHasIt) {
  tick();
  const Answer answer = ask("stop: true");
  loop();
  report.out.link.stop_epoch = 7;
  for (int i = 0; i < 12; ++i) tick();
  EXPECT_FALSE(answer->has_value());
  slave.stop_epoch = 7;
  tick();
  EXPECT_EQ(text(answer), "done: the slave has it after 13 ms");
}

TEST_F(StopDeskTest, AStopSaysWhenNoSlaveAnswersOrNoneIsThere) {
  tick();
  connected = false;
  Answer answer = ask("stop: true");
  loop();
  report.out.link.stop_epoch = 7;
  tick(kSecond);
  EXPECT_FALSE(answer->has_value());
  tick();
  EXPECT_EQ(
      text(answer),
      "refused: the stop stands here, but the slave has not answered; last heard 1001 ms ago");
  link.peer_epoch = 0;
  answer = ask("stop: true");
  loop();
  tick();
  EXPECT_EQ(text(answer),
            "refused: the stop stands here, but none heard it: no slave has answered at "
            "/run/link.sock: start handrail-slave there");
}

TEST_F(StopDeskTest, AStopToALoopThatStandsStillIsAnsweredAllTheSame) {
  tick();
  report.good_until = now + 20 * kMillisecond;
  const Answer answer = ask("stop: true");
  tick(20 * kMillisecond);
  EXPECT_FALSE(answer->has_value());
  tick();
  EXPECT_EQ(
      text(answer),
      "refused: the haptic loop stands still: nothing is sent and the arm holds; the stop acts "
      "when it goes on");
  loop();
  tick();
  EXPECT_EQ(last_order(), OrderKind::kStop);
}

}  // namespace
}  // namespace handrail
