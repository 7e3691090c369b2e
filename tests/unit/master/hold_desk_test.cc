// An engagement that lasts while its command runs.
#include <gmock/gmock.h>

#include "tests/unit/master/desk_bench.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class HoldDeskTest : public DeskBench {
 protected:
  void engage() {
    tick();
    const Answer answer = ask("engage: true hold: true");
    loop();
    stand(SessionState::kEngaged, Desired::kEngaged);
    tick();
    ASSERT_EQ(text(answer), "done: ");
    taken.clear();
  }
};

TEST_F(HoldDeskTest, ItGoesOnWhileTheCommandIsHeardAndEndsTwoHundredMillisecondsLater) {
  engage();
  for (int i = 0; i < 20; ++i) {
    tick(50 * kMillisecond);
    EXPECT_EQ(text(ask("hold_alive: true")), "done: ");
  }
  EXPECT_EQ(boxes.hold_heard.load(), now - 50 * kMillisecond);
  tick(200 * kMillisecond);
  loop();
  EXPECT_TRUE(taken.empty());
  tick();
  loop();
  EXPECT_EQ(last_order(), OrderKind::kDisengage);
  EXPECT_EQ(taken.back().order.why, Reason::kPresence);
}

TEST_F(HoldDeskTest, TheCommandIsToldWhenTheSessionIsOver) {
  engage();
  stand(SessionState::kFault, Desired::kOff, Reason::kLinkLost);
  tick();
  EXPECT_THAT(text(ask("hold_alive: true")), HasSubstr("refused: not engaged any more: link lost"));
  tick(kSecond);
  loop();
  EXPECT_TRUE(taken.empty()) << "there is nothing to end";
}

TEST_F(HoldDeskTest, APlainEngageDoesNotDropTheDeadMan) {
  engage();
  const Answer plain = ask("engage: true");
  loop();
  tick();
  EXPECT_EQ(text(plain),
            "refused: your 'handrail engage --hold' is running: end that one first, or the arm "
            "would go on without it");
  EXPECT_TRUE(taken.empty());
  EXPECT_EQ(text(ask("hold_alive: true")), "done: ");
  tick(200 * kMillisecond);
  tick();
  loop();
  EXPECT_EQ(last_order(), OrderKind::kDisengage) << "it still ends with its command";
}

TEST_F(HoldDeskTest, APlainEngageDoesNotDropTheDeadManThatWaitsForTheLink) {
  tick();
  const Answer held = ask("engage: true hold: true");
  loop(Reason::kLinkQuality);
  tick();
  EXPECT_THAT(text(ask("engage: true")), HasSubstr("refused: your 'handrail engage --hold'"));
  EXPECT_FALSE(held->has_value());
}

TEST_F(HoldDeskTest, OnceTheHeldEngagementIsOverAPlainEngageIsTaken) {
  engage();
  stand(SessionState::kOff, Desired::kOff, Reason::kNotEngaged);
  tick();
  const Answer plain = ask("engage: true");
  loop();
  EXPECT_EQ(last_order(), OrderKind::kEngage);
  stand(SessionState::kEngaged, Desired::kEngaged);
  tick();
  EXPECT_EQ(text(plain), "done: ");
  tick(kSecond);
  loop();
  EXPECT_EQ(last_order(), OrderKind::kEngage) << "nobody holds this one";
}

TEST_F(HoldDeskTest, WhoeverTakesTheLeaseEngagesAsTheyLike) {
  engage();
  ask("lease { act: RELEASE }");
  EXPECT_EQ(text(ask("as: 'ben' engage: true")), "(no answer)");
  loop();
  EXPECT_EQ(last_order(), OrderKind::kEngage);
}

// Nobody says anything for it after that, and nobody need to.
TEST_F(HoldDeskTest, ARefusedHoldLeavesAnEngagementThatGoesOnByItselfAsItIs) {
  tick();
  const Answer plain = ask("engage: true");
  loop();
  stand(SessionState::kEngaged, Desired::kEngaged);
  tick();
  ASSERT_EQ(text(plain), "done: ");
  const Answer held = ask("engage: true hold: true");
  loop(Reason::kDeviceInvalid);
  tick();
  EXPECT_EQ(text(held), std::string("refused: ") + describe(Reason::kDeviceInvalid));
  for (int i = 0; i < 10; ++i) {
    tick(100 * kMillisecond);
    loop();
  }
  EXPECT_EQ(last_order(), OrderKind::kEngage) << "nothing ended it";
  EXPECT_THAT(text(ask("hold_alive: true")), HasSubstr("refused: "));
}

TEST_F(HoldDeskTest, ARefusedHoldIsNoSignOfTheOneThatRuns) {
  engage();
  ask("engage: true hold: true");
  loop(Reason::kDeviceInvalid);
  tick();
  EXPECT_EQ(text(ask("hold_alive: true")), "done: ");
  tick(200 * kMillisecond);
  tick();
  loop();
  EXPECT_EQ(last_order(), OrderKind::kDisengage) << "it still ends with its command";
}

TEST_F(HoldDeskTest, SomebodyIsThereWhileTheEngageWaits) {
  tick();
  ask("engage: true hold: true");
  EXPECT_EQ(boxes.hold_heard.load(), now) << "before the loop can have the order";
  loop(Reason::kLinkQuality);
  for (int i = 0; i < 10; ++i) tick(100 * kMillisecond);
  EXPECT_EQ(boxes.hold_heard.load(), now);
}

// A Ctrl-C: the arm is not engaged later on, with nobody there.
TEST_F(HoldDeskTest, AnEngageThatNobodyWaitsForAnyMoreEngagesNothing) {
  tick();
  ask("engage: true");
  loop(Reason::kLinkQuality);
  tick();
  still_waits = false;
  const std::size_t before = taken.size();
  for (int i = 0; i < 20; ++i) {
    tick(10 * kMillisecond);
    loop();
  }
  EXPECT_EQ(taken.size(), before);
  EXPECT_FALSE((*ask("lease { act: SHOW }"))->lease().has_holder());
  still_waits = true;
  ask("engage: true");
  loop();
  stand(SessionState::kAligning, Desired::kEngaged);
  tick();
  still_waits = false;
  tick();
  loop();
  EXPECT_EQ(last_order(), OrderKind::kDisengage);
}

TEST_F(HoldDeskTest, AnotherOperatorCannotHold) {
  engage();
  EXPECT_THAT(text(ask("as: 'ben' hold_alive: true")),
              HasSubstr("refused: operator has the lease"));
}

TEST_F(HoldDeskTest, WhereTheConfigurationWantsItNothingElseEngages) {
  OrderDeskOptions options;
  options.presence = Presence::kHold;
  desk = std::make_unique<OrderDesk>(boxes, scenes["first"], options);
  tick();
  EXPECT_EQ(text(ask("engage: true")),
            "refused: this master wants somebody there: 'handrail engage --hold'");
  engage();
  tick(kSecond);
  loop();
  EXPECT_TRUE(taken.empty()) << "the step sees to it";
  EXPECT_LT(boxes.hold_heard.load(), now - kHoldPatience);
}

}  // namespace
}  // namespace handrail
