#include "server/haptic/wall_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/no_allocation.h"
#include "tests/unit/haptic/wall_rig.h"

namespace handrail {
namespace {

using test::WallRig;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(WallStep, FreeSpaceIsFree) {
  WallRig rig;
  for (int i = 0; i < 100; ++i) EXPECT_EQ(rig.move({-0.01 - 1e-4 * i, 0.02}).norm(), 0.0);
}

TEST(WallStep, AWallPushesTheHandOutInM) {
  WallRig rig;
  rig.move({-0.01, 0.02});
  for (int i = 0; i <= 30; ++i) rig.move({-0.01 + 4e-4 * i, 0.02});
  const Vec2 f = rig.move({2e-3, 0.02});
  EXPECT_NEAR(f.x(), -5000.0 * 2e-3, 1e-9);
  EXPECT_NEAR(f.y(), 0.0, 1e-12);
  EXPECT_TRUE(rig.out.contact.touching);
  EXPECT_EQ(rig.out.f_H_M.force.z(), 0.0);
  EXPECT_EQ(rig.out.f_H_M.torque, Vec3::Zero());
}

TEST(WallStep, AStagesPoseTurnsWallsAndForceTogether) {
  WallRig rig;
  rig.walls->stages[1].pose = {Vec2(0.01, -0.02), 0.7};
  rig.in.stage = 1;
  const auto from_map = [&](const Vec2& p) { return rig.walls->stages[1].pose.to_world(p); };
  rig.move(from_map({-0.01, 0.0}));
  for (int i = 0; i <= 60; ++i) rig.move(from_map({-0.01 + 2e-4 * i, 0.0}));
  const Vec2 f = rig.move(from_map({2e-3, 0.0}));
  EXPECT_TRUE(f.isApprox(Pose2::turned({-10.0, 0.0}, 0.7), 1e-9)) << f.transpose();
  EXPECT_TRUE(rig.out.hand.isApprox(Vec2(2e-3, 0.0), 1e-9));
}

TEST(WallStep, WallsThatComeOrGoOrTurnChangeTheForceInBoundedSteps) {
  WallRig rig;
  rig.walls->stages[1].gone = {1};
  rig.walls->stages[2].pose = {Vec2(-0.001, 0.0), 0.3};
  rig.move({-0.01, 0.0});
  for (int i = 0; i <= 140; ++i) rig.move({-0.01 + 1e-4 * i, 0.0});
  Vec2 last = rig.move({4e-3, 0.0});
  ASSERT_NEAR(last.norm(), 20.0, 0.1);
  bool limited = false;
  for (int i = 0; i < 1200; ++i) {
    rig.in.stage = i / 200 % 3;
    const Vec2 f = rig.move({4e-3, 0.0});
    ASSERT_LE((f - last).norm(), rig.settings.force.step + 1e-9) << i;
    limited = limited || rig.out.reasons.has(Reason::kForceRate);
    last = f;
    if (i == 399) {
      EXPECT_EQ(f.norm(), 0.0) << "the wall is gone";
    }
  }
  EXPECT_TRUE(limited);
  EXPECT_GT(last.norm(), 15.0);
}

TEST(WallStep, AStageThatIsNotThereIsTheNearest) {
  WallRig rig;
  rig.in.stage = 99;
  rig.move({-0.01, 0.0});
  EXPECT_EQ(rig.out.stage, 2);
  rig.in.stage = -5;
  rig.move({-0.01, 0.0});
  EXPECT_EQ(rig.out.stage, 0);
}

TEST(WallStep, AReadingThatIsNoPlaceCutsTheForceAndMovesNothing) {
  for (const Vec3& bad : {Vec3(kNan, 0, 0), Vec3(0, 1e300, 0), Vec3(0.0, -11.0, 0.0)}) {
    WallRig rig;
    rig.move({-0.01, 0.0});
    for (int i = 0; i <= 120; ++i) rig.move({-0.01 + 1e-4 * i, 0.0});
    ASSERT_GT(rig.out.f_H_M.force.norm(), 9.0);
    const Vec2 proxy = rig.out.contact.proxy;
    rig.in.hand.X_MH.p = bad;
    rig.step();
    EXPECT_EQ(rig.out.f_H_M.force, Vec3::Zero());
    EXPECT_TRUE(rig.out.reasons.has(Reason::kDeviceInvalid));
    EXPECT_EQ(rig.out.contact.proxy, proxy);
    // Back within 20 ms the same proxy takes up again, within the step limit.
    EXPECT_LE(rig.move({2e-3, 0.0}).norm(), rig.settings.force.step + 1e-9);
    EXPECT_EQ(rig.proxy->starts, 1);
    for (int i = 0; i < 30; ++i) {
      rig.in.hand.valid = false;
      rig.step();
    }
    rig.in.hand.valid = true;
    rig.move({-0.02, 0.0});
    EXPECT_EQ(rig.proxy->starts, 2);
  }
}

// A device that was lost meanwhile may have been homed anew, elsewhere.
TEST(WallStep, AHandThatNobodySawForAsLongAsALossTakesOverAnew) {
  WallRig rig;
  rig.move({-0.01, 0.0});
  for (int i = 0; i <= 120; ++i) rig.move({-0.01 + 1e-4 * i, 0.0});
  ASSERT_TRUE(rig.out.contact.touching);
  rig.in.unseen = from_seconds(kShortestLoss) - kMillisecond;
  rig.move({2e-3, 0.0});
  EXPECT_EQ(rig.proxy->starts, 1);
  rig.in.unseen = from_seconds(kShortestLoss) + kMillisecond;
  rig.move({2e-3, 0.0});
  EXPECT_EQ(rig.proxy->starts, 2);
  // With readings that are invalid the time in between counts, too.
  rig.in.unseen = kMillisecond;
  rig.in.hand.valid = false;
  rig.step();
  rig.in.hand.valid = true;
  rig.in.unseen = from_seconds(kLongestHandGap) + kMillisecond;
  rig.move({-0.01, 0.0});
  EXPECT_EQ(rig.proxy->starts, 3);
}

TEST(WallStep, ASpeedThatIsNotFiniteCutsTheForceToo) {
  WallRig rig;
  rig.move({-0.01, 0.0});
  rig.in.hand.v_MH.x() = kNan;
  rig.step();
  EXPECT_EQ(rig.out.f_H_M.force, Vec3::Zero());
  EXPECT_TRUE(rig.out.reasons.has(Reason::kDeviceInvalid));
}

TEST(WallStep, ReleasedTheForceLeavesWithinTheFadeAndSaysSo) {
  WallRig rig;
  rig.move({-0.01, 0.0});
  for (int i = 0; i <= 140; ++i) rig.move({-0.01 + 1e-4 * i, 0.0});
  ASSERT_GT(rig.out.f_H_M.force.norm(), 19.0);
  rig.in.release = true;
  for (int i = 0; i < 51; ++i) rig.move({4e-3, 0.0});
  EXPECT_EQ(rig.out.f_H_M.force.norm(), 0.0);
  EXPECT_TRUE(rig.out.reasons.has(Reason::kForceFaded));
}

TEST(WallStep, TheDevicesPeakIsNeverPassed) {
  WallRig rig;
  rig.move({-0.01, 0.0});
  for (int i = 0; i <= 300; ++i) rig.move({-0.01 + 2e-4 * i, 0.0});
  EXPECT_NEAR(rig.out.f_H_M.force.norm(), rig.settings.force.peak, 1e-9);
  EXPECT_TRUE(rig.out.reasons.has(Reason::kForceClamped));
}

TEST(WallStep, AHandAtFiveMetresASecondIsStoppedWithoutDelay) {
  WallRig rig;
  double expected = 0.0;
  rig.move({-0.01, 0.0});
  for (int i = 0; i <= 3; ++i) {
    const double x = -0.01 + 5e-3 * i;
    expected = std::min(5000.0 * std::max(x, 0.0), rig.settings.force.peak);
    EXPECT_NEAR(rig.move({x, 0.0}).norm(), expected, 1e-9) << i;
  }
  EXPECT_GT(expected, 20.0);
}

TEST(WallStep, ASceneWithoutEffectsMakesNoForceAnywhere) {
  WallRig rig(std::vector<EffectSpec>{});
  EXPECT_EQ(rig.state.effects.size(), 0);
  for (int i = 0; i <= 100; ++i) EXPECT_EQ(rig.move({-0.005 + 1e-4 * i, 0.0}).norm(), 0.0);
}

TEST(WallStep, EffectsTellTheirEvents) {
  EffectSpec detent;
  detent.kind = EffectKind::kDetent;
  detent.places = {Vec2(-0.02, 0.0)};
  detent.radius = 4e-3;
  detent.peak = 4.0;
  WallRig rig(std::vector<EffectSpec>{detent});
  rig.move({-0.03, 0.0});
  EXPECT_EQ(rig.out.effects.event_count, 0);
  rig.move({-0.021, 0.0});
  ASSERT_EQ(rig.out.effects.event_count, 1);
  EXPECT_EQ(rig.out.effects.events[0].kind, EffectEvent::Kind::kLocked);
  EXPECT_TRUE(rig.out.effects.locked);
}

TEST(WallStep, DoesNotAllocate) {
  WallRig rig(test::every_effect());
  rig.walls->stages[1].pose = {Vec2(0.01, 0.0), 0.3};
  rig.move({-0.01, 0.0});
  test::NoAllocation guard("wall_step");
  for (int i = 0; i < 3000; ++i) {
    rig.in.stage = i / 500 % 3;
    rig.in.hand.valid = i % 700 != 0;
    rig.move({0.02 * std::sin(0.01 * i), 0.02 * std::cos(0.013 * i)});
  }
}

}  // namespace
}  // namespace handrail
