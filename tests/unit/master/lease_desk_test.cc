// Two operators at one desk: who is obeyed, and what happens when the lease changes hands.
#include "server/master/lease_desk.h"

#include <gmock/gmock.h>

#include "server/base/operator_name.h"
#include "tests/unit/master/desk_bench.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class LeaseDeskTest : public DeskBench {
 protected:
  void anna_engages() {
    tick();
    const Answer answer = ask("as: 'anna' engage: true");
    loop();
    stand(SessionState::kEngaged, Desired::kEngaged);
    tick();
    ASSERT_EQ(text(answer), "done: ");
    taken.clear();
  }
  // The answer to a request that never reaches the loop.
  std::string refusal(const std::string& request) {
    const Answer answer = ask(request);
    OrderTicket ticket;
    EXPECT_FALSE(boxes.orders.pop(ticket)) << request << " reached the loop";
    return text(answer);
  }
};

TEST_F(LeaseDeskTest, EveryOrderOfAnotherIsRefused) {
  anna_engages();
  for (const char* order :
       {"engage: true", "disengage: true", "clutch: true", "reset: true", "tool { kind: POINT }",
        "tool_off {}", "scene_load: 'second'", "hand {}", "stage: 'open'", "screw_c: 5"}) {
    EXPECT_THAT(refusal(std::string("as: 'ben' ") + order),
                HasSubstr("refused: anna has the lease for 0 s"))
        << order;
  }
}

TEST_F(LeaseDeskTest, StopAndStatusAreAnybodys) {
  anna_engages();
  const Answer status = ask("as: 'ben' status: true");
  EXPECT_EQ((*status)->status().lease().holder(), "anna");
  ask("as: 'ben' stop: true");
  loop();
  EXPECT_EQ(last_order(), OrderKind::kStop);
}

TEST_F(LeaseDeskTest, AnEngageThatIsRefusedTakesNoLease) {
  tick();
  const Answer answer = ask("as: 'anna' engage: true");
  EXPECT_EQ((*ask("lease { act: SHOW }"))->lease().holder(), "anna") << "while it is under way";
  tick();
  loop(Reason::kStopRequested);
  tick();
  EXPECT_THAT(text(answer), HasSubstr("refused: "));
  EXPECT_FALSE((*ask("lease { act: SHOW }"))->lease().has_holder());
  taken.clear();
  const Answer other = ask("as: 'ben' engage: true");
  loop();
  ASSERT_EQ(taken.size(), 1u) << "and nobody's engagement ends by it";
  EXPECT_EQ(taken[0].order.kind, OrderKind::kEngage);
}

TEST_F(LeaseDeskTest, WhoHasTheLeaseKeepsItThroughARefusedEngage) {
  tick();
  ask("as: 'anna' lease { act: TAKE }");
  const Answer answer = ask("as: 'anna' engage: true");
  loop(Reason::kStopRequested);
  tick();
  EXPECT_THAT(text(answer), HasSubstr("refused: "));
  EXPECT_EQ((*ask("lease { act: SHOW }"))->lease().holder(), "anna");
}

TEST_F(LeaseDeskTest, WhoDoesNotSayIsTheUserOfTheMaster) {
  tick();
  ask("engage: true");
  EXPECT_EQ((*ask("lease { act: SHOW }"))->lease().holder(), "operator");
}

TEST_F(LeaseDeskTest, WhoAsksIsAnsweredOnceTheHolderGrantsAndTheArmHolds) {
  anna_engages();
  const Answer asked = ask("as: 'ben' lease { act: TAKE }");
  tick();
  EXPECT_FALSE(asked->has_value());
  EXPECT_EQ((*ask("status: true"))->status().lease().asked_by(), "ben");
  EXPECT_EQ(text(ask("as: 'anna' lease { act: GRANT }")), "done: ");
  EXPECT_EQ(text(asked), "done: ");
  EXPECT_EQ((*asked)->lease().holder(), "ben");
  const Answer engage = ask("as: 'ben' engage: true");
  loop();
  ASSERT_EQ(taken.size(), 2u);
  EXPECT_EQ(taken[0].order.kind, OrderKind::kDisengage) << "before the new holder can engage";
  EXPECT_EQ(taken[0].order.why, Reason::kLeaseLost);
  EXPECT_EQ(taken[1].order.kind, OrderKind::kEngage);
}

TEST_F(LeaseDeskTest, WhoAsksIsToldWhyNot) {
  anna_engages();
  Answer asked = ask("as: 'ben' lease { act: TAKE }");
  EXPECT_EQ(text(ask("as: 'anna' lease { act: REFUSE }")), "done: ");
  EXPECT_EQ(text(asked), "refused: ben does not get the lease: anna refuses");
  asked = ask("as: 'ben' lease { act: TAKE }");
  tick(11 * kSecond);
  EXPECT_EQ(text(asked), "refused: ben does not get the lease: anna drives and does not answer");
  loop();
  EXPECT_TRUE(taken.empty()) << "the holder drives on";
}

TEST_F(LeaseDeskTest, NobodyGetsItWhoWaitsNoLonger) {
  anna_engages();
  const Answer asked = ask("as: 'ben' lease { act: TAKE }");
  stand(SessionState::kOff);
  tick();
  EXPECT_FALSE(asked->has_value());
  still_waits = false;
  tick();
  EXPECT_EQ(text(asked), "refused: ben does not get the lease: it waits no longer");
  tick(11 * kSecond);
  EXPECT_EQ((*ask("lease { act: SHOW }"))->lease().holder(), "anna");
}

TEST_F(LeaseDeskTest, AskingAgainAnswersTheFirstQuestion) {
  anna_engages();
  const Answer first = ask("as: 'ben' lease { act: TAKE }");
  const Answer second = ask("as: 'ben' lease { act: TAKE }");
  EXPECT_EQ(text(first), "refused: another take came after this one");
  ask("as: 'anna' lease { act: GRANT }");
  EXPECT_EQ(text(second), "done: ");
}

TEST_F(LeaseDeskTest, ReleasingHoldsTheArm) {
  anna_engages();
  EXPECT_EQ(text(ask("as: 'anna' lease { act: RELEASE }")), "done: ");
  loop();
  EXPECT_EQ(last_order(), OrderKind::kDisengage);
  EXPECT_FALSE((*ask("lease { act: SHOW }"))->lease().has_holder());
}

TEST_F(LeaseDeskTest, AnEngageStillWaitingEndsWithTheLease) {
  tick();
  const Answer engage = ask("as: 'anna' engage: true");
  loop();
  stand(SessionState::kAligning, Desired::kEngaged);
  tick();
  ask("as: 'anna' lease { act: RELEASE }");
  loop();
  EXPECT_EQ(last_order(), OrderKind::kDisengage);
}

// The first is refused for the second, which then engages: anna drives and has the lease.
TEST_F(LeaseDeskTest, AnEngageThatAnotherOneReplacesKeepsTheLease) {
  tick();
  const Answer first = ask("as: 'anna' engage: true");
  loop();
  stand(SessionState::kAligning, Desired::kEngaged);
  const Answer second = ask("as: 'anna' engage: true");
  tick();
  loop();
  tick();
  EXPECT_EQ(text(first), "refused: another engage came after this one");
  stand(SessionState::kEngaged, Desired::kEngaged);
  tick();
  EXPECT_EQ(text(second), "done: ");
  EXPECT_EQ((*ask("lease { act: SHOW }"))->lease().holder(), "anna");
}

TEST(OwnUserName, IsFitForALease) { EXPECT_TRUE(is_operator_name(own_user_name())); }

}  // namespace
}  // namespace handrail
