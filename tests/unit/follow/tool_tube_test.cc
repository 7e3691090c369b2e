// The slave keeps the tip on the tools, whatever an authentic master commands.
#include "server/follow/tool_tube.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/follow/follow_rig.h"

namespace handrail {
namespace {

using test::Dice;
using test::FollowRig;

constexpr double kOnTool = 1e-5;   // [m]
constexpr double kContact = 1e-3;  // alpha times twice the threshold [m]

ToolDefinition of_epoch(ToolDefinition tool, std::uint32_t epoch) {
  tool.epoch = epoch;
  return tool;
}

// Distance from the set, by a formula of its own.
double off(const ToolDefinition& tool, const Vec3& p) {
  const Vec3 d = p - tool.p_SA;
  switch (tool.kind) {
    case ToolKind::kPoint: return d.norm();
    case ToolKind::kLine: return d.cross(tool.direction_S).norm();
    case ToolKind::kPlane: return std::abs(d.dot(tool.normal_S));
    default: return 0.0;
  }
}

ToolDefinition some_tool(Dice& dice, int kind, const Vec3& p) {
  if (kind == 0) return test::point_at(p);
  if (kind == 1) return test::line_along(p, dice.unit());
  return test::plane_across(p, dice.unit());
}

TEST(ToolTube, AWrongMasterNeverTakesTheTipOffItsTool) {
  Dice dice(91);
  for (int run = 0; run < 60; ++run) {
    FollowRig rig;
    rig.settings.bumper.form = BumperSettings::Form::kPublished;  // the default one backs off
    rig.engage();
    const Vec3 p = rig.tip.p + (run % 2 == 0 ? Vec3(Vec3::Zero()) : dice.within(0.01));
    const ToolDefinition tool = of_epoch(some_tool(dice, run % 3, p), 1);
    rig.in.master.position_tool = tool;
    double nearest = off(tool, rig.tip.p);  // a tool called elsewhere is only ever come nearer to
    const bool pushed = run % 4 == 3;
    // A command 0.35 m off may take 5.8 s to its tool, and 1.1 s for the last 6 mm.
    for (int i = 0; i < 1000; ++i) {
      Pose X = rig.tip;
      X.p += dice.within(i % 7 == 0 ? 0.2 : 0.01);
      X.q = (dice.turn(0.2) * X.q).normalized();
      if (pushed) rig.in.f_E_T.force = dice.within(200.0);
      rig.follow(X);
      const double now = off(tool, rig.tip.p);
      // On its way there the stop of a tip that flies by may lead outward a little.
      const double room = nearest > kOnTool ? 2e-3 : kOnTool;
      ASSERT_LE(now, nearest + room + (pushed ? kContact : 0.0)) << "run " << run << " cycle " << i;
      nearest = std::min(nearest, std::max(now, off(tool, X.p)));
    }
    EXPECT_TRUE(rig.watch.kept());
    EXPECT_EQ(rig.state.tube.radius(), 0.0);
    rig.in.f_E_T.force.setZero();
    const Pose X = rig.tip;
    for (int i = 0; i < 100; ++i) rig.follow(X);
    EXPECT_LT(off(tool, rig.tip.p), kOnTool) << "run " << run;
  }
}

TEST(ToolTube, AWrongMasterNeverTurnsTheTipOffItsTool) {
  Dice dice(92);
  for (const bool free : {false, true}) {
    FollowRig rig;
    rig.engage();
    ToolDefinition tool;
    tool.kind = free ? ToolKind::kFRotation : ToolKind::kNRotation;
    tool.id = tool.epoch = 1;
    const Quat q = rig.tip.q;
    if (free) {
      tool.normal_S = q * Vec3::UnitZ();
      tool.axis_T = Vec3::UnitZ();
    } else {
      tool.q_ref = q;
    }
    rig.in.master.orientation_tool = tool;
    double turned = 0.0;
    for (int i = 0; i < 300; ++i) {
      Pose X = rig.tip;
      X.q = (dice.turn(1.0) * X.q).normalized();
      rig.follow(X);
      turned = std::max(turned, angle_between(q, rig.tip.q));
      const double tilt =
          free ? std::acos(std::min(1.0, (rig.tip.q * tool.axis_T).dot(tool.normal_S)))
               : angle_between(q, rig.tip.q);
      ASSERT_LT(tilt, 1e-4) << i;
    }
    EXPECT_EQ(turned > 0.05, free);
  }
}

TEST(ToolTube, AToolCalledAwayFromTheTipIsReachedAtTheScenesPace) {
  // From 20 mm off, while 6 mm and more are left, the pace is the scene's.
  for (const double pace : {0.005, 0.06, 0.2}) {
    FollowRig rig;
    rig.settings.catch_up = pace;
    rig.engage();
    const Vec3 start = rig.tip.p;
    rig.in.master.position_tool =
        of_epoch(test::line_along(start + Vec3(0, 0, 0.06), Vec3::UnitY()), 1);
    const Pose X = rig.tip;  // a master that never comes to its own tool
    double fastest = 0.0;
    const auto cycles = static_cast<int>(0.03 / pace / rig.settings.motion->dt);
    for (int i = 0; i < cycles; ++i) {
      const Vec3 before = rig.tip.p;
      rig.follow(X);
      fastest = std::max(fastest, (rig.tip.p - before).norm() / rig.settings.motion->dt);
    }
    // Half the way in its time, but for what the arm is late.
    EXPECT_NEAR(rig.tip.p.z() - start.z(), 0.03, 0.05 * pace + 1e-4) << pace;
    EXPECT_LT(fastest, 1.5 * pace) << pace;
  }
}

TEST(ToolTube, AnOrientationToolAwayFromTheTipIsReachedAtTheScenesPace) {
  for (const double pace : {0.02, 0.262}) {
    FollowRig rig;
    rig.settings.catch_up_rotation = pace;
    rig.engage();
    ToolDefinition tool;
    tool.kind = ToolKind::kNRotation;
    tool.id = tool.epoch = 1;
    tool.q_ref = rotation_exp({0.0, 0.0, 0.2}) * rig.tip.q;
    rig.in.master.orientation_tool = tool;
    const Pose X = rig.tip;
    const auto cycles = static_cast<int>(0.1 / pace / rig.settings.motion->dt);
    for (int i = 0; i < cycles; ++i) rig.follow(X);
    EXPECT_NEAR(angle_between(rig.tip.q, X.q), 0.1, 0.05 * pace + 1e-3) << pace;
  }
}

TEST(ToolTube, AToolCalledAwayFromTheTipIsReached) {
  FollowRig rig;
  rig.engage();
  const Vec3 start = rig.tip.p;
  rig.in.master.position_tool =
      of_epoch(test::line_along(start + Vec3(0, 0, 0.006), Vec3::UnitY()), 1);
  Pose X = rig.tip;  // a master that never comes to its own tool
  double fastest = 0.0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 before = rig.tip.p;
    rig.follow(X);
    fastest = std::max(fastest, (rig.tip.p - before).norm() / rig.settings.motion->dt);
  }
  EXPECT_NEAR(rig.tip.p.z(), start.z() + 0.006, 1e-6);
  EXPECT_LT(fastest, 0.1);
}

// The tip stands where its joints end, the command 30 mm further from a tool that both come to.
TEST(ToolTube, ATipThatStandsOffItsCommandIsNotTakenAheadOfIt) {
  MasterState master;
  const Pose X_ST{{0, 0, 0.05}, Quat::Identity()};
  master.X_SU = {{0, 0, 0.08}, rotation_exp({0.3, 0, 0})};
  ToolTube tube;
  tube.restart(master, X_ST);
  master.position_tool = of_epoch(test::plane_across(Vec3::Zero(), Vec3::UnitZ()), 1);
  master.orientation_tool.kind = ToolKind::kNRotation;
  master.orientation_tool.id = master.orientation_tool.epoch = 1;
  master.orientation_tool.q_ref = rotation_exp({-0.1, 0, 0});
  ASSERT_EQ(tube.take(master, X_ST), Reason::kNone);
  const double catch_up = 0.06, turning = 0.2, dt = 0.0071;
  for (double t = dt; t < 0.4; t += dt) {
    tube.close(catch_up, turning, master.X_SU.p, X_ST.p, dt);
    const Pose X_SU{{0, 0, 0.08 - catch_up * t}, rotation_exp({0.3 - turning * t, 0, 0})};
    const Pose X = tube.project(X_SU, X_ST);
    EXPECT_NEAR(X.p.z(), std::min(0.05, X_SU.p.z()), 1e-9) << t;  // no nearer, and no further off
    EXPECT_NEAR(angle_between(X.q, X_ST.q), 0.0, 1e-6) << t;
  }
}

// The command comes straight to the line's end, from the side and from beyond it.
TEST(ToolTube, ACommandThatIsEasedToAnEndIsNotHurried) {
  MasterState master;
  Pose X{{0, 0.4, 0.3}, Quat::Identity()};
  const Vec3 end(0, 0, 0);
  ToolTube tube;
  tube.restart(master, X);
  master.position_tool =
      of_epoch(test::ending_at(test::line_along(Vec3(0, -0.1, 0), Vec3::UnitY()), 0.1), 1);
  master.X_SU = X;
  ASSERT_EQ(tube.take(master, X), Reason::kNone);
  const double catch_up = 0.06, dt = 0.0071;
  while ((X.p - end).norm() > 0.01) {
    tube.close(catch_up, 0.2, X.p, X.p, dt);
    X.p -= catch_up * dt * (X.p - end).normalized();
    EXPECT_NEAR((tube.project(X, X).p - X.p).norm(), 0.0, 1e-9);
  }
}

// A tip that cannot reach its command slides, and may come nearer to the tool's end by itself.
// Where the command then had to follow it, the tip went after its own command.
TEST(ToolTube, ATipThatSlidesTowardsAnEndDoesNotTakeItsCommandAlong) {
  MasterState master;
  Pose X_ST{{0, 0.29, 0.3}, Quat::Identity()};
  const Pose X_SU{{0, 0.3, 0.31}, Quat::Identity()};
  ToolTube tube;
  tube.restart(master, X_ST);
  master.position_tool =
      of_epoch(test::ending_at(test::line_along(Vec3(0, -0.1, 0.01), Vec3::UnitY()), 0.1), 1);
  master.X_SU = X_SU;
  ASSERT_EQ(tube.take(master, X_ST), Reason::kNone);
  const double catch_up = 0.06, dt = 0.0071;
  for (double t = dt; t < 0.5; t += dt) {
    tube.close(catch_up, 0.2, X_SU.p, X_ST.p, dt);
    X_ST.p.y() -= 0.1 * dt;
    // At the scene's pace, which has some 0.4 m to go, and no faster.
    EXPECT_GE(tube.project(X_SU, X_ST).p.y(), std::min(0.3, 0.424 - catch_up * t) - 1e-9) << t;
  }
}

TEST(ToolTube, NothingPullsTheTipWhileTheClutchIsHeld) {
  FollowRig rig;
  rig.engage();
  const Vec3 start = rig.tip.p;
  rig.in.master.position_tool =
      of_epoch(test::line_along(start + Vec3(0, 0, 0.006), Vec3::UnitY()), 1);
  rig.in.master.desired = Desired::kClutched;
  const Pose X = rig.tip;
  for (int i = 0; i < 100; ++i) rig.follow(X);
  EXPECT_EQ(rig.tip.p, start);
}

TEST(ToolTube, AnEndIsKeptAndAOneWayToolNeverGoesBack) {
  Dice dice(93);
  FollowRig rig;
  rig.engage();
  const Vec3 start = rig.tip.p;
  rig.in.master.position_tool =
      of_epoch(test::ending_at(test::line_along(start, Vec3::UnitY(), true), 0.03), 1);
  double travel = 0.0;
  for (int i = 0; i < 400; ++i) {
    Pose X = rig.tip;
    X.p += dice.within(0.1);
    rig.follow(X);
    const double now = rig.tip.p.y() - start.y();
    ASSERT_GE(now, travel - 1e-9);
    ASSERT_LE(now, 0.03 + kOnTool);
    travel = now;
  }
  EXPECT_GT(travel, 0.029);
}

TEST(ToolTube, AnotherToolOfTheSameEpochAndAnOlderOneAreNotObeyed) {
  FollowRig rig;
  rig.engage();
  const ToolDefinition held = of_epoch(test::line_along(rig.tip.p, Vec3::UnitY()), 2);
  rig.in.master.position_tool = held;
  rig.follow(rig.tip);
  const std::uint64_t hash = rig.out.link.hashes.tools;
  EXPECT_EQ(hash, tools_hash(held, ToolDefinition()));
  for (const std::uint32_t epoch : {2u, 1u}) {
    rig.in.master.position_tool = of_epoch(test::line_along(rig.tip.p, Vec3::UnitX()), epoch);
    Pose X = rig.tip;
    X.p.x() += 0.01;
    const Vec3 before = rig.tip.p;
    for (int i = 0; i < 20; ++i) rig.follow(X);
    EXPECT_EQ(rig.tip.p, before);
    EXPECT_EQ(rig.out.link.reason, Reason::kHashTools);
    EXPECT_EQ(rig.out.link.hashes.tools, hash);
    EXPECT_EQ(rig.out.link.position_tool_epoch, 2u);
  }
  // A restarted master begins its epochs anew.
  ++rig.in.master.engagement_epoch;
  rig.in.master.desired = Desired::kOff;
  rig.in.master.position_tool = ToolDefinition();
  rig.cycle();
  EXPECT_EQ(rig.out.link.hashes.tools, 0u);
}

TEST(ToolTube, ACommandOnTheToolPassesBitForBit) {
  Dice dice(94);
  for (int i = 0; i < 300; ++i) {
    MasterState master;
    Pose X_ST{dice.within(0.5), dice.turn(2.0)};
    master.position_tool = of_epoch(some_tool(dice, i % 3, X_ST.p), 1);
    ToolTube tube;
    tube.restart(master, X_ST);
    Pose X = X_ST;
    X.p = tube.project({X.p + dice.within(0.05), X.q}, X_ST).p;
    const Pose again = tube.project(X, X_ST);
    EXPECT_EQ(again.p, X.p);
    EXPECT_EQ(again.q.coeffs(), X.q.coeffs());
  }
}

}  // namespace
}  // namespace handrail
