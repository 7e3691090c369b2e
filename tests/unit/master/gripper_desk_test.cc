// Orders to the gripper, from request to answer.
#include <gmock/gmock.h>

#include "tests/unit/master/desk_bench.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class GripperDeskTest : public DeskBench {
 protected:
  void SetUp() override {
    slave.has_pose = true;
    slave.gripper = GripperState::kOpen;
    stand(SessionState::kEngaged, Desired::kEngaged);
    tick();
  }
  // The loop takes the order, and says so to the slave.
  Answer ask_taken(const std::string& request) {
    Answer answer = ask(request);
    loop();
    report.out.link.grip = taken.back().order.grip;
    tick();
    return answer;
  }
};

TEST_F(GripperDeskTest, IsAnsweredWhenTheControllerHasIt) {
  const Answer close = ask_taken("grip: true");
  EXPECT_EQ(last_order(), OrderKind::kGrip);
  EXPECT_EQ(taken.back().order.grip, Grip::kClosed);
  EXPECT_FALSE(close->has_value());
  slave.gripper = GripperState::kBetween;
  tick();
  EXPECT_FALSE(close->has_value());
  slave.gripper = GripperState::kClosed;
  tick();
  EXPECT_EQ(text(close), "done: ");
  const Answer open = ask_taken("grip: false");
  EXPECT_EQ(taken.back().order.grip, Grip::kOpen);
  EXPECT_FALSE(open->has_value());
}

TEST_F(GripperDeskTest, SaysWhatTheOutputsAreWhereTheyDoNotChange) {
  const Answer close = ask_taken("grip: true");
  tick(OrderDesk::kGripPatience - 10 * kMillisecond);
  EXPECT_FALSE(close->has_value());
  tick(20 * kMillisecond);
  EXPECT_THAT(text(close), HasSubstr("outputs say 'open' after 1 s"));
}

TEST_F(GripperDeskTest, AnEngagementThatEndsAndAnotherOrderAreSaid) {
  const Answer close = ask_taken("grip: true");
  const Answer open = ask_taken("grip: false");
  EXPECT_THAT(text(close), HasSubstr("another order to the gripper came after this one"));
  EXPECT_EQ(text(open), "done: ") << "it is open already";
  const Answer again = ask_taken("grip: true");
  report.out.link.grip = Grip::kAsItIs;
  stand(SessionState::kOff, Desired::kOff, Reason::kPresence);
  tick();
  EXPECT_THAT(text(again), HasSubstr("not engaged any more"));
}

TEST_F(GripperDeskTest, OneThatIsNotThereIsSaid) {
  slave.gripper = GripperState::kNone;
  tick();
  EXPECT_THAT(refusal("grip: true"), HasSubstr("has no gripper: robot { gripper { } }"));
  slave.has_pose = false;
  tick();
  EXPECT_THAT(refusal("grip: true"), HasSubstr("no slave is heard, or it has no arm"));
  EXPECT_TRUE(taken.empty());
}

TEST_F(GripperDeskTest, OnlyWhoMayDriveOrdersIt) {
  const Answer engage = ask("as: 'anna' engage: true");
  loop();
  tick();
  ASSERT_EQ(text(engage), "done: ");
  EXPECT_THAT(refusal("as: 'bert' grip: false"), HasSubstr("anna"));
}

}  // namespace
}  // namespace handrail
