// How the tip moves: on its path, inside every limit, to a stop where it should be.
#include <gtest/gtest.h>

#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/follow/follow_rig.h"

namespace handrail {
namespace {

using test::Dice;
using test::FollowRig;
using test::joints_deg;

constexpr double kOnPath = 1e-8;     // [m]
constexpr double kNoFurther = 1e-6;  // [m]

// A pose from which the arm has some room, its wrist well bent.
JointVector roomy_joints(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  JointVector q = 0.6 * test::home() + 0.4 * test::random_joints(random);
  q[4] = std::clamp(q[4], 30 * kDeg, 110 * kDeg);
  return q;
}

double off_line(const Vec3& p, const Vec3& start, const Vec3& direction) {
  const Vec3 d = p - start;
  return (d - d.dot(direction) * direction).norm();
}

TEST(FollowMotion, StaysOnALineWhileSpeedAccelerationAndRangeLimitIt) {
  int held = 0, accelerating = 0;
  for (std::uint64_t run = 0; run < 150; ++run) {
    Dice dice(run);
    FollowRig rig(run % 3 == 0 ? test::home() : roomy_joints(run));
    rig.engage();
    const Pose A = rig.state.motion.X_ST;
    const Vec3 direction = dice.unit();
    rig.in.master.position_tool = test::line_along(A.p, direction);
    rig.in.master.position_tool.epoch = 1;
    double wanted = 0.0;
    for (int i = 0; i < 400; ++i) {
      // Jumps and stops to anywhere up to 0.3 m along the line, in reach or not.
      if (i % 25 == 0) wanted = dice.between(-0.3, 0.3);
      rig.follow({A.p + wanted * direction, A.q});
      ASSERT_LT(off_line(rig.tip.p, A.p, direction), kOnPath) << "run " << run << " cycle " << i;
      held +=
          rig.out.link.reason == Reason::kJointRange || rig.out.link.reason == Reason::kOutOfReach;
      accelerating += rig.out.link.reason == Reason::kJointAcceleration;
    }
    ASSERT_TRUE(rig.watch.kept());
    ASSERT_EQ(rig.guarded, 0);
  }
  EXPECT_GT(held, 100);
  EXPECT_GT(accelerating, 100);
}

TEST(FollowMotion, StaysOnAPlaneWhileLimited) {
  for (std::uint64_t run = 0; run < 100; ++run) {
    Dice dice(1000 + run);
    FollowRig rig(run % 2 == 0 ? test::home() : roomy_joints(run));
    rig.engage();
    const Pose A = rig.state.motion.X_ST;
    const Vec3 n = dice.unit(), u = n.unitOrthogonal(), v = n.cross(u);
    const Vec3 axis = A.q * Vec3::UnitZ();
    rig.in.master.position_tool = test::plane_across(A.p, n);
    rig.in.master.position_tool.epoch = 1;
    Pose X = A;
    for (int i = 0; i < 400; ++i) {
      if (i % 20 == 0) {
        X.p = A.p + dice.between(-0.2, 0.2) * u + dice.between(-0.2, 0.2) * v;
        X.q = rotation_exp(dice.between(-1.0, 1.0) * axis) * A.q;
      }
      rig.follow(X);
      ASSERT_LT(std::abs((rig.tip.p - A.p).dot(n)), kOnPath) << "run " << run << " cycle " << i;
    }
    ASSERT_TRUE(rig.watch.kept());
    ASSERT_EQ(rig.guarded, 0);
  }
}

// Master and slave see the target stop at full speed; the arm has to be able to. Two in a hundred
// runs brake beside a bound of the joints, where the turn that lags bends the stop by less than a
// millimetre.
TEST(FollowMotion, ACommandThatOnlyGoesForwardNeverMakesTheTipGoBackOrPassIt) {
  int bent = 0;
  for (std::uint64_t run = 0; run < 200; ++run) {
    Dice dice(2000 + run);
    FollowRig rig(run % 2 == 0 ? test::home() : roomy_joints(run));
    rig.engage();
    const Pose A = rig.state.motion.X_ST;
    const Vec3 direction = dice.unit();
    rig.in.master.position_tool = test::line_along(A.p, direction);
    rig.in.master.position_tool.epoch = 1;
    const double speed = dice.between(0.05, 2.0);
    double wanted = 0.0, furthest = 0.0, off = 0.0;
    for (int i = 0; i < 300; ++i) {
      if (i % 60 < 30) wanted = std::min(0.25, wanted + speed * rig.settings.motion->dt);
      rig.follow({A.p + wanted * direction, A.q});
      const double travel = (rig.tip.p - A.p).dot(direction);
      ASSERT_GT(travel, furthest - 5e-4) << "run " << run << " cycle " << i;
      ASSERT_LT(travel, wanted + 1e-4) << "run " << run << " cycle " << i;
      off = std::max({off, furthest - travel, travel - wanted});
      furthest = std::max(furthest, travel);
    }
    bent += off > kNoFurther;
  }
  EXPECT_LE(bent, 10);
}

// What a one-way tool promises holds for the arm too when its command is cut or comes late.
TEST(FollowMotion, AOneWayToolsTipNeverGoesBackThroughHoldsAndStops) {
  for (std::uint64_t run = 0; run < 60; ++run) {
    Dice dice(3000 + run);
    FollowRig rig(run % 2 == 0 ? test::home() : roomy_joints(run));
    rig.engage();
    const Pose A = rig.state.motion.X_ST;
    rig.in.master.position_tool = test::line_along(A.p, dice.unit(), true);
    rig.in.master.position_tool.epoch = 1;
    const Vec3 direction = rig.in.master.position_tool.direction_S;
    double wanted = 0.0, furthest = 0.0;
    for (int i = 0; i < 300; ++i) {
      wanted += dice.between(0.0, 8e-3);
      rig.in.master.X_SU = {A.p + wanted * direction, A.q};
      rig.in.master_age = i / 20 % 3 == 2 ? from_seconds(dice.between(0.0, 0.15)) : 0;
      rig.cycle();
      const double travel = (rig.tip.p - A.p).dot(direction);
      ASSERT_GT(travel, furthest - kNoFurther);
      ASSERT_LT(off_line(rig.tip.p, A.p, direction), kOnPath);
      furthest = std::max(furthest, travel);
    }
    ASSERT_TRUE(rig.watch.kept());
  }
}

// The tip turns a corner late; on a one-way tool it waits there for its command.
TEST(FollowMotion, AOneWayToolsTipNeverGoesBackWhereItsCommandTurnsACornerAtFullSpeed) {
  for (std::uint64_t run = 0; run < 20; ++run) {
    Dice dice(4000 + run);
    FollowRig rig(run % 2 == 0 ? test::home() : roomy_joints(run));
    rig.engage();
    const Pose A = rig.state.motion.X_ST;
    ToolDefinition plane = test::plane_across(A.p, dice.unit());
    plane.direction_S = plane.normal_S.unitOrthogonal();
    plane.one_way = true;
    plane.epoch = 1;
    rig.in.master.position_tool = plane;
    const Vec3 across = plane.normal_S.cross(plane.direction_S);
    double furthest = 0.0;
    for (int i = 0; i < 150; ++i) {
      const double ahead = 3e-3 * std::min(i, 40), aside = 3e-3 * std::clamp(i - 40, 0, 40);
      rig.follow({A.p + ahead * plane.direction_S + aside * across, A.q});
      const double travel = (rig.tip.p - A.p).dot(plane.direction_S);
      ASSERT_GT(travel, furthest - kNoFurther) << "run " << run << " cycle " << i;
      furthest = std::max(furthest, travel);
    }
  }
}

TEST(FollowMotion, ATipAheadOfTheCommandWhenAOneWayToolIsCalledWaitsForIt) {
  FollowRig rig;
  rig.engage();
  const Pose A = rig.state.motion.X_ST;
  Pose X = A;
  for (int i = 0; i < 40; ++i) {
    X.p.y() += 3e-3;
    rig.follow(X);
  }
  // The command has turned back before the call, the tip has not yet.
  X.p.y() = rig.tip.p.y() - 0.02;
  rig.in.master.position_tool = test::line_along(X.p, Vec3::UnitY(), true);
  rig.in.master.position_tool.epoch = 1;
  double furthest = rig.tip.p.y();
  for (int i = 0; i < 200; ++i) {
    rig.follow(X);
    ASSERT_GT(rig.tip.p.y(), furthest - kNoFurther);
    furthest = std::max(furthest, rig.tip.p.y());
  }
  // It joins when the command has come past.
  X.p.y() = furthest + 0.02;
  for (int i = 0; i < 100; ++i) rig.follow(X);
  EXPECT_LT((rig.tip.p - X.p).norm(), kOnPath);
}

TEST(FollowMotion, OutOfReachItHoldsAtTheBoundaryWithAReasonAndComesBackWithoutALurch) {
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
    FollowRig rig;
    rig.engage();
    const Pose A = rig.state.motion.X_ST;
    rig.in.master.position_tool = test::line_along(A.p, direction);
    rig.in.master.position_tool.epoch = 1;
    Pose X = A;
    for (int i = 0; i < 600; ++i) {
      X.p += 0.3 * rig.settings.motion->dt * direction;
      rig.follow(X);
      ASSERT_LT(off_line(rig.tip.p, A.p, direction), kOnPath);
    }
    const double reached = (rig.tip.p - A.p).dot(direction);
    EXPECT_LT(reached, 1.0);
    EXPECT_TRUE(standing(rig.state.motion));
    EXPECT_TRUE(rig.out.link.reason == Reason::kOutOfReach ||
                rig.out.link.reason == Reason::kJointRange)
        << describe(rig.out.link.reason);
    // The target comes back over the boundary; the tip sets out after it and catches up gently.
    double last = reached;
    while ((X.p - A.p).dot(direction) > 0.0) {
      X.p -= 0.3 * rig.settings.motion->dt * direction;
      rig.follow(X);
      const double travel = (rig.tip.p - A.p).dot(direction);
      ASSERT_LT(travel, last + 1e-8);
      ASSERT_GT(travel, last - 2.0 * 0.3 * rig.settings.motion->dt);
      last = travel;
    }
    for (int i = 0; i < 100; ++i) rig.follow(X);
    EXPECT_LT((rig.tip.p - X.p).norm(), kOnPath);
    EXPECT_TRUE(rig.watch.kept());
  }
}

TEST(FollowMotion, CrossesAStraightWristWithoutTurningJ4) {
  FollowRig rig(joints_deg(0, 0, 90, 0, 30, 0));
  rig.engage();
  Pose X;
  for (int i = 0; i <= 200; ++i) {
    const double j5 = 30.0 - 0.3 * i;
    X = forward(rig.settings.motion->arm, joints_deg(0, 0, 90, 0, j5, 0));
    rig.follow(X);
    ASSERT_LT(std::abs(rig.joints()[3]), 1e-6);
    ASSERT_LT(std::abs(rig.joints()[5]), 1e-6);
  }
  for (int i = 0; i < 100; ++i) rig.follow(X);
  EXPECT_NEAR(rig.joints()[4], -30 * kDeg, 1e-6);
  EXPECT_TRUE(rig.watch.kept());
}

TEST(FollowMotion, CrossesAStraightWristAtFullSpeedWithoutTurningJ4) {
  FollowRig rig(joints_deg(0, 0, 90, 0, 60, 0));
  rig.engage();
  const Pose X = forward(rig.settings.motion->arm, joints_deg(0, 0, 90, 0, -60, 0));
  for (int i = 0; i < 400; ++i) {
    rig.follow(X);
    ASSERT_LT(std::abs(rig.joints()[3]), 1e-6);
  }
  EXPECT_NEAR(rig.joints()[4], -60 * kDeg, 1e-6);
  EXPECT_TRUE(rig.watch.kept());
}

// Beside the singularity J4 has to turn by half a turn, or the wrist the other way.
TEST(FollowMotion, BesideAStraightWristTheTipKeepsItsPlaceAndTheTurnCatchesUp) {
  FollowRig rig(joints_deg(0, 0, 90, 0, 30, 0));
  rig.engage();
  const auto beside = [&rig](double j5) {
    Pose X = forward(rig.settings.motion->arm, joints_deg(0, 0, 90, 0, j5, 0));
    X.q = rotation_exp(Vec3(0, 0, 0.01)) * X.q;
    return X;
  };
  const auto there = [&rig](const Pose& X) {
    return (rig.tip.p - X.p).norm() < 1e-6 && angle_between(rig.tip.q, X.q) < 1e-6;
  };
  double furthest = 0.0;
  const auto follow = [&](const Pose& X) {
    rig.follow(X);
    furthest = std::max(furthest, (rig.tip.p - X.p).norm());
  };
  for (int i = 300; i >= -300; --i) follow(beside(0.1 * i));
  for (int i = 0; i < 300; ++i) rig.cycle();
  EXPECT_TRUE(there(beside(-30.0)));
  for (int i = -300; i <= 300; ++i) follow(beside(0.1 * i));
  for (int i = 0; i < 300; ++i) rig.cycle();
  EXPECT_TRUE(there(beside(30.0)));
  EXPECT_LT(furthest, 0.1);
  EXPECT_TRUE(rig.watch.kept());
  EXPECT_EQ(rig.guarded, 0);
}

// As the controller gets it: joints as 32-bit floats.
Vec3 tip_as_sent(const FollowRig& rig) {
  return forward(rig.settings.motion->arm, rig.joints().cast<float>().cast<double>()).p;
}

TEST(FollowMotion, TurningJ6FromMinus180To180AboutAPointMovesTheTipByLessThan50Micrometres) {
  FollowRig rig;
  rig.engage();
  const Pose A = rig.state.motion.X_ST;
  const Vec3 axis = A.q * Vec3::UnitZ();
  double worst = 0.0, least = 0.0, most = 0.0;
  const auto turn_to = [&](double from, double to) {
    const double step = to > from ? 1.0 : -1.0;
    for (double angle = from; step * (to - angle) > -0.5; angle += step) {
      rig.follow({A.p, rotation_exp(angle * kDeg * axis) * A.q});
      worst = std::max(worst, (tip_as_sent(rig) - A.p).norm());
    }
    for (int i = 0; i < 100; ++i) {
      rig.cycle();
      worst = std::max(worst, (tip_as_sent(rig) - A.p).norm());
    }
    least = std::min(least, rig.joints()[5]);
    most = std::max(most, rig.joints()[5]);
  };
  turn_to(0, 180);
  turn_to(180, -180);
  EXPECT_LT(worst, 5e-6);
  EXPECT_NEAR(most, 180 * kDeg, 1e-6);
  EXPECT_NEAR(least, -180 * kDeg, 1e-6);
}

TEST(FollowMotion, TiltingBy45DegreesAboutAPointMovesTheTipByLessThan50Micrometres) {
  for (int axis = 0; axis < 2; ++axis) {
    FollowRig rig;
    rig.engage();
    const Pose A = rig.state.motion.X_ST;
    double worst = 0.0;
    for (int i = 0; i <= 1200; ++i) {
      const double angle = 45 * kDeg * std::sin(i * 0.01);
      rig.follow({A.p, A.q * rotation_exp(angle * Vec3::Unit(axis))});
      worst = std::max(worst, (tip_as_sent(rig) - A.p).norm());
    }
    EXPECT_LT(worst, 6e-6);
    EXPECT_TRUE(rig.watch.kept());
  }
}

// Limiting against the measured position, which lags, would halve the speed.
TEST(FollowMotion, ALaggingArmIsCommandedAsFastAsOneThatFollowsAtOnce) {
  const auto travel = [](bool lags) {
    FollowRig rig;
    rig.engage();
    Pose X = rig.state.motion.X_ST;
    JointVector arm = rig.joints();
    for (int i = 0; i < 40; ++i) {
      X.p.y() += 0.003;
      if (lags) {
        arm += (rig.joints() - arm) * 0.15;
        rig.in.q_measured = arm;
      }
      rig.follow(X);
    }
    return rig.tip.p.y();
  };
  EXPECT_EQ(travel(true), travel(false));
}

TEST(FollowMotion, ALostCommandCostsNoOffset) {
  FollowRig all, some;
  all.engage();
  some.engage();
  Dice dice(5);
  Pose X = all.state.motion.X_ST;
  Pose kept = X;
  for (int i = 0; i < 500; ++i) {
    X.p.y() = 0.1 * std::sin(0.03 * i);
    all.follow(X);
    if (dice.between(0, 1) > 0.3) kept = X;  // three in ten never arrive
    some.follow(kept);
  }
  for (int i = 0; i < 100; ++i) all.follow(X), some.follow(X);
  EXPECT_LT((all.tip.p - some.tip.p).norm(), 1e-10);
}

}  // namespace
}  // namespace handrail
