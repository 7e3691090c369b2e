// Recorded hands through tools: on the tool, never backward, within the joints' speed, repeatable.
#include "server/lab/hand/hand_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "server/kinematics/rv2a.h"

namespace handrail {
namespace {

using Path = std::function<Vec3(double t)>;

// `path` sampled at 100 Hz for `seconds`.
RecordedMotion sampled(const Path& path, double seconds) {
  std::vector<RecordedSample> samples;
  for (int i = 0; i <= static_cast<int>(seconds * 100.0); ++i) {
    const double t = 0.01 * i;
    samples.push_back({t, path(t)});
  }
  return RecordedMotion(std::move(samples));
}

RecordedMotion straight() {
  return sampled([](double t) { return Vec3(0.02 * t, 0.005 * t, 0.0); }, 3.0);
}

RecordedMotion circle() {
  return sampled(
      [](double t) {
        const double a = std::numbers::pi * t;
        return Vec3(-0.04 * std::cos(a), 0.04 * std::sin(a), 0.01 * std::sin(2.0 * a));
      },
      4.0);
}

// Back and forth at up to 0.4 m/s, standing still between the strokes.
RecordedMotion zigzag() {
  return sampled(
      [](double t) {
        const double stroke = std::floor(t / 0.4);
        const double part = std::min(1.0, (t - 0.4 * stroke) / 0.15);
        const double x = std::fmod(stroke, 2.0) == 0.0 ? part : 1.0 - part;
        return Vec3(0.06 * x, 0.005 * stroke, -0.02 * x);
      },
      3.2);
}

RecordedMotion with_gaps() {
  const auto at = [](double t, double x, double y) { return RecordedSample{t, Vec3(x, y, 0.0)}; };
  return RecordedMotion({at(0, 0, 0), at(0.1, 0.01, 0), at(0.9, 0.05, 0.03), at(1.0, 0.05, 0.02),
                         at(2.5, -0.03, 0), at(2.6, -0.02, 0)});
}

// A metre away within 50 ms: the arm cannot follow and cannot reach.
RecordedMotion jump() {
  return RecordedMotion({{0.0, Vec3::Zero()},
                         {0.5, Vec3::Zero()},
                         {0.55, Vec3(1.0, 1.0, -1.0)},
                         {1.5, Vec3(1.0, 1.0, -1.0)},
                         {1.55, Vec3(-0.5, -1.0, 1.0)},
                         {2.0, Vec3(-0.5, -1.0, 1.0)}});
}

Scene scene() {
  Scene s;
  s.name = "test";
  s.limits.joints = rv2a_limits();
  return s;
}

struct Case {
  const char* name;
  RecordedMotion (*motion)();
  ToolKind tool;
  bool one_way;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class HandRun : public ::testing::TestWithParam<Case> {};

TEST_P(HandRun, KeepsTheTipOnTheToolWithinTheJointsSpeed) {
  const RecordedMotion motion = GetParam().motion();
  const auto result = run_hand(scene(), motion, {GetParam().tool, GetParam().one_way, 1});
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->samples, motion.rows());
  EXPECT_EQ(result->gaps, motion.gaps());
  EXPECT_LT(result->max_off_tool, 0.01e-3);
  EXPECT_EQ(result->backward_steps, 0u);
  EXPECT_LE(result->max_joint_speed_ratio, 1.0);
  EXPECT_LE(result->max_force, 3.3 + 1e-9);
  EXPECT_EQ(result->non_finite, 0u);
  if (GetParam().tool != ToolKind::kPoint) {
    EXPECT_GT(result->max_joint_speed_ratio, 0.001);
  }
}

constexpr ToolKind kPoint = ToolKind::kPoint, kLine = ToolKind::kLine, kPlane = ToolKind::kPlane;

INSTANTIATE_TEST_SUITE_P(
    Motions, HandRun,
    ::testing::Values(
        Case{"StraightPoint", straight, kPoint, false},
        Case{"StraightLine", straight, kLine, false},
        Case{"StraightLineOneWay", straight, kLine, true},
        Case{"CirclePoint", circle, kPoint, false}, Case{"CircleLine", circle, kLine, false},
        Case{"CircleLineOneWay", circle, kLine, true}, Case{"CirclePlane", circle, kPlane, false},
        Case{"CirclePlaneOneWay", circle, kPlane, true}, Case{"ZigzagLine", zigzag, kLine, false},
        Case{"ZigzagLineOneWay", zigzag, kLine, true},
        Case{"ZigzagPlaneOneWay", zigzag, kPlane, true},
        Case{"GapsLineOneWay", with_gaps, kLine, true}, Case{"GapsPlane", with_gaps, kPlane, false},
        Case{"JumpPoint", jump, kPoint, false}, Case{"JumpLine", jump, kLine, false},
        Case{"JumpLineOneWay", jump, kLine, true}, Case{"JumpPlane", jump, kPlane, false},
        Case{"JumpPlaneOneWay", jump, kPlane, true}),
    [](const auto& one) { return std::string(one.param.name); });

void expect_same(const HandRunResult& a, const HandRunResult& b) {
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.gaps, b.gaps);
  EXPECT_EQ(a.max_off_tool, b.max_off_tool);
  EXPECT_EQ(a.backward_steps, b.backward_steps);
  EXPECT_EQ(a.max_joint_speed_ratio, b.max_joint_speed_ratio);
  EXPECT_EQ(a.max_force, b.max_force);
  EXPECT_EQ(a.non_finite, b.non_finite);
}

TEST(HandRunTest, TheSameInputGivesTheSameBits) {
  const HandRunOptions options{ToolKind::kLine, true, 1};
  const auto first = run_hand(scene(), circle(), options);
  const auto second = run_hand(scene(), circle(), options);
  ASSERT_TRUE(first && second);
  expect_same(*first, *second);
}

TEST(HandRunTest, TheHandFeelsTheLineItIsHeldOff) {
  const auto result = run_hand(scene(), circle(), {ToolKind::kLine, false, 1});
  ASSERT_TRUE(result);
  EXPECT_GT(result->max_force, 1.0);
}

TEST(HandRunTest, AOneWayToolHoldsAgainstAHandThatGoesBack) {
  const RecordedMotion there_and_back = sampled(
      [](double t) { return Vec3(0.015 * (1.0 - std::cos(std::numbers::pi * t / 2.0)), 0.0, 0.0); },
      4.0);
  for (const ToolKind tool : {kLine, kPlane}) {
    const auto both_ways = run_hand(scene(), there_and_back, {tool, false, 1});
    const auto one_way = run_hand(scene(), there_and_back, {tool, true, 1});
    ASSERT_TRUE(both_ways && one_way);
    EXPECT_LT(both_ways->max_force, 1.0);
    EXPECT_GT(one_way->max_force, 2.0);
  }
}

TEST(HandRunTest, RefusesAHandFurtherOffThanAnyDevice) {
  const RecordedMotion far({{0.0, Vec3::Zero()}, {1.0, Vec3(0, 10.1, 0)}});
  const auto result = run_hand(scene(), far, {});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.message(),
            "the recording reaches 5050 mm from its centre; expected at most 5000 mm");
  const RecordedMotion near({{0.0, Vec3::Zero()}, {1.0, Vec3(0, 9.9, 0)}});
  EXPECT_TRUE(run_hand(scene(), near, {}));
}

}  // namespace
}  // namespace handrail
