// The demo's measures on drives whose answers are known.
#include "client/cli/demo_measure.h"

#include <gtest/gtest.h>

#include "server/base/units.h"

namespace handrail {
namespace {

Pose at_mm(double x, double y, double z, double turn_deg = 0.0) {
  Pose X;
  X.p = kMm * Vec3(x, y, z);
  X.q = rotation_exp({0.0, 0.0, turn_deg * kDeg});
  return X;
}

DemoTask task() {
  DemoTask t;
  t.p_B = kMm * Vec3(100, 0, 0);
  t.p_C = kMm * Vec3(100, 0, 50);
  return t;
}

TEST(DemoMeasure, AStraightDriveHasItsLengthAndNoError) {
  DemoMeasure measure(task());
  measure.begin(DemoPhase::kToB, Quat::Identity());
  for (int x = 0; x <= 100; ++x) measure.add(at_mm(x, 0, 0));
  measure.begin(DemoPhase::kToC, Quat::Identity());
  for (int z = 0; z <= 50; ++z) measure.add(at_mm(100, 0, z));
  EXPECT_NEAR(measure.path(), 0.150, 1e-9);
  EXPECT_NEAR(measure.position_error(), 0.0, 1e-12);
  EXPECT_EQ(measure.orientation_error(), 0.0);
}

TEST(DemoMeasure, NoiseUnderTheVertexIsNoPath) {
  DemoMeasure measure(task());
  for (int i = 0; i < 1000; ++i) measure.add(at_mm(0.1 * (i % 2), 0.1 * (i % 3 - 1), 0));
  EXPECT_EQ(measure.path(), 0.0);
  measure.add(at_mm(0.3, 0, 0));
  EXPECT_EQ(measure.path(), 0.0);
}

TEST(DemoMeasure, HalfAMillimetreFromTheLastVertexIsPath) {
  DemoMeasure measure(task());
  measure.add(at_mm(0, 0, 0));
  measure.add(at_mm(0.3, 0, 0));
  EXPECT_EQ(measure.path(), 0.0);
  measure.add(at_mm(0.6, 0, 0));
  EXPECT_NEAR(measure.path(), 0.0006, 1e-12);
  measure.add(at_mm(1.0, 0, 0));  // 0.4 mm from the vertex at 0.6 mm
  EXPECT_NEAR(measure.path(), 0.0006, 1e-12);
  measure.add(at_mm(0, 0, 0));
  EXPECT_NEAR(measure.path(), 0.0012, 1e-12);
}

TEST(DemoMeasure, TheErrorIsTheLargestDistanceFromTheSegmentOfThePhase) {
  DemoMeasure measure(task());
  measure.begin(DemoPhase::kToB, Quat::Identity());
  measure.add(at_mm(50, 2, 0));
  measure.add(at_mm(60, -1, 0));
  EXPECT_NEAR(measure.position_error(), 0.002, 1e-12);
  measure.begin(DemoPhase::kToC, Quat::Identity());
  measure.add(at_mm(97, 0, 25));  // on neither segment, 3 mm off BC
  EXPECT_NEAR(measure.position_error(), 0.003, 1e-12);
}

TEST(DemoMeasure, BeyondTheEndsTheDistanceIsToTheEnd) {
  const Vec3 a(0, 0, 0), b(1, 0, 0);
  EXPECT_DOUBLE_EQ(distance_to_segment({1.3, 0.4, 0}, a, b), 0.5);
  EXPECT_DOUBLE_EQ(distance_to_segment({-0.3, 0, 0.4}, a, b), 0.5);
  EXPECT_DOUBLE_EQ(distance_to_segment({0.5, 0.25, 0}, a, b), 0.25);
  EXPECT_DOUBLE_EQ(distance_to_segment({0.5, 0, 0}, a, a), 0.5);
}

TEST(DemoMeasure, OvershootBeyondBIsAnError) {
  DemoMeasure measure(task());
  measure.begin(DemoPhase::kToB, Quat::Identity());
  measure.add(at_mm(104, 0, 0));
  EXPECT_NEAR(measure.position_error(), 0.004, 1e-12);
}

TEST(DemoMeasure, WhileTurningTheDistanceIsToBAndOrientationIsFree) {
  DemoMeasure measure(task());
  measure.begin(DemoPhase::kTurn, Quat::Identity());
  measure.add(at_mm(98.5, 0, 0, 40.0));  // on AB, but not on B
  EXPECT_NEAR(measure.position_error(), 0.0015, 1e-12);
  EXPECT_EQ(measure.orientation_error(), 0.0);
}

TEST(DemoMeasure, OrientationIsMeasuredFromThePhasesStart) {
  DemoMeasure measure(task());
  measure.begin(DemoPhase::kToB, at_mm(0, 0, 0, 10.0).q);
  measure.add(at_mm(0, 0, 0, 12.0));
  measure.add(at_mm(1, 0, 0, 9.5));
  EXPECT_NEAR(measure.orientation_error() / kDeg, 2.0, 1e-6);
  measure.begin(DemoPhase::kToC, at_mm(0, 0, 0, 55.0).q);
  measure.add(at_mm(100, 0, 0, 52.0));
  EXPECT_NEAR(measure.orientation_error() / kDeg, 3.0, 1e-6);
}

}  // namespace
}  // namespace handrail
