// Backlash and the payload's weight.
#include <gtest/gtest.h>

#include "devices/rig/servo_arm.h"
#include "devices/rig/world/world.h"
#include "server/base/units.h"

namespace handrail {
namespace {

const JointVector kHome = ServoArmOptions::default_start();

TEST(Backlash, TheJointWaitsUntilThePlayIsCrossed) {
  BacklashSpec spec;
  spec.play[1] = 0.2 * kDeg;
  Backlash backlash(&spec, JointVector::Zero());
  JointVector q = JointVector::Zero();
  q[0] = 0.1;
  q[1] = 0.05 * kDeg;
  EXPECT_EQ(backlash.follow(q)[1], 0.0);
  EXPECT_EQ(backlash.follow(q)[0], 0.1) << "no play here";
  q[1] = 0.3 * kDeg;
  EXPECT_NEAR(backlash.follow(q)[1], 0.2 * kDeg, 1e-15) << "half of it behind";
  q[1] = 0.11 * kDeg;
  EXPECT_NEAR(backlash.follow(q)[1], 0.2 * kDeg, 1e-15) << "turned around, it waits again";
  q[1] = 0.0;
  EXPECT_NEAR(backlash.follow(q)[1], 0.1 * kDeg, 1e-15);
}

GravitySpec two_kilograms() {
  GravitySpec spec;
  spec.mass = 2.0;
  return spec;
}

TEST(GravitySag, TheTipSagsByTheWeightOverTheJointsStiffness) {
  GravitySpec spec = two_kilograms();
  spec.stiffness[1] = 10000.0;
  const GravitySag sag(&spec);
  const ArmGeometry arm;
  const double radius = forward(arm, kHome).p.x() - arm.a1;
  const JointVector bend = sag.bend(arm, kHome);
  EXPECT_NEAR(bend[1], 2.0 * kStandardGravity * radius / 10000.0, 1e-12) << "J2 leans forward";
  EXPECT_NEAR(bend[0], 0.0, 1e-15) << "the weight does not turn a vertical axis";
  // What the weight gives away is what the joints' springs take up, twice over.
  const double drop = forward(arm, kHome).p.z() - forward(arm, kHome + bend).p.z();
  const double taken = bend.cwiseAbs2().dot(spec.stiffness);
  EXPECT_NEAR(2.0 * kStandardGravity * drop, taken, 1e-3 * taken);
}

TEST(GravitySag, AnEccentricPayloadTurnsTheLastJoint) {
  GravitySpec spec = two_kilograms();
  spec.p_TC = Vec3(0, 0.05, 0);
  JointVector q = kHome;
  q[4] = 0.0;  // the tool points forward, J6's axis level
  const JointVector bend = GravitySag(&spec).bend(ArmGeometry(), q);
  const Vec3 centre = forward(ArmGeometry(), q).q * spec.p_TC;
  const Vec3 axis = forward(ArmGeometry(), q).q * Vec3::UnitZ();
  const double torque = centre.cross(Vec3(0, 0, -2.0 * kStandardGravity)).dot(axis);
  EXPECT_GT(std::abs(torque), 0.9);
  EXPECT_NEAR(std::abs(bend[5]), std::abs(torque) / spec.stiffness[5], 1e-12);
}

TEST(GravitySag, TheSensorCarriesTheWeightHoweverItIsTurned) {
  GravitySpec spec = two_kilograms();
  spec.p_TC = Vec3(0.01, 0, -0.05);
  const GravitySag sag(&spec);
  const double weight = 2.0 * kStandardGravity;
  const Wrench upright = sag.weight(Quat::Identity());
  EXPECT_NEAR(upright.force.z(), -weight, 1e-12);
  EXPECT_NEAR(upright.torque.y(), 0.01 * weight, 1e-12);
  const Wrench down = sag.weight(rotation_exp(Vec3(180 * kDeg, 0, 0)));
  EXPECT_NEAR(down.force.z(), weight, 1e-12);
  EXPECT_NEAR(down.torque.y(), -0.01 * weight, 1e-12);
  const Wrench aside = sag.weight(rotation_exp(Vec3(0, 90 * kDeg, 0)));
  EXPECT_NEAR(aside.force.x(), weight, 1e-12) << "X points down";
  EXPECT_NEAR(aside.torque.y(), -0.05 * weight, 1e-12);
}

TEST(GravitySag, TheWorldShowsSagAndWeight) {
  const Simulate list{{two_kilograms()}};
  ASSERT_TRUE(World::is_needed(list));
  World world(list, ArmGeometry(), kHome);
  world.step(kHome, 1e-3);
  const JointVector q = kHome + GravitySag(list.find<GravitySpec>()).bend(ArmGeometry(), kHome);
  EXPECT_LT((world.tip().p - forward(ArmGeometry(), q).p).norm(), 1e-15);
  EXPECT_LT(world.tip().p.z(), forward(ArmGeometry(), kHome).p.z() - 1e-5);
  EXPECT_NEAR(world.on_sensor().force.norm(), 2.0 * kStandardGravity, 1e-12);
  EXPECT_EQ(world.on_tip().force, Vec3::Zero()) << "touches nothing";
}

TEST(Backlash, TheWorldsTipStaysWhileTheServosCrossThePlay) {
  BacklashSpec spec;
  spec.play.setConstant(0.1 * kDeg);
  World world({{spec}}, ArmGeometry(), kHome);
  JointVector q = kHome;
  q[0] += 0.04 * kDeg;
  world.step(q, 1e-3);
  EXPECT_EQ(world.tip().p, forward(ArmGeometry(), kHome).p);
  q[0] += 1.0 * kDeg;
  world.step(q, 1e-3);
  q[0] -= 0.05 * kDeg;
  EXPECT_LT((world.tip().p - forward(ArmGeometry(), q).p).norm(), 1e-12);
}

}  // namespace
}  // namespace handrail
