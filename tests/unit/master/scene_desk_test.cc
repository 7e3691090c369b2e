// Loading scenes: the loop takes one over, the slave must follow, else the old one comes back.
#include <gmock/gmock.h>

#include "tests/unit/master/desk_bench.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class SceneDeskTest : public DeskBench {};

TEST_F(SceneDeskTest, AnswersWhenLoopAndSlaveBothHaveTheScene) {
  tick();
  const Answer answer = ask("scene_load: 'second'");
  tick();
  EXPECT_EQ(take_scene(), "second");
  for (int i = 0; i < 100; ++i) {
    tick();
    ASSERT_FALSE(answer->has_value()) << "the slave does not have it yet";
  }
  slave_follows();
  tick();
  EXPECT_EQ(text(answer), "done: ");
}

TEST_F(SceneDeskTest, TheSameSceneAgainIsDoneOnlyWhenTheLoopHasTakenItOver) {
  tick();
  scenes["first"].mapping.scale = 3.0;
  const Answer answer = ask("scene_load: 'first'");
  tick();
  ASSERT_FALSE(answer->has_value());
  EXPECT_EQ(take_scene(), "first");
  tick();
  ASSERT_FALSE(answer->has_value());
  slave_follows();
  tick();
  EXPECT_EQ(text(answer), "done: ");
}

TEST_F(SceneDeskTest, RefusesUnlessTheSessionIsOffOrInFault) {
  EXPECT_EQ(text(ask("scene_load: 'second'")), "refused: only possible when disengaged");
  for (const SessionState state : {SessionState::kAligning, SessionState::kEngaged,
                                   SessionState::kClutched, SessionState::kHold}) {
    stand(state, Desired::kEngaged);
    tick();
    EXPECT_EQ(text(ask("scene_load: 'second'")), "refused: only possible when disengaged");
  }
  EXPECT_EQ(take_scene(), "");
  stand(SessionState::kFault);
  tick();
  EXPECT_EQ(text(ask("scene_load: 'second'")), "(no answer)");
}

TEST_F(SceneDeskTest, PassesOnWhyAFileCannotBeLoaded) {
  tick();
  EXPECT_EQ(text(ask("scene_load: 'third'")), "refused: no scene 'third'");
  EXPECT_EQ(take_scene(), "");
}

TEST_F(SceneDeskTest, RefusesASecondLoadWhileOneRuns) {
  tick();
  ask("scene_load: 'second'");
  EXPECT_EQ(text(ask("scene_load: 'first'")), "refused: another scene is being loaded");
}

TEST_F(SceneDeskTest, WaitsForTheDiskAndServesAllElseMeanwhile) {
  tick();
  disk_waits = true;
  const Answer answer = ask("scene_load: 'second'");
  for (int i = 0; i < 1000; ++i) tick();
  EXPECT_EQ(text(answer), "(no answer)");
  EXPECT_EQ(text(ask("scene_load: 'first'")), "refused: scene 'second' is still being read");
  const Answer stopped = ask("stop: true");
  loop();
  EXPECT_EQ(last_order(), OrderKind::kStop);
  disk_waits = false;
  tick();
  EXPECT_EQ(take_scene(), "second");
  slave_follows();
  tick();
  EXPECT_EQ(text(answer), "done: ");
}

// Who ordered it has gone on by then.
TEST_F(SceneDeskTest, ASceneThatComesAfterItsOrderWasRefusedIsNotTaken) {
  tick();
  disk_waits = true;
  const Answer answer = ask("scene_load: 'second'");
  tick(OrderDesk::kReadPatience + kMillisecond);
  EXPECT_EQ(text(answer),
            "refused: scene 'second' is not loaded: the disk has not given it for 2 s");
  EXPECT_EQ(text(ask("scene_load: 'first'")), "refused: scene 'second' is still being read");
  disk_waits = false;
  tick();
  EXPECT_EQ(take_scene(), "");
  EXPECT_EQ(text(ask("scene_load: 'second'")), "(no answer)") << "it can be asked for again";
  EXPECT_EQ(take_scene(), "second");
}

TEST_F(SceneDeskTest, ASceneThatComesWhenSomebodyElseDrivesIsRefused) {
  tick();
  disk_waits = true;
  const Answer answer = ask("as: 'anna' scene_load: 'second'");
  ask("as: 'ben' lease { act: TAKE }");
  disk_waits = false;
  tick();
  EXPECT_EQ(text(answer), "refused: somebody else drives by now: scene 'second' is not loaded");
  EXPECT_EQ(take_scene(), "");
}

TEST_F(SceneDeskTest, ASceneThatComesWhileAnEngageIsUnderWayIsRefused) {
  tick();
  disk_waits = true;
  const Answer answer = ask("scene_load: 'second'");
  const Answer engage = ask("engage: true");
  disk_waits = false;
  tick();
  EXPECT_EQ(text(answer), "refused: only possible when disengaged");
  EXPECT_EQ(take_scene(), "");
  EXPECT_EQ(text(ask("scene_load: 'second'")), "refused: only possible when disengaged");
}

TEST_F(SceneDeskTest, ASceneThatComesWhenTheSessionIsOnIsRefused) {
  tick();
  disk_waits = true;
  const Answer answer = ask("scene_load: 'second'");
  stand(SessionState::kEngaged, Desired::kEngaged);
  tick();
  disk_waits = false;
  tick();
  EXPECT_EQ(text(answer), "refused: only possible when disengaged");
  EXPECT_EQ(take_scene(), "");
  stand(SessionState::kOff);
  tick();
  EXPECT_EQ(text(ask("scene_load: 'second'")), "(no answer)") << "it can be asked for again";
}

