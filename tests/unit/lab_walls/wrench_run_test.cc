#include "server/lab/walls/wrench_run.h"

#include <gtest/gtest.h>

#include <numbers>

#include "server/scene/scene_library.h"

namespace handrail {
namespace {

constexpr double kPi = std::numbers::pi;

class WrenchRun : public ::testing::Test {
 protected:
  WrenchRun() : scene(*SceneLibrary().load("wrench")), path(*WrenchPath::of(scene)) {}

  WrenchResult turn(double c, int turns, int loosen, int person = 0, std::uint64_t seed = 1,
                    bool traced = false) {
    for (EffectSpec& effect : scene.effects) {
      if (effect.kind == EffectKind::kProgressive) effect.c = c;
    }
    WrenchOptions options;
    options.turns = turns;
    options.loosen = loosen;
    options.traced = traced;
    return turn_wrench(scene, path, joystick_person(seed, person), options);
  }

  Scene scene;
  WrenchPath path;
};

TEST_F(WrenchRun, ForcePeaksRiseStrictlyWhileTightening) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    for (int person = 0; person < 4; ++person) {
      const WrenchResult r = turn(5.0, 4, 0, person, seed);
      ASSERT_EQ(r.turns.size(), 4u);
      for (std::size_t i = 1; i < 4; ++i) EXPECT_GT(r.turns[i].peak, r.turns[i - 1].peak);
    }
  }
}

TEST_F(WrenchRun, ForcePeaksRiseAndFallWithinTheRealWrench) {
  for (int person = 0; person < 8; ++person) {
    const WrenchResult r = turn(15.0, 4, 4, person);
    ASSERT_EQ(r.turns.size(), 8u);
    for (std::size_t i = 1; i < 4; ++i) EXPECT_GT(r.turns[i].peak, r.turns[i - 1].peak);
    for (std::size_t i = 5; i < 8; ++i) EXPECT_LT(r.turns[i].peak, r.turns[i - 1].peak);
    EXPECT_LE(r.most_force, kRealWrench);
  }
}

TEST_F(WrenchRun, ThePeakIsTheDampersAtTheBallsSpeed) {
  // B_w v with the hand at the ball's speed, the aisle's other forces aside: within a fifth.
  const WrenchResult r = turn(15.0, 3, 0);
  for (const WrenchTurn& t : r.turns) {
    EXPECT_NEAR(t.peak, 15.0 * t.alpha * path.speed(), 0.25 * t.peak);
  }
}

TEST_F(WrenchRun, EachTurnIsHalfARevolutionForthAndBack) {
  const WrenchResult r = turn(5.0, 4, 4);
  const double wanted[] = {1, 2, 3, 4, 3, 2, 1, 0};
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(r.turns[i].alpha, wanted[i] * kPi, 0.15 * kPi) << i;
  }
}

TEST_F(WrenchRun, AnyDamperStaysBoundedAndSteady) {
  for (const double c : {500.0, 1e6}) {
    const WrenchResult r = turn(c, 4, 4, 0, 1, true);
    // What the device gives, and what the hand's own mass adds when it starts and stops.
    EXPECT_LT(r.most_force, 1.1 * kJoystickPeakForce) << c;
    // A wrench that shook would go back and forth over the counts of the screw.
    double back = 0.0;
    for (std::size_t i = 1; i < r.trace.size() && r.trace[i].t < 4.0 * kLoopTime; ++i) {
      back += std::max(0.0, r.trace[i - 1].turned - r.trace[i].turned);
    }
    EXPECT_LT(back, 0.3) << c;
    for (const WallTick& tick : r.trace) ASSERT_LT(tick.velocity.norm(), 0.8) << c;
  }
}

TEST_F(WrenchRun, WallsGiveNoSpikeWhereAislesMeet) {
  for (const double c : {5.0, 15.0}) {
    double most = 0.0;
    for (int person = 0; person < 8; ++person) {
      const WrenchResult r = turn(c, 4, 4, person);
      most = std::max(most, r.junction_ratio);
      EXPECT_LE(r.junction_ratio, 1.3) << c << ", person " << person;
      EXPECT_LE(r.share_of_bound, 1.0) << c << ", person " << person;
    }
    EXPECT_GT(most, 0.5) << "nobody touched a wall at a junction";
  }
}

TEST_F(WrenchRun, IsTheSameAgainAndForEachPersonAlone) {
  const WrenchResult a = turn(15.0, 1, 1, 3, 7, true), b = turn(15.0, 1, 1, 3, 7, true);
  ASSERT_EQ(a.trace.size(), b.trace.size());
  for (std::size_t i = 0; i < a.trace.size(); ++i) {
    ASSERT_EQ(a.trace[i].hand, b.trace[i].hand);
    ASSERT_EQ(a.trace[i].handle, b.trace[i].handle);
  }
  EXPECT_NE(turn(15.0, 1, 1, 4, 7).turns[0].peak, a.turns[0].peak);
  EXPECT_NE(turn(15.0, 1, 1, 3, 8).turns[0].peak, a.turns[0].peak);
}

