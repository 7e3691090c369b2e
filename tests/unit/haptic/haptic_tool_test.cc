// What the tools make of the command that goes to the robot.
#include <gtest/gtest.h>

#include <numbers>

#include "server/base/units.h"
#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::at;
using test::call_of;
using test::Dice;
using test::HapticRig;
using test::line_call;
using test::plane_call;
using test::Wander;

constexpr double kOnTool = 1e-5;  // 0.01 mm, the figure to reach [m]

double off_position_tool(const HapticRig& rig) {
  return rig.state->command.guide.position().distance(rig.command().p);
}

// Angle between the tip's axis and the one it is to keep.
double off_axis(const HapticRig& rig) {
  const ToolDefinition& tool = rig.out.link.orientation_tool;
  const Vec3 r = rig.command().q * tool.axis_T;
  return std::atan2(r.cross(tool.normal_S).norm(), r.dot(tool.normal_S));
}

TEST(HapticTools, ACommandOnAToolCalledWhereItIsStaysOnItForRandomHands) {
  for (int run = 0; run < 30; ++run) {
    Dice dice(static_cast<std::uint64_t>(800 + run));
    HapticRig rig;
    rig.engage();
    Wander wander;
    for (int i = 0; i < 300; ++i) {
      wander.move(dice, 0.3, 1.0, HapticRig::kTick, rig.in.hand.X_MH);
      rig.tick();
    }
    const Vec3 anchor = rig.command().p;
    const ToolCall calls[] = {call_of(ToolKind::kPoint), line_call(dice.unit()),
                              line_call(dice.unit(), true), plane_call(dice.unit())};
    ASSERT_EQ(rig.call(calls[run % 4]), Reason::kNone);
    for (int i = 0; i < 3000; ++i) {
      // On the tool from the very first tick, also while the hand is fast or jumps.
      ASSERT_LT(off_position_tool(rig), kOnTool) << "run " << run << " tick " << i;
      if (i % 500 == 499) rig.in.hand.X_MH.p += dice.within(0.1);
      wander.move(dice, 0.5, 1.0, HapticRig::kTick, rig.in.hand.X_MH);
      rig.tick();
    }
    EXPECT_TRUE(run % 4 != 0 || (rig.command().p - anchor).norm() < kOnTool);
    EXPECT_TRUE(run % 2 == 0 || (rig.command().p - anchor).norm() > 1e-3);
  }
}

TEST(HapticTools, AOneWayLineNeverTakesTheCommandBack) {
  for (int run = 0; run < 30; ++run) {
    Dice dice(static_cast<std::uint64_t>(900 + run));
    HapticRig rig;
    rig.settings.guide.reach = 1.0;
    rig.settings.guide.method = run % 2 == 0 ? GuidanceMethod::kExact : GuidanceMethod::kPublished;
    rig.engage();
    Wander wander;
    const Vec3 forward = dice.unit();
    for (int i = 0; i < 200; ++i) {
      wander.move(dice, 0.3, 1.0, HapticRig::kTick, rig.in.hand.X_MH);
      rig.tick();
    }
    double furthest = rig.command().p.dot(forward);
    // Called somewhere near, not through the tip, in mid-motion.
    ASSERT_EQ(rig.call(at(line_call(forward, true), rig.command().p + dice.within(0.05))),
              Reason::kNone);
    for (int i = 0; i < 4000; ++i) {
      const double travel = rig.command().p.dot(forward);
      ASSERT_GT(travel, furthest - 1e-12) << "run " << run << " tick " << i;
      furthest = std::max(furthest, travel);
      // Clutching in between must not take it back either.
      rig.in.hand.clutch_button = i / 300 % 3 == 2;
      wander.move(dice, 0.5, 1.0, HapticRig::kTick, rig.in.hand.X_MH);
      rig.tick();
    }
  }
}

TEST(HapticTools, AnEndPointIsReachedAndNeverPassed) {
  HapticRig rig;
  rig.engage();
  ToolCall line = line_call(Vec3::UnitY(), true);
  line.has_end = true;
  line.p_SE = rig.command().p + Vec3(0, 0.05, 0);
  ASSERT_EQ(rig.call(line), Reason::kNone);
  for (int i = 0; i < 1000; ++i) {
    rig.in.hand.X_MH.p.x() -= 1e-4;  // +Y of the base; 200 mm in all
    rig.tick();
    ASSERT_LE(rig.command().p.y(), line.p_SE.y() + 1e-12);
  }
  EXPECT_NEAR(rig.command().p.y(), line.p_SE.y(), 1e-9);
}