TEST_F(SceneDeskTest, TakesTheOldSceneBackWhenTheSlaveCannotLoadIt) {
  tick();
  const Answer answer = ask("scene_load: 'second'");
  EXPECT_EQ(take_scene(), "second");
  tick();
  slave.reason = Reason::kSceneNotLoaded;
  link.echoed_sent = now;
  tick();
  EXPECT_THAT(text(answer), StartsWith("refused: the slave did not load 'second': "));
  EXPECT_THAT(text(answer), HasSubstr(describe(Reason::kSceneNotLoaded)));
  EXPECT_THAT(text(answer), HasSubstr("'first' stays"));
  EXPECT_EQ(take_scene(), "first");
}

TEST_F(SceneDeskTest, WhatTheSlaveCouldNotLoadBeforeSaysNothingOfThisScene) {
  slave.reason = Reason::kSceneNotLoaded;
  tick();
  link.echoed_sent = now;
  const Answer answer = ask("scene_load: 'second'");
  EXPECT_EQ(take_scene(), "second");
  tick();
  tick();
  ASSERT_FALSE(answer->has_value()) << "the slave has not seen the scene yet";
  slave.reason = Reason::kNotEngaged;
  slave_follows();
  tick();
  EXPECT_EQ(text(answer), "done: ");
}

TEST_F(SceneDeskTest, TakesTheOldSceneBackWhenTheSlaveIsSilentAboutIt) {
  tick();
  const Answer answer = ask("scene_load: 'second'");
  EXPECT_EQ(take_scene(), "second");
  tick();
  tick(OrderDesk::kScenePatience - kMillisecond);
  ASSERT_FALSE(answer->has_value());
  tick(1);
  EXPECT_THAT(text(answer), HasSubstr("scene: master 'second', slave 'first'"));
  EXPECT_EQ(take_scene(), "first");
  tick();
  EXPECT_EQ(text(ask("scene_load: 'second'")), "(no answer)");
}

TEST_F(SceneDeskTest, WithoutASlaveTheSceneIsLoadedAndSaysSo) {
  connected = false;
  tick();
  const Answer answer = ask("scene_load: 'second'");
  EXPECT_EQ(take_scene(), "second");
  tick();
  EXPECT_EQ(text(answer), "done: no slave is connected: it loads the scene when it is");
}

TEST_F(SceneDeskTest, CallsTheScenesOwnToolsAtEachEngagement) {
  ToolCall plane;
  plane.kind = ToolKind::kPlane;
  plane.normal_S = Vec3::UnitZ();
  ToolCall upright;
  upright.kind = ToolKind::kNRotation;
  scenes["second"].tools = {plane, upright};
  tick();
  ask("scene_load: 'second'");
  EXPECT_EQ(take_scene(), "second");
  slave_follows();
  tick();
  for (int round = 0; round < 2; ++round) {
    taken.clear();
    stand(SessionState::kAligning, Desired::kEngaged);
    tick();
    loop();
    EXPECT_TRUE(taken.empty()) << "nothing to hold on to before the hand takes over";
    stand(SessionState::kEngaged, Desired::kEngaged);
    tick();
    loop();
    ASSERT_EQ(taken.size(), 2u);
    EXPECT_EQ(taken[0].order.tool.kind, ToolKind::kPlane);
    EXPECT_EQ(taken[1].order.tool.kind, ToolKind::kNRotation);
    for (const SessionState state :
         {SessionState::kClutched, SessionState::kHold, SessionState::kEngaged}) {
      stand(state, Desired::kEngaged);
      tick();
    }
    loop();
    EXPECT_EQ(taken.size(), 2u) << "tools must survive clutch and hold";
    stand(SessionState::kOff);
    tick();
  }
}

TEST_F(SceneDeskTest, WhoEngagesLearnsWhichOfTheScenesToolsIsTooFar) {
  ToolCall plane;
  plane.kind = ToolKind::kPlane;
  plane.normal_S = Vec3::UnitZ();
  plane.at_present = false;
  scenes["second"].tools = {plane};
  scenes["second"].guidance.tool_reach = 0.035;
  tick();
  ask("scene_load: 'second'");
  take_scene();
  slave_follows();
  tick();
  for (int round = 0; round < 2; ++round) {
    const Answer answer = ask("engage: true");
    loop();
    stand(SessionState::kEngaged, Desired::kEngaged);
    tick();
    EXPECT_FALSE(answer->has_value()) << "the scene's tools are being called";
    if (round == 0) loop(Reason::kToolFar, 0.4);
    if (round == 1) loop();
    EXPECT_FALSE(taken.back().order.tool.approach) << "a scene moves no arm";
    tick();
    EXPECT_EQ(text(answer),
              round == 0
                  ? "done: the scene's tool was refused: the plane is 400.0 mm from the tip, "
                    "or from where the hand sends it, at most 35 mm; --approach goes there"
                  : "done: ");
    stand(SessionState::kOff);
    tick();
  }
}

TEST_F(SceneDeskTest, AnEngagementWithTheClutchHeldGetsItsToolsOnce) {
  ToolCall point;
  point.kind = ToolKind::kPoint;
  scenes["second"].tools = {point};
  tick();
  ask("scene_load: 'second'");
  take_scene();
  slave_follows();
  tick();
  stand(SessionState::kAligning, Desired::kClutched);
  tick();
  stand(SessionState::kClutched, Desired::kClutched);
  tick();
  stand(SessionState::kEngaged, Desired::kEngaged);
  tick();
  loop();
  ASSERT_EQ(taken.size(), 1u);
  EXPECT_EQ(taken[0].order.tool.kind, ToolKind::kPoint);
}

}  // namespace
}  // namespace handrail