TEST_F(WrenchRun, ARecordedHandTurnsOnceForEveryTimeAround) {
  std::vector<RecordedSample> samples;
  for (double t = 0.0; t <= 2.2 * kLoopTime; t += 0.02) {
    const Vec2 p = path.at(path.speed() * t - 0.02);
    samples.push_back({t, Vec3(p.x(), p.y(), 0.0)});
  }
  WrenchOptions options;
  const WrenchResult r =
      turn_wrench(scene, path, joystick_person(1, 0), RecordedMotion(samples), options);
  ASSERT_EQ(r.turns.size(), 2u);
  EXPECT_NEAR(r.turns[0].alpha, kPi, 0.15 * kPi);
  EXPECT_NEAR(r.turns[1].alpha, 2.0 * kPi, 0.15 * kPi);
  EXPECT_GT(r.turns[1].peak, r.turns[0].peak);
}

TEST_F(WrenchRun, WallsThatLieElsewhereAreTurnedAlike) {
  const WrenchResult straight = turn(15.0, 2, 0);
  auto walls = std::make_shared<Walls>(*scene.walls);
  walls->stages.front().pose.angle = 2.0;
  scene.walls = walls;
  const WrenchResult turned = turn(15.0, 2, 0);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(turned.turns[i].peak, straight.turns[i].peak, 0.05 * straight.turns[i].peak);
    EXPECT_NEAR(turned.turns[i].alpha, straight.turns[i].alpha, 0.03);
  }
  EXPECT_GT(straight.share_of_bound, 0.3);
  EXPECT_NEAR(turned.share_of_bound, straight.share_of_bound, 0.15);
}

TEST_F(WrenchRun, EndsWhenCancelled) {
  const std::atomic<bool> cancelled = true;
  WrenchOptions options;
  options.cancelled = &cancelled;
  EXPECT_EQ(turn_wrench(scene, path, joystick_person(1, 0), options).duration, 0.0);
}

TEST(WrenchMeasures, GrowthIsTheSlopeAndDistanceIsFromTheLargestPeak) {
  WrenchResult r;
  r.turns = {{1.0, 0.0}, {3.0, 0.0}, {5.0, 0.0}, {7.0, 0.0}, {20.0, 0.0}};
  EXPECT_DOUBLE_EQ(growth_of(r, 4), 2.0);
  EXPECT_DOUBLE_EQ(distance_from_real(r, 4), 9.0);
  EXPECT_DOUBLE_EQ(distance_from_real(r, 5), 4.0);
  EXPECT_EQ(growth_of(r, 1), 0.0);
}

TEST_F(WrenchRun, TheBallMakesALoopInSixSecondsThroughBothAisles) {
  EXPECT_NEAR(path.length(), (kPi + 2.0) * 0.060, 1e-12);
  GuidingBall ball(path, 2, 1);
  const double start = ball.duration() - 3.0 * kLoopTime;
  EXPECT_EQ(ball.loop(0.5 * start), -1);
  const struct {
    double t;
    Vec2 p;
  } cases[] = {
      {0.0, {0.0, 0.0}},
      {start, path.begin()},
      {start + kLoopTime * path.turn_length() / path.length(), path.end()},
      {start + kLoopTime, path.begin()},
      // Loosening: straight across first.
      {start + 3.0 * kLoopTime - kLoopTime * path.turn_length() / path.length(), path.end()}};
  for (const auto& c : cases) {
    GuidingBall fresh(path, 2, 1);
    // A hand that keeps up.
    for (double t = 0.0; t < c.t; t += 0.01) fresh.move(t, fresh.p());
    fresh.move(c.t, fresh.p());
    EXPECT_LT((fresh.p() - c.p).norm(), 1e-9) << c.t;
  }
  EXPECT_LT((path.begin() - Vec2(-0.060, 0.0)).norm(), 1e-12) << "clockwise over the top";
}

TEST_F(WrenchRun, TheBallWaitsForWhoFallsBehind) {
  GuidingBall ball(path, 1, 0);
  const Vec2 hand(0.0, 0.0);
  for (double t = 0.0; t < 4.0; t += 0.01) ball.move(t, hand);
  EXPECT_NEAR((ball.p() - hand).norm(), kBallAhead, 1e-9);
  EXPECT_EQ(ball.v().norm(), 0.0);
}

TEST_F(WrenchRun, ScenesWithoutWhatTheWrenchNeedsAreRefused) {
  Scene lacking = scene;
  lacking.effects.clear();
  EXPECT_NE(WrenchPath::of(lacking).message().find("no progressive effect"), std::string::npos);
  lacking = scene;
  auto walls = std::make_shared<Walls>(*scene.walls);
  walls->shapes.resize(1);
  lacking.walls = walls;
  EXPECT_NE(WrenchPath::of(lacking).message().find("draws no arc"), std::string::npos);
}

}  // namespace
}  // namespace handrail