TEST(HapticTools, AToolCalledElsewhereIsReachedAtABoundedSpeedAndThenKept) {
  for (int run = 0; run < 20; ++run) {
    Dice dice(static_cast<std::uint64_t>(1000 + run));
    HapticRig rig;
    rig.settings.guide.reach = 1.0;
    rig.engage();
    const ToolCall calls[] = {call_of(ToolKind::kPoint), line_call(dice.unit()),
                              plane_call(dice.unit())};
    const Vec3 away = 0.05 * dice.unit();
    ASSERT_EQ(rig.call(at(calls[run % 3], rig.command().p + away)), Reason::kNone);
    const double first = off_position_tool(rig);
    Vec3 last = rig.command().p;
    double off = first;
    for (int i = 0; i < 3000; ++i) {
      rig.tick();
      ASSERT_LE((rig.command().p - last).norm(), rig.settings.guide.catch_up * 1e-3 + 1e-12);
      ASSERT_LE(off_position_tool(rig), off + 1e-12);
      off = off_position_tool(rig);
      last = rig.command().p;
    }
    EXPECT_LT(off, 1e-12);
    EXPECT_FALSE(rig.out.blending);
    rig.in.hand.X_MH.p += dice.within(0.05);
    for (int i = 0; i < 300; ++i) {
      rig.tick();
      ASSERT_LT(off_position_tool(rig), 1e-12);
    }
  }
}

TEST(HapticTools, CallingAndDroppingAToolDoesNotStepTheCommand) {
  for (int run = 0; run < 40; ++run) {
    Dice dice(static_cast<std::uint64_t>(1100 + run));
    HapticRig rig;
    rig.settings.guide.reach = 1.0;
    rig.engage();
    Wander wander;
    Pose last = rig.command();
    for (int i = 0; i < 2000; ++i) {
      wander.move(dice, 0.2, 1.0, HapticRig::kTick, rig.in.hand.X_MH);
      if (i % 100 == 50) {
        const ToolCall calls[] = {
            at(call_of(ToolKind::kPoint), rig.command().p + dice.within(0.03)),
            at(line_call(dice.unit(), run % 2 == 0), rig.command().p + dice.within(0.03)),
            call_of(ToolKind::kNRotation), call_of(ToolKind::kFRotation)};
        if (i % 300 == 50) {
          rig.drop(true, true);
        } else {
          rig.call(calls[(i / 100) % 4]);
        }
      } else {
        rig.tick();
      }
      // Hand through k = 2 and easing together.
      ASSERT_LT((rig.command().p - last.p).norm(), 1.6e-3);
      ASSERT_LT(angle_between(rig.command().q, last.q), 5e-3);
      last = rig.command();
    }
  }
}

TEST(HapticTools, ALowLagSmootherFollowsAfter52MillisecondsThePublishedAfter99AndAHalf) {
  for (const auto& [length, lag] : {std::pair(200, 99.5), std::pair(105, 52.0)}) {
    HapticRig rig;
    rig.settings.guide.smoother_length = length;
    rig.engage();
    const double start = rig.command().p.z();
    const int ticks = 600;
    for (int i = 0; i < ticks; ++i) rig.in.hand.X_MH.p.y() += 1e-4, rig.tick();
    // 0.2 mm of command a tick.
    EXPECT_NEAR(rig.command().p.z() - start, 2e-4 * (ticks - lag), 1e-9);
  }
}

TEST(HapticTools, NRotationKeepsTheOrientationAndFRotationTheAxisForRandomHands) {
  for (const ToolKind kind : {ToolKind::kNRotation, ToolKind::kFRotation}) {
    Dice dice(1200);
    HapticRig rig;
    rig.engage();
    Wander wander;
    for (int i = 0; i < 300; ++i) {
      wander.move(dice, 0.2, 1.0, HapticRig::kTick, rig.in.hand.X_MH);
      rig.tick();
    }
    ASSERT_EQ(rig.call(call_of(kind)), Reason::kNone);
    const Quat kept = rig.command().q;
    double turned = 0.0;
    for (int i = 0; i < 5000; ++i) {
      wander.move(dice, 0.2, 1.5, HapticRig::kTick, rig.in.hand.X_MH);
      rig.tick();
      if (kind == ToolKind::kNRotation) {
        ASSERT_LT(angle_between(rig.command().q, kept), 1e-9);
      } else if (rig.out.deviation_angle < 170 * kDeg && !rig.out.blending) {
        ASSERT_LT(off_axis(rig), 1e-9);
        turned = std::max(turned, angle_between(rig.command().q, kept));
      }
    }
    EXPECT_TRUE(kind == ToolKind::kNRotation || turned > 0.2);
  }
}

