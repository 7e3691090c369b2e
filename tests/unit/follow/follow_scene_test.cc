// A master that holds another scene is not followed, whatever it says.
#include <gtest/gtest.h>

#include <functional>

#include "tests/unit/follow/follow_rig.h"

namespace handrail {
namespace {

using test::FollowRig;

struct Difference {
  Reason reason;
  std::function<void(MasterState&)> make;
};

const Difference kDifferences[] = {
    {Reason::kSceneDiffers, [](MasterState& m) { m.scene = SceneName(); }},
    {Reason::kSceneDiffers, [](MasterState& m) { m.scene = scene_name("there"); }},
    {Reason::kHashMapping, [](MasterState& m) { m.hashes.mapping ^= 1; }},
    {Reason::kHashLimits, [](MasterState& m) { m.hashes.limits ^= 1; }},
    {Reason::kHashRobot, [](MasterState& m) { m.hashes.robot ^= 1; }},
};

struct SceneRig : FollowRig {
  SceneRig() {
    settings.scene = in.master.scene = scene_name("here");
    settings.hashes = in.master.hashes = {0, 1, 2, 3};
  }
};

TEST(FollowScene, AMasterWithAnotherSceneIsNeverEngagedAndSaysWhy) {
  for (const Difference& difference : kDifferences) {
    SceneRig rig;
    difference.make(rig.in.master);
    const JointVector start = rig.joints();
    rig.engage();
    Pose X = rig.tip;
    for (int i = 0; i < 50; ++i) {
      rig.in.master.state = i % 2 == 0 ? SessionState::kAligning : SessionState::kEngaged;
      X.p.y() += 1e-3;
      rig.follow(i < 25 ? rig.state.motion.X_ST : X);
      ASSERT_EQ(rig.out.link.state, SessionState::kOff) << describe(difference.reason);
      ASSERT_EQ(rig.out.link.reason, difference.reason);
      ASSERT_EQ(rig.joints(), start);
    }
  }
}

TEST(FollowScene, AnEngagementEndsWhenTheMastersSceneChanges) {
  for (const Difference& difference : kDifferences) {
    SceneRig rig;
    rig.engage();
    ASSERT_EQ(rig.out.link.state, SessionState::kEngaged);
    Pose X = rig.tip;
    for (int i = 0; i < 30; ++i) {
      X.p.y() += 0.2 * rig.settings.motion->dt;
      rig.follow(X);
    }
    difference.make(rig.in.master);
    rig.follow(X);
    EXPECT_EQ(rig.out.link.state, SessionState::kOff) << describe(difference.reason);
    EXPECT_EQ(rig.out.link.reason, difference.reason);
    for (int i = 0; i < 100; ++i) rig.cycle();  // comes to rest within every limit
    EXPECT_TRUE(rig.watch.kept());
    const JointVector rest = rig.joints();
    X.p.y() += 0.05;
    for (int i = 0; i < 20; ++i) rig.follow(X);
    EXPECT_EQ(rig.joints(), rest);
    EXPECT_EQ(rig.out.link.reason, difference.reason);
  }
}

TEST(FollowScene, WhoTheMasterIsAndItsToolsAreNoDifference) {
  SceneRig rig;
  rig.in.master.hashes.tools = 77;  // compared as they change
  rig.engage();
  EXPECT_EQ(rig.out.link.state, SessionState::kEngaged);
}

}  // namespace
}  // namespace handrail
