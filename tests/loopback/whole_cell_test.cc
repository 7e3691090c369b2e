// The real programs together, in an ordinary session.
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class WholeCellTest : public WholeCell {};

TEST_F(WholeCellTest, EngagingMovesNothing) {
  const Vec3 before = mm(status().slave_command());
  order("engage: true");
  const pb::Status after = status();
  EXPECT_EQ(after.slave_state(), "engaged");
  EXPECT_LT((mm(after.slave_command()) - before).norm(), 1e-6);
  EXPECT_LT((mm(at_rest().slave_command()) - before).norm(), 1e-6);
}

TEST_F(WholeCellTest, TheTipStaysOnTheLineWhereverTheHandGoes) {
  order("engage: true");
  order("tool { kind: LINE direction: [0, -1, 0] one_way: true }");
  const Vec3 start = mm(status().command());
  const pb::Status there = move_hand("15, 5, -5");
  const Vec3 way = mm(there.slave_command()) - start;
  EXPECT_NEAR(way.y(), -30.0, 4.0);  // twice the hand's way to the right
  EXPECT_LT(std::hypot(way.x(), way.z()), 0.01);
  const Vec3 tip = mm(there.tip()) - start;
  EXPECT_LT(std::hypot(tip.x(), tip.z()), 0.5);
  EXPECT_GT(there.tool_force().magnitude_n(), 0.1);
  EXPECT_EQ(there.position_tool().kind(), "line");
  const Vec3 back = mm(move_hand("-10, 0, 0").slave_command()) - start;
  EXPECT_NEAR(back.y(), way.y(), 0.1) << "one-way";
}

TEST_F(WholeCellTest, TheClutchHoldsTheArmWhileTheHandMoves) {
  order("engage: true");
  order("clutch: true");
  ASSERT_TRUE(slave_reaches("clutched"));
  const pb::Status before = at_rest();
  const pb::Status after = move_hand("10, 0, 0");
  EXPECT_EQ(after.state(), "clutched");
  EXPECT_GT((mm(after.hand()) - mm(before.hand())).norm(), 8.0);
  EXPECT_LT((mm(after.slave_command()) - mm(before.slave_command())).norm(), 1e-6);
  order("clutch: false");
  ASSERT_TRUE(slave_reaches("engaged"));
  EXPECT_LT((mm(at_rest().slave_command()) - mm(before.slave_command())).norm(), 0.5);
  const Vec3 moved = mm(move_hand("10, 0, 0").slave_command()) - mm(before.slave_command());
  EXPECT_NEAR(moved.y(), -20.0, 4.0);  // friction of the device keeps some
}

TEST_F(WholeCellTest, AToolFarFromTheTipIsRefusedOrApproachedUntilTheClutchIsHeld) {
  order("engage: true");
  const Vec3 start = mm(at_rest().slave_command());
  const std::string at = "0,0," + std::to_string(start.z() - 310.2);
  const auto [refused, why] = handrail({"tool", "plane", "--normal", "z", "--at", at});
  EXPECT_EQ(refused, 1);
  EXPECT_THAT(why, HasSubstr("handrail: refused: the plane is 310.2 mm from the tip, or from where "
                             "the hand sends it, at most 20 mm; --approach goes there"));
  EXPECT_LT((mm(at_rest().slave_command()) - start).norm(), 1e-3);
  const auto [called, answer] =
      handrail({"tool", "plane", "--normal", "z", "--at", at, "--approach"});
  EXPECT_EQ(called, 0);
  EXPECT_THAT(answer, HasSubstr("tool called (310.2 mm to go, about 5.2 s; the clutch ends it)"));
  ASSERT_TRUE(eventually(
      [&](const pb::Status& s) { return mm(s.slave_command()).z() < start.z() - 30.0; }));
  order("clutch: true");
  const Vec3 stopped = mm(at_rest().slave_command());
  EXPECT_GT(stopped.z(), start.z() - 250.0);
  order("clutch: false");
  ASSERT_TRUE(slave_reaches("engaged"));
  const pb::Status after = at_rest();
  EXPECT_LT((mm(after.slave_command()) - stopped).norm(), 0.5);
  EXPECT_EQ(after.position_tool().kind(), "none");
}

TEST_F(WholeCellTest, AStopStaysUntilReset) {
  EXPECT_EQ(handrail({"engage"}).first, 0);
  EXPECT_EQ(handrail({"stop"}).first, 0);
  ASSERT_TRUE(slave_reaches("fault"));
  const auto [code, output] = handrail({"engage"});
  EXPECT_EQ(code, 1);
  EXPECT_THAT(output, HasSubstr("stop was requested: reset, then engage again"));
  EXPECT_EQ(status().state(), "fault");
  EXPECT_EQ(handrail({"reset"}).first, 0);
  EXPECT_EQ(handrail({"reset"}).first, 1) << "nothing left to reset";
  EXPECT_EQ(handrail({"engage"}).first, 0);
  EXPECT_EQ(status().slave_state(), "engaged");
}

TEST_F(WholeCellTest, ASceneIsLoadedInBothProgramsAndOnlyWhenDisengaged) {
  order("engage: true");
  EXPECT_EQ(refusal("scene_load: 'plane'"), "only possible when disengaged");
  order("disengage: true");
  ASSERT_TRUE(slave_reaches("off"));
  EXPECT_THAT(refusal("scene_load: 'nowhere'"), HasSubstr("nowhere"));
  order("scene_load: 'plane'");
  const pb::Status s = status();
  EXPECT_EQ(s.scene(), "plane");
  EXPECT_EQ(s.slave_scene(), "plane");
  EXPECT_EQ(s.hash_mismatch_size(), 0);
  order("engage: true");
  EXPECT_TRUE(eventually([](const pb::Status& now) {
    return now.position_tool().kind() == "plane" && now.orientation_tool().kind() == "n-rotation";
  }));
}

TEST_F(WholeCellTest, ASceneThatTheSlaveDoesNotHaveIsGivenUp) {
  folder.write("mine.scene", "name: 'mine' mapping { scale: 3 }\n");
  EXPECT_THAT(refusal("scene_load: 'mine'"), HasSubstr("'linear-movement' stays"));
  ASSERT_TRUE(eventually([](const pb::Status& s) {
    return s.scene() == "linear-movement" && s.hash_mismatch_size() == 0;
  }));
  order("engage: true");
}

TEST_F(WholeCellTest, OneSceneCanFollowAnotherAtOnce) {
  folder.write("mine.scene", "name: 'mine' mapping { scale: 3 }\n");
  for (int round = 0; round < 2; ++round) {  // a slave looks for a scene once a second
    order("scene_load: 'plane'");
    EXPECT_THAT(refusal("scene_load: 'mine'"), HasSubstr("'plane' stays"));
    order("scene_load: 'linear-movement'");
    order("scene_load: 'linear-movement'");
    EXPECT_EQ(status().slave_scene(), "linear-movement");
  }
}

TEST_F(WholeCellTest, TermDisengagesAndEndsEveryProgramWithZero) {
  order("engage: true");
  master->send(SIGTERM);
  EXPECT_EQ(master->finish(), 0) << master->output();
  EXPECT_FALSE(std::filesystem::exists(socket()));
  EXPECT_TRUE(slave->running());
  slave->send(SIGTERM);
  EXPECT_EQ(slave->finish(), 0) << slave->output();
  rig->send(SIGTERM);
  EXPECT_EQ(rig->finish(), 0) << rig->output();
}

}  // namespace
}  // namespace handrail
