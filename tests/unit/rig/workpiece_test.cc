// Another workpiece while the rig runs: what changes, what does not, what is refused.
#include <gtest/gtest.h>

#include "devices/rig/rig.h"
#include "server/kinematics/arm_of.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

const Vec3 kTip = forward(ArmGeometry(), ServoArmOptions::default_start()).p;

Workpiece with(RigEffectSpec effect) {
  Workpiece out;
  out.world.emplace();
  out.world->effects = {ArmComplianceSpec(), std::move(effect)};
  return out;
}
PlaneSpec floor_at(double height) {
  PlaneSpec out;
  out.at = kTip + Vec3(0.0, 0.0, height);
  out.normal = Vec3::UnitZ();
  return out;
}
HexSocketSpec socket_at(double height) {
  HexSocketSpec out;
  out.X_SK.p = kTip + Vec3(0.0, 0.0, height);
  return out;
}
void run(Rig& rig, Nanos until) {
  while (rig.step(until) != RigEvent::kNone) continue;
}

TEST(RigWorkpiece, TheArmStandsWhereItStood) {
  Rig rig(RigOptions{}, 0);
  run(rig, 50 * kMillisecond);
  const Pose before = rig.true_tip();
  const JointVector joints = rig.controller().arm().joints();
  const Workpiece piece = with(floor_at(-1e-3));
  {
    const test::NoAllocation guard("another workpiece");
    EXPECT_FALSE(rig.play(piece));
  }
  EXPECT_EQ(rig.true_tip().p, before.p);
  EXPECT_EQ(rig.controller().arm().joints(), joints);
  run(rig, 100 * kMillisecond);
  EXPECT_LT((rig.true_tip().p - before.p).norm(), 1e-9);
  EXPECT_EQ(rig.world()->on_tip().force, Vec3::Zero());
  EXPECT_FALSE(rig.play(Workpiece()));
  EXPECT_EQ(rig.world(), nullptr);
  EXPECT_LT((rig.true_tip().p - before.p).norm(), 1e-9);
}

TEST(RigWorkpiece, AMountedTipIsThatOfItsScene) {
  Scene scene;
  scene.X_AT = Pose{Vec3(30e-3, 0.0, 0.0), Quat(Eigen::AngleAxisd(0.5, Vec3::UnitY()))};
  scene.simulate.emplace();
  const Pose X_ST = forward(arm_of(scene), ServoArmOptions::default_start());
  PlaneSpec plane = floor_at(0.0);
  plane.at = X_ST.p - Vec3(0.0, 0.0, 1e-4);
  scene.simulate->effects = {ArmComplianceSpec(), plane};
  const Workpiece piece = workpiece_of(scene);
  World world(*piece.world, piece.geometry, ServoArmOptions::default_start());
  EXPECT_LT((world.untouched() - X_ST.p).norm(), 1e-12);
  for (int i = 0; i < 20; ++i) {
    world.lead({X_ST.p - Vec3(0.0, 0.0, 1e-5 * i), X_ST.q}, 1e-3);
  }
  const Vec3 on_tip = world.on_tip().force;
  ASSERT_GT(on_tip.z(), 1.0);
  const Quat q_SA = X_ST.q * scene.X_AT->q.conjugate();
  EXPECT_LT((world.on_sensor().force - q_SA.conjugate() * on_tip).norm(), 1e-9)
      << "the sensor is turned as the flange";
}

TEST(RigWorkpiece, WhatTheTipWouldBeInsideOfIsRefusedByItsName) {
  Rig rig(RigOptions{}, 0);
  ASSERT_FALSE(rig.play(with(floor_at(-5e-3))));
  const World* before = rig.world();
  BoxSpec box;
  box.X_SB.p = kTip;
  box.half = Vec3(20e-3, 20e-3, 3e-3);
  CylinderSpec cylinder;
  cylinder.at = kTip;
  cylinder.axis = Vec3::UnitZ();
  cylinder.radius = 4e-3;
  cylinder.half_length = 10e-3;
  const std::pair<RigEffectSpec, double> cases[] = {
      {floor_at(2e-3), 2e-3}, {box, 3e-3}, {cylinder, 4e-3}, {socket_at(1e-3), 1e-3}};
  for (const auto& [effect, deep] : cases) {
    const auto inside = rig.play(with(effect));
    ASSERT_TRUE(inside) << name_of(kind_of(effect));
    EXPECT_EQ(inside->what, kind_of(effect));
    EXPECT_NEAR(inside->deep, deep, 1e-9);
    EXPECT_EQ(rig.world(), before) << "the one before stays";
  }
  cylinder.hole = true;
  EXPECT_FALSE(rig.play(with(cylinder))) << "in a tube is not inside of it";
  EXPECT_FALSE(rig.play(with(socket_at(-1e-6)))) << "just above the rim";
}

TEST(RigWorkpiece, ANewOneIsPushedAsTheFirstWouldBe) {
  const auto pushed = [](bool later) {
    RigOptions options;
    const Workpiece piece = with(floor_at(-1e-6));
    if (!later) options.world = piece.world;
    Rig rig(options, 0);
    run(rig, 20 * kMillisecond);
    EXPECT_FALSE(later && rig.play(piece).has_value());
    return rig.world()->tip().p;
  };
  EXPECT_EQ(pushed(true), pushed(false));
}

}  // namespace
}  // namespace handrail
