// The task's measures on drives whose answers are known.
#include "server/task/linear_measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/base/random.h"
#include "server/base/units.h"
#include "server/kinematics/rv2a.h"

namespace handrail {
namespace {

Vec3 mm(double x, double y, double z) { return kMm * Vec3(x, y, z); }

// Orientation `turn_deg` about Z away from the task's first nominal one.
Quat turned(const LinearTask& task, double turn_deg) {
  return rotation_exp({0.0, 0.0, turn_deg * kDeg}) * task.q_first;
}

// From the origin 100 mm along X, turn 45 deg about Z, 50 mm up.
LinearTask corner() {
  LinearTask task;
  task.p_SB = mm(100, 0, 0);
  task.p_SC = mm(100, 0, 50);
  task.turn = {0.0, 0.0, 45.0 * kDeg};
  return task;
}

// A measure of that task, with its samples in millimetres and degrees about Z.
struct Drive {
  LinearTask task = corner();
  LinearMeasure measure{task};

  void begin(LinearPhase phase, double turn_deg = 0.0, double ref_deg = 0.0) {
    measure.begin(phase, turned(task, turn_deg), turned(task, ref_deg));
  }
  void add(double x, double y, double z, double turn_deg = 0.0) {
    measure.add({mm(x, y, z), turned(task, turn_deg)});
  }
};

double length_mm(const PathLength& path) { return path.length() / kMm; }

TEST(LinearTask, TheFirstOrientationIsTheArmsAtItsStart) {
  JointVector start = JointVector::Zero();
  start[2] = start[4] = 90.0 * kDeg;
  EXPECT_NEAR(angle_between(LinearTask().q_first, forward(ArmGeometry(), start).q), 0.0, 1e-7);
}

TEST(LinearTask, TheSecondLegHoldsTheFirstOrientationTurnedInTheBase) {
  const LinearTask task = corner();
  EXPECT_NEAR((task.q_first * Vec3::UnitZ() + Vec3::UnitZ()).norm(), 0.0, 1e-12);
  const Vec3 x = task.q_second() * (task.q_first.conjugate() * Vec3::UnitX());
  EXPECT_NEAR((x - Vec3(1, 1, 0).normalized()).norm(), 0.0, 1e-12);
}

TEST(PathLength, AStraightPathHasItsLength) {
  PathLength path;
  for (int x = 0; x <= 100; ++x) path.add(mm(x, 0, 0));
  EXPECT_NEAR(length_mm(path), 100.0, 1e-9);
}

TEST(PathLength, NothingAndOnePointHaveNone) {
  PathLength path;
  EXPECT_EQ(path.length(), 0.0);
  path.add(mm(300, 0, 0));
  EXPECT_EQ(path.length(), 0.0);
}

TEST(PathLength, AZigZagAboveTheVertexCountsInFull) {
  // Steps of (0.6, 0.8, 0) mm and back in Y: 1 mm each.
  PathLength path;
  for (int i = 0; i <= 50; ++i) path.add(mm(0.6 * i, 0.8 * (i % 2), 0));
  EXPECT_NEAR(length_mm(path), 50.0, 1e-9);
}

TEST(PathLength, AZigZagBelowTheVertexCountsNothing) {
  PathLength path;
  for (int i = 0; i < 1000; ++i) path.add(mm(0.49 * (i % 2), 0, 0));
  EXPECT_EQ(path.length(), 0.0);
}

TEST(PathLength, AVertexIsHalfAMillimetreFromTheLastOne) {
  PathLength path;
  path.add(mm(0, 0, 0));
  path.add(mm(0.49, 0, 0));
  EXPECT_EQ(path.length(), 0.0);
  path.add(mm(0.51, 0, 0));
  EXPECT_NEAR(length_mm(path), 0.51, 1e-9);
  path.add(mm(1.0, 0, 0));  // 0.49 mm from the vertex at 0.51 mm
  EXPECT_NEAR(length_mm(path), 0.51, 1e-9);
  path.add(mm(0, 0, 0));
  EXPECT_NEAR(length_mm(path), 1.02, 1e-9);
}

TEST(PathLength, NoiseOfThirtyMicrometresDoesNotLengthenIt) {
  // 100 mm in 10 000 samples; joined one by one they would be about 6 times as long.
  Random random(1);
  PathLength path;
  double joined = 0.0;
  Vec3 last = Vec3::Zero();
  for (int i = 0; i <= 10000; ++i) {
    const Vec3 noise(random.normal(), random.normal(), random.normal());
    const Vec3 p = mm(0.01 * i, 0, 0) + 30e-6 * noise;
    joined += i == 0 ? 0.0 : (p - last).norm();
    path.add(last = p);
  }
  EXPECT_GT(joined, 0.5);
  EXPECT_NEAR(length_mm(path), 100.0, 1.5);
}

TEST(PathLength, AnArcIsItsChords) {
  // Quarter of a circle of 60 mm in steps of 1 deg: 90 chords of 2 r sin(0.5 deg).
  PathLength path;
  for (int i = 0; i <= 90; ++i) {
    path.add(mm(60 * std::cos(i * kDeg), 60 * std::sin(i * kDeg), 0));
  }
  EXPECT_NEAR(length_mm(path), 90 * 120 * std::sin(0.5 * kDeg), 1e-9);
  EXPECT_NEAR(length_mm(path), 30 * std::numbers::pi, 0.01);
}

TEST(DistanceToSegment, BeyondTheEndsItIsTheDistanceToTheEnd) {
  const Vec3 a(0, 0, 0), b(1, 0, 0);
  EXPECT_DOUBLE_EQ(distance_to_segment({1.3, 0.4, 0}, a, b), 0.5);
  EXPECT_DOUBLE_EQ(distance_to_segment({-0.3, 0, 0.4}, a, b), 0.5);
  EXPECT_DOUBLE_EQ(distance_to_segment({0.5, 0.25, 0}, a, b), 0.25);
  EXPECT_DOUBLE_EQ(distance_to_segment({0.5, 0, 0}, a, a), 0.5);
}

TEST(LinearMeasure, APerfectDriveHasItsLengthAndNoError) {
  Drive drive;
  drive.begin(LinearPhase::kToB);
  for (int x = 0; x <= 100; ++x) drive.add(x, 0, 0);
  drive.begin(LinearPhase::kTurn);
  for (int turn = 0; turn <= 45; ++turn) drive.add(100, 0, 0, turn);
  drive.begin(LinearPhase::kToC, 45, 45);
  for (int z = 0; z <= 50; ++z) drive.add(100, 0, z, 45);
  EXPECT_NEAR(drive.measure.path() / kMm, 150.0, 1e-9);
  EXPECT_NEAR(drive.measure.position_error(), 0.0, 1e-12);
  EXPECT_NEAR(drive.measure.orientation_error(), 0.0, 1e-7);
  EXPECT_NEAR(drive.measure.orientation_error_to_reference(), 0.0, 1e-7);
  EXPECT_NEAR(drive.measure.orientation_error_to_nominal(), 0.0, 1e-7);
}

TEST(LinearMeasure, TheErrorIsTheLargestDistanceFromThePhasesSegment) {
  Drive drive;
  drive.begin(LinearPhase::kToB);
  drive.add(50, 2, 0);
  drive.add(60, -1, 0);
  EXPECT_NEAR(drive.measure.position_error() / kMm, 2.0, 1e-9);
  drive.begin(LinearPhase::kToC);
  drive.add(97, 0, 25);  // 3 mm off BC, and 25 mm off AB
  EXPECT_NEAR(drive.measure.position_error() / kMm, 3.0, 1e-9);
  EXPECT_NEAR(drive.measure.position_error_on_lines() / kMm, 3.0, 1e-9);
}

TEST(LinearMeasure, OvershootBeyondTheSegmentsEndIsAnError) {
  Drive drive;
  drive.begin(LinearPhase::kToB);
  drive.add(104, 0, 0);
  EXPECT_NEAR(drive.measure.position_error() / kMm, 4.0, 1e-9);
  drive.begin(LinearPhase::kToC);
  drive.add(100, 3, 54);
  EXPECT_NEAR(drive.measure.position_error() / kMm, 5.0, 1e-9);
}

TEST(LinearMeasure, WhileTurningTheDistanceIsToBAndOrientationIsFree) {
  Drive drive;
  drive.begin(LinearPhase::kTurn);
  drive.add(98.5, 0, 0, 40);  // on AB, but not at B
  EXPECT_NEAR(drive.measure.position_error() / kMm, 1.5, 1e-9);
  EXPECT_EQ(drive.measure.position_error_on_lines(), 0.0);
  EXPECT_EQ(drive.measure.orientation_error(), 0.0);
  EXPECT_EQ(drive.measure.orientation_error_to_reference(), 0.0);
  EXPECT_EQ(drive.measure.orientation_error_to_nominal(), 0.0);
}

TEST(LinearMeasure, SamplesBetweenPhasesArePathButAreNotJudged) {
  Drive drive;
  drive.add(0, 20, 0, 30);  // before the first
  drive.begin(LinearPhase::kToB);
  drive.add(0, 1, 0, 2);
  drive.measure.end();
  drive.add(0, 50, 0, 90);
  EXPECT_NEAR(drive.measure.position_error() / kMm, 1.0, 1e-9);
  EXPECT_NEAR(drive.measure.orientation_error() / kDeg, 2.0, 1e-6);
  EXPECT_NEAR(drive.measure.orientation_error_to_reference() / kDeg, 2.0, 1e-6);
  EXPECT_NEAR(drive.measure.orientation_error_to_nominal() / kDeg, 2.0, 1e-6);
  EXPECT_NEAR(drive.measure.path() / kMm, 19.0 + 49.0, 1e-9);
  drive.begin(LinearPhase::kToB);
  drive.add(0, 7, 0);
  EXPECT_NEAR(drive.measure.position_error() / kMm, 7.0, 1e-9);
}

TEST(LinearMeasure, TheThreeOrientationErrorsHaveTheirOwnReference) {
  Drive drive;
  drive.begin(LinearPhase::kToB, 10, 4);  // tip at 10 deg, 4 deg commanded, 0 deg nominal
  drive.add(0, 0, 0, 12);
  EXPECT_NEAR(drive.measure.orientation_error() / kDeg, 2.0, 1e-6);
  EXPECT_NEAR(drive.measure.orientation_error_to_reference() / kDeg, 8.0, 1e-6);
  EXPECT_NEAR(drive.measure.orientation_error_to_nominal() / kDeg, 12.0, 1e-6);
}

TEST(LinearMeasure, OnTheSecondLegEachReferenceIsThatLegs) {
  Drive drive;
  drive.begin(LinearPhase::kToB, 10, 4);
  drive.begin(LinearPhase::kToC, 50, 47);  // 45 deg nominal after the turn
  drive.add(100, 0, 0, 51);
  EXPECT_NEAR(drive.measure.orientation_error() / kDeg, 1.0, 1e-6);
  EXPECT_NEAR(drive.measure.orientation_error_to_reference() / kDeg, 4.0, 1e-6);
  EXPECT_NEAR(drive.measure.orientation_error_to_nominal() / kDeg, 6.0, 1e-6);
}

TEST(LinearMeasure, TheLargestErrorOutlivesAPhase) {
  Drive drive;
  drive.begin(LinearPhase::kToB);
  drive.add(0, 6, 0, 5);
  drive.begin(LinearPhase::kToC, 45, 45);
  drive.add(100, 1, 0, 46);
  EXPECT_NEAR(drive.measure.position_error() / kMm, 6.0, 1e-9);
  EXPECT_NEAR(drive.measure.orientation_error() / kDeg, 5.0, 1e-6);
  EXPECT_NEAR(drive.measure.orientation_error_to_reference() / kDeg, 5.0, 1e-6);
  EXPECT_NEAR(drive.measure.orientation_error_to_nominal() / kDeg, 5.0, 1e-6);
}

}  // namespace
}  // namespace handrail
