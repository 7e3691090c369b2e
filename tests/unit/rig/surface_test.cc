// Boxes and cylinders.
#include <gtest/gtest.h>

#include <cmath>

#include "devices/rig/world/box.h"
#include "devices/rig/world/cylinder.h"
#include "server/base/units.h"
#include "tests/unit/rig/probe.h"

namespace handrail {
namespace {

using test::Probe;

constexpr double kSeries = 1.0 / (1.0 / 60e3 + 1e-6);  // of the probe's arm and a wall [N/m]

// Upper face at z = 0, 20 mm x 40 mm, 10 mm high.
BoxSpec brick() {
  BoxSpec box;
  box.X_SB.p = Vec3(0, 0, -0.005);
  box.half = Vec3(0.010, 0.020, 0.005);
  box.surface = test::smooth();
  return box;
}

TEST(Box, EveryFacePushesOutward) {
  const Vec3 middle = brick().X_SB.p;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      const Vec3 n = side * Vec3::Unit(axis);
      Probe probe(Box(brick()), middle + n * 0.03);
      const Vec3 f = probe.along(middle + n * (brick().half[axis] - 1e-3));
      EXPECT_NEAR(f.dot(n), kSeries * 1e-3, 1e-6);
      EXPECT_NEAR(f.norm(), f.dot(n), 1e-9);
    }
  }
}

TEST(Box, TurnsWithItsAxes) {
  BoxSpec turned = brick();
  turned.X_SB.q = rotation_exp(Vec3(0, 0, 90 * kDeg));
  Probe probe(Box(turned), Vec3(0.03, 0, -0.005));
  EXPECT_EQ(probe.along(Vec3(0.0205, 0, -0.005)), Vec3::Zero());
  EXPECT_NEAR(probe.along(Vec3(0.019, 0, -0.005)).x(), kSeries * 1e-3, 1e-6);
}

TEST(Box, ATipThatPassesBesideItTouchesNothing) {
  Probe probe(Box(brick()), Vec3(0.011, 0, 0.010));
  EXPECT_EQ(probe.along(Vec3(0.011, 0, -0.030)), Vec3::Zero());
  Probe low(Box(brick()), Vec3(0.030, 0, 0.001));
  EXPECT_GT(low.to(Vec3(0.005, 0, -0.001)).x(), 0.0) << "below the top before it is at the side";
  Probe steep(Box(brick()), Vec3(0.011, 0, 0.020));
  EXPECT_GT(steep.to(Vec3(0.009, 0, -0.002)).z(), 0.0) << "above the top until it is inside";
}

TEST(Box, ATipThatSlidesOverTheEdgeIsFreeAndMeetsTheSideOnTheWayBack) {
  Probe probe(Box(brick()), Vec3(0, 0, 0.001));
  probe.along(Vec3(0.0099, 0, -1e-3));
  EXPECT_NEAR(probe.force().z(), kSeries * 1e-3, 1e-6);
  EXPECT_EQ(probe.along(Vec3(0.0101, 0, -1e-3)), Vec3::Zero());
  const Vec3 f = probe.along(Vec3(0.0095, 0, -1e-3));
  EXPECT_NEAR(f.x(), kSeries * 0.5e-3, 1e-6);
  EXPECT_NEAR(f.z(), 0.0, 1e-9);
}

TEST(Box, AJumpIntoADeepPlaceStillPushesOutWhereItCameIn) {
  Probe probe(Box(brick()), Vec3(0, 0, 0.001));
  EXPECT_GT(probe.to(Vec3(0, 0, -0.009)).z(), 0.0) << "though the lower face is nearer";
  probe.rest(100);
  EXPECT_GT(probe.force().z(), 0.0);
}

CylinderSpec round_bar() {
  CylinderSpec bar;
  bar.radius = 0.010;
  bar.half_length = 0.030;
  bar.surface = test::smooth();
  return bar;
}

TEST(Cylinder, ItsSidePushesAwayFromTheAxisWhereverTheTipSlidesTo) {
  Probe probe(Cylinder(round_bar()), Vec3(0.02, 0, 0));
  for (int i = 0; i <= 360; ++i) {
    const double a = i * kDeg;
    probe.along(Vec3(0.009 * std::cos(a), 0.009 * std::sin(a), 0.01), 1e-4);
    probe.rest(20);
    const Vec3 out(std::cos(a), std::sin(a), 0);
    EXPECT_NEAR(probe.force().dot(out), kSeries * 1e-3, 1e-3) << i;
    EXPECT_NEAR(probe.force().norm(), probe.force().dot(out), 1e-3) << i;
  }
}

TEST(Cylinder, ItsEndsPushAlongTheAxis) {
  Probe top(Cylinder(round_bar()), Vec3(0.005, 0, 0.04));
  EXPECT_NEAR(top.along(Vec3(0.005, 0, 0.029)).z(), kSeries * 1e-3, 1e-6);
  Probe bottom(Cylinder(round_bar()), Vec3(0.005, 0, -0.04));
  EXPECT_NEAR(bottom.along(Vec3(0.005, 0, -0.029)).z(), -kSeries * 1e-3, 1e-6);
  Probe beside(Cylinder(round_bar()), Vec3(0.011, 0, 0.04));
  EXPECT_EQ(beside.along(Vec3(0.011, 0, -0.04)), Vec3::Zero());
}

CylinderSpec bore(double radius) {
  CylinderSpec hole = round_bar();
  hole.radius = radius;
  hole.hole = true;
  return hole;
}

TEST(Cylinder, ATubeHoldsTheTipInside) {
  Probe probe(Cylinder(bore(0.010)), Vec3(0, 0, 0.04));
  EXPECT_EQ(probe.along(Vec3(0, 0, 0)), Vec3::Zero());
  EXPECT_EQ(probe.along(Vec3(0.0099, 0, 0)), Vec3::Zero());
  EXPECT_NEAR(probe.along(Vec3(0.011, 0, 0)).x(), -kSeries * 1e-3, 1e-6);
  EXPECT_EQ(probe.along(Vec3(0.0, 0, -0.04)), Vec3::Zero()) << "open at the other end";
}

TEST(Cylinder, ATubeIsEnteredThroughItsEndsOnly) {
  Probe probe(Cylinder(bore(0.010)), Vec3(0.02, 0, 0.04));
  EXPECT_EQ(probe.along(Vec3(0.02, 0, 0)), Vec3::Zero());
}

TEST(Cylinder, ATightHoleHoldsATipPulledFarAsideWithoutSwinging) {
  constexpr double kRadius = 0.05e-3;
  Probe probe(Cylinder(bore(kRadius)), Vec3(0, 0, 0.04));
  probe.along(Vec3(0, 0, 0), 1e-4);
  Vec3 last = probe.along(Vec3(3e-3, 0, 0));
  for (int i = 0; i <= 720; ++i) {
    const double a = 0.5 * i * kDeg;
    const Vec3 out(std::cos(a), std::sin(a), 0);
    const Vec3 f = probe.to(3e-3 * out);
    EXPECT_NEAR(f.dot(out), -kSeries * (3e-3 - kRadius), 0.5) << i;
    EXPECT_LT((f - last).norm(), 2.0 * kSeries * 3e-3 * 0.5 * kDeg) << i;
    last = f;
  }
}

}  // namespace
}  // namespace handrail