TEST(HapticTools, FRotationPastHalfATurnNeitherFlipsNorJumps) {
  HapticRig rig;
  rig.engage();
  ASSERT_EQ(rig.call(call_of(ToolKind::kFRotation)), Reason::kNone);
  // About an axis of the base across the tip's: the tip's axis tumbles all the way round, twice.
  const Vec3 across_S = (rig.command().q * Vec3::UnitZ()).unitOrthogonal();
  const Vec3 across_M = rig.settings.mapping.R_SM.transpose() * across_S;
  Quat last = rig.command().q;
  for (int i = 0; i < 13000; ++i) {
    rig.in.hand.X_MH.q = (rotation_exp(1e-3 * across_M) * rig.in.hand.X_MH.q).normalized();
    rig.tick();
    ASSERT_TRUE(rig.finite);
    ASSERT_LT(angle_between(rig.command().q, last), 2e-3) << i;
    last = rig.command().q;
  }
}

// Beside the pole the way back may point elsewhere when the hand comes out again.
TEST(HapticTools, FRotationLeftBesideHalfATurnIsRejoinedByEasing) {
  HapticRig rig;
  rig.settings.guide.smoother_length = 1;
  rig.engage();
  ASSERT_EQ(rig.call(call_of(ToolKind::kFRotation)), Reason::kNone);
  const Mat3 to_master = rig.settings.mapping.R_SM.transpose();
  const Vec3 kept_M = to_master * (rig.command().q * Vec3::UnitZ());
  const Quat start = rig.in.hand.X_MH.q;
  const auto tilt_M = [&](double around) -> Vec3 {
    return rotation_exp(around * kept_M) * kept_M.unitOrthogonal();
  };
  Quat last = rig.command().q;
  const auto go_to = [&](double tilt, double around) {
    rig.in.hand.X_MH.q =
        rotation_exp(tilt * kDeg * tilt_M(around)) * (rotation_exp(around * kept_M) * start);
    rig.tick();
    // 0.1 degrees of hand, its share about the axis near the pole, and the easing.
    ASSERT_LT(angle_between(rig.command().q, last), 6e-3) << tilt << " " << around;
    last = rig.command().q;
  };
  for (double tilt = 0.0; tilt < 178.0; tilt += 0.1) go_to(tilt, 0.0);
  for (double around = 0.0; around < 1.5; around += 1e-3) go_to(178.0, around);
  for (double tilt = 178.0; tilt > 90.0; tilt -= 0.1) go_to(tilt, 1.5);
  for (int i = 0; i < 8000; ++i) go_to(90.0, 1.5);
  EXPECT_LT(off_axis(rig), 1e-9);
}

// Near the pole the way back to the axis spins far faster than the hand: the samples scatter.
TEST(HapticTools, FRotationBesideHalfATurnNeverJumpsHoweverTheHandCircles) {
  for (const double rounds_per_second : {3.0, 4.0, 5.0, 7.0}) {
    HapticRig rig;
    rig.engage();
    ASSERT_EQ(rig.call(call_of(ToolKind::kFRotation)), Reason::kNone);
    const Mat3 to_master = rig.settings.mapping.R_SM.transpose();
    const Vec3 kept_M = to_master * (rig.command().q * Vec3::UnitZ());
    const Vec3 across_M = kept_M.unitOrthogonal();
    const double most =
        2.0 * std::asin(2.0 / (OrientationSmoother::kLeast * rig.settings.guide.smoother_length));
    Quat last = rig.command().q;
    double turned = 0.0;
    const auto turn = [&](const Quat& by) {
      rig.in.hand.X_MH.q = (by * rig.in.hand.X_MH.q).normalized();
      rig.tick();
      turned = std::max(turned, angle_between(rig.command().q, last));
      last = rig.command().q;
    };
    for (int i = 0; i < 1720; ++i) turn(rotation_exp(0.1 * kDeg * across_M));
    Vec3 axis = rotation_exp(172.0 * kDeg * across_M) * kept_M;
    const Quat step = rotation_exp(2.0 * std::numbers::pi * rounds_per_second * 1e-3 * kept_M);
    for (int i = 0; i < 3000; ++i) {
      const Vec3 next = step * axis;
      turn(smallest_turn(axis, next));
      axis = next;
    }
    EXPECT_LT(turned, most + rig.settings.guide.catch_up_rotation * HapticRig::kTick);
    EXPECT_GT(turned, 0.005) << "far more than the hand's 3 mrad a tick over 200";
  }
}

