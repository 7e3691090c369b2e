#include "tests/storm/drive.h"

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include "devices/rig/servo_arm.h"
#include "server/base/units.h"
#include "server/kinematics/rv2a.h"
#include "server/model/rv2a_limits.h"

namespace handrail::storm {
namespace {

const JointVector kStart = ServoArmOptions::default_start();

TEST(StormDrive, TheArmReachesAllOfItsRegionWithAllTurns) {
  constexpr double kSpare = 5.0 * kDeg;  // as drive.h says
  const DriveRegion region;
  const JointLimits& limits = rv2a_limits();
  Random random(1);
  const auto share = [&random](bool edge) {
    const double any = 2.0 * random.uniform() - 1.0;
    return edge ? std::copysign(1.0, any) : any;
  };
  for (int i = 0; i < 200'000; ++i) {
    // Half of them at the corners of the box and at the full turn, where the ends are.
    const bool edge = i % 2 == 0;
    const Vec3 place(share(edge), share(edge), share(edge));
    Vec3 turn(share(false), share(false), share(false));
    if (edge) turn.normalize();
    JointVector q;
    ASSERT_EQ(inverse_near(ArmGeometry(), region.at(place, turn), kStart, q), InverseStatus::kOk);
    ASSERT_GT((q - limits.lower).minCoeff(), kSpare) << q.transpose() / kDeg;
    ASSERT_GT((limits.upper - q).minCoeff(), kSpare) << q.transpose() / kDeg;
    ASSERT_EQ(branch_of(ArmGeometry(), q), branch_of(ArmGeometry(), kStart));
  }
}

TEST(StormDrive, TheArmStandsInTheRegionAtFirst) {
  const DriveRegion region;
  const Pose start = forward(ArmGeometry(), kStart);
  const Vec3 off = start.p - region.middle().p;
  EXPECT_LE(off.cwiseQuotient(DriveRegion::half()).cwiseAbs().maxCoeff(), 1.0);
  EXPECT_LT(start.q.angularDistance(region.middle().q), 1e-9);
}

TEST(StormDrive, WhatIsDrawnIsInTheRegion) {
  const DriveRegion region;
  Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const Pose X = region.any(random);
    const Vec3 off = X.p - region.middle().p;
    EXPECT_LE(off.cwiseQuotient(DriveRegion::half()).cwiseAbs().maxCoeff(), 1.0);
    EXPECT_LE(X.q.angularDistance(region.middle().q), DriveRegion::kTurn + 1e-9);
  }
}

// From the present command, wherever hand and tip were when they came together.
TEST(StormDrive, TheOrderLeadsTheCommandToItsGoal) {
  pb::Status status;
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(
      "hand { position_mm: [10, -5, 2] quaternion: [1, 0, 0, 0] }"
      "command { position_mm: [340, 20, 400] quaternion: [1, 0, 0, 0] }",
      &status));
  // Device right, up and toward the user are -Y, +Z and -X of the base.
  Pose goal;
  goal.p = Vec3(0.340 - 0.040, 0.020 - 0.020, 0.400 + 0.008);
  goal.q = Quat(Eigen::AngleAxisd(2.0 * kDeg, Vec3::UnitZ()));
  pb::Request request;
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(order_to(goal, status, 0.3), &request));
  EXPECT_NEAR(request.hand().displacement_mm(0), 20.0 / kScale, 1e-9);
  EXPECT_NEAR(request.hand().displacement_mm(1), 8.0 / kScale, 1e-9);
  EXPECT_NEAR(request.hand().displacement_mm(2), 40.0 / kScale, 1e-9);
  EXPECT_NEAR(request.hand().rotation_deg(1), 2.0, 1e-9);
  EXPECT_EQ(request.hand().duration_s(), 0.3);
  // Not past what the device reaches.
  goal.p.x() -= 1.0;
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(order_to(goal, status, 0.3), &request));
  EXPECT_NEAR(request.hand().displacement_mm(2), 30.0 - 2.0, 1e-9);
}

}  // namespace
}  // namespace handrail::storm