// A rate-limited chase would let the command fall behind a turning hand without bound.
TEST(HapticTools, AfterNRotationIsReleasedHandRotationPassesOneToOneAndTheOffsetDecaysBounded) {
  for (int run = 0; run < 20; ++run) {
    Dice dice(static_cast<std::uint64_t>(1300 + run));
    HapticRig rig;
    rig.settings.guide.smoother_length = 1;
    rig.engage();
    rig.call(call_of(ToolKind::kNRotation));
    const double turn = dice.between(10 * kDeg, 90 * kDeg);
    rig.in.hand.X_MH.q = rotation_exp(turn * dice.unit()) * rig.in.hand.X_MH.q;
    rig.ticks(20);
    rig.drop(false, true);
    const auto hand_S = [&rig] {
      return rig.state->command.engagement.to_slave(rig.in.hand.X_MH).q;
    };
    double offset = angle_between(hand_S(), rig.command().q);
    EXPECT_NEAR(offset, turn, 0.01);
    const double bound = rig.settings.guide.catch_up_rotation * HapticRig::kTick;
    Wander wander;
    int ticks = 0;
    for (; ticks < 10000 && offset > 0.0; ++ticks) {
      const Quat hand_before = hand_S(), command_before = rig.command().q;
      wander.move(dice, 0.1, run % 2 == 0 ? 0.0 : 2.0, HapticRig::kTick, rig.in.hand.X_MH);
      rig.tick();
      const double now = angle_between(hand_S(), rig.command().q);
      ASSERT_LE(now, offset + 1e-7);
      ASSERT_GE(now, offset - bound - 1.5e-7);
      // What the hand turned, the command turned too, but for the decay.
      const Quat hand_turn = hand_S() * hand_before.conjugate();
      const Quat command_turn = rig.command().q * command_before.conjugate();
      ASSERT_LE(angle_between(hand_turn, command_turn), bound + 1e-7);
      offset = now < 1e-7 ? 0.0 : now;
    }
    EXPECT_LT(ticks, 8500);  // 90 degrees at 15 degrees a second, and the tail
  }
}

TEST(HapticTools, ReClutchingOntoAToolWithAStillHandMovesNothing) {
  HapticRig rig;
  Dice dice(1400);
  rig.engage();
  rig.call(line_call(dice.unit(), true));
  rig.call(call_of(ToolKind::kFRotation));
  Wander wander;
  for (int i = 0; i < 500; ++i) {
    wander.move(dice, 0.2, 0.5, HapticRig::kTick, rig.in.hand.X_MH);
    rig.tick();
  }
  for (int clutching = 0; clutching < 10; ++clutching) {
    rig.in.hand.clutch_button = true;
    rig.tick();
    const Pose frozen = rig.command();
    for (int i = 0; i < 100; ++i) {
      wander.move(dice, 0.2, 0.5, HapticRig::kTick, rig.in.hand.X_MH);
      rig.tick();
    }
    rig.in.hand.clutch_button = false;
    for (int i = 0; i < 300; ++i) {
      rig.tick();
      ASSERT_LT((rig.command().p - frozen.p).norm(), 1e-12);
      ASSERT_LT(angle_between(rig.command().q, frozen.q), 1e-9);
    }
  }
}

TEST(HapticTools, AToolCalledWithTheClutchHeldSinceEngagingIsAnchoredAtTheTip) {
  HapticRig rig;
  rig.in.hand.clutch_button = true;
  rig.engage();
  ASSERT_EQ(rig.session(), SessionState::kClutched);
  const Pose tip = rig.command();
  ASSERT_EQ(rig.call(line_call(Vec3::UnitY())), Reason::kNone);
  ASSERT_EQ(rig.call(call_of(ToolKind::kNRotation)), Reason::kNone);
  EXPECT_LT((rig.out.link.position_tool.p_SA - tip.p).norm(), 1e-12);
  EXPECT_LT(angle_between(rig.out.link.orientation_tool.q_ref, tip.q), 1e-7);
  rig.in.hand.clutch_button = false;
  rig.ticks(500);
  EXPECT_LT((rig.command().p - tip.p).norm(), 1e-9) << "released with the hand still";
  EXPECT_LT(angle_between(rig.command().q, tip.q), 1e-7);
}

TEST(HapticTools, TheToolsInTheLinkAreAbsoluteAndInTheBaseFrame) {
  HapticRig rig;
  rig.settings.guide.reach = 1.0;
  rig.engage();
  ToolCall line = at(line_call({0, 3, 0}, true), {0.4, 0.1, 0.5});
  line.has_end = true;
  line.p_SE = Vec3(0.4, 0.3, 0.7);  // its share along the line counts
  ASSERT_EQ(rig.call(line), Reason::kNone);
  const ToolDefinition& tool = rig.out.link.position_tool;
  EXPECT_EQ(tool.kind, ToolKind::kLine);
  EXPECT_EQ(tool.p_SA, Vec3(0.4, 0.1, 0.5));
  EXPECT_EQ(tool.direction_S, Vec3(0, 1, 0));
  EXPECT_NEAR(tool.end, 0.2, 1e-15);
  EXPECT_TRUE(tool.one_way);
  EXPECT_EQ(tool.stiffness, 800.0);
}

}  // namespace
}  // namespace handrail
