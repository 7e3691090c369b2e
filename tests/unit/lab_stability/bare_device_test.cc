#include "server/lab/stability/bare_device.h"

#include <gtest/gtest.h>

#include <cmath>

namespace handrail {
namespace {

TEST(BareDevice, UnderAHeldForceAFreeMassMovesAsNewtonSays) {
  BareDevice device({0.1, 0.0, 0.0}, {}, {0.01, 0.0});
  device.kick({0.0, 0.2});
  for (int i = 0; i < 50; ++i) device.advance(1e-3, {0.3, 0.0});
  EXPECT_NEAR(device.position().x(), 0.01 + 0.5 * 3.0 * 0.05 * 0.05, 1e-15);
  EXPECT_NEAR(device.position().y(), 0.2 * 0.05, 1e-15);
  EXPECT_NEAR(device.velocity().x(), 3.0 * 0.05, 1e-14);
  EXPECT_NEAR(device.given(), 0.5 * 0.1 * 0.15 * 0.15, 1e-15);
  EXPECT_EQ(device.lost(), 0.0);
}

TEST(BareDevice, InAGripItSwingsAsTheClosedFormSays) {
  const double mass = 0.3, damping = 2.0, stiffness = 400.0;
  BareDevice device({0.2, 1.0, 0.0}, {0.1, 1.0, stiffness, Vec2::Zero()}, Vec2::Zero());
  device.kick({0.5, 0.0});
  for (int i = 0; i < 137; ++i) device.advance(1.3e-3, Vec2::Zero());
  const double t = 137 * 1.3e-3, s = 0.5 * damping / mass;
  const double w = std::sqrt(stiffness / mass - s * s);
  EXPECT_NEAR(device.position().x(), 0.5 / w * std::exp(-s * t) * std::sin(w * t), 1e-13);
}

TEST(BareDevice, FrictionEndsASlideWhereItsEnergyIsUsedUp) {
  BareDevice device({0.05, 0.0, 0.26}, {}, Vec2::Zero());
  const Vec2 kick(0.3, -0.4);
  device.kick(kick);
  for (int i = 0; i < 200; ++i) device.advance(1e-3, Vec2::Zero());
  const double energy = 0.5 * 0.05 * 0.25;
  EXPECT_EQ(device.velocity(), Vec2::Zero());
  EXPECT_NEAR(device.position().norm(), energy / 0.26, 1e-12);
  EXPECT_NEAR(device.position().normalized().dot(kick.normalized()), 1.0, 1e-12);
  EXPECT_NEAR(device.lost(), energy, 1e-12);
}

TEST(BareDevice, WhatStandsStaysUntilItIsPushedHarderThanFriction) {
  BareDevice device({0.05, 0.0, 0.26}, {}, Vec2::Zero());
  for (int i = 0; i < 100; ++i) device.advance(1e-3, {0.2, 0.16});
  EXPECT_EQ(device.position(), Vec2::Zero());
  for (int i = 0; i < 100; ++i) device.advance(1e-3, {0.24, 0.18});
  EXPECT_NEAR(device.velocity().norm(), (0.30 - 0.26) / 0.05 * 0.1, 1e-12);
}

TEST(BareDevice, WorkLossesAndItsOwnEnergyAddUp) {
  BareDevice device({0.1, 0.7, 0.2}, {0.1, 0.0, 300.0, {0.5, 0.1}}, {0.02, 0.0});
  device.kick({0.3, 0.2});
  const double before = device.energy();
  for (int i = 0; i < 500; ++i) device.advance(1e-3, -900.0 * device.position());
  EXPECT_GT(device.lost(), 1e-3);
  EXPECT_NEAR(device.energy() - before, device.given() - device.lost(), 1e-12);
}

TEST(BareDevice, OfDampingTheDevicesShareAloneCountsAsItsLoss) {
  BareDevice device({0.1, 1.0, 0.0}, {0.1, 3.0, 0.0, Vec2::Zero()}, Vec2::Zero());
  device.kick({0.5, 0.0});
  for (int i = 0; i < 2000; ++i) device.advance(1e-3, Vec2::Zero());
  EXPECT_NEAR(device.lost(), 0.25 * 0.5 * 0.2 * 0.25, 1e-12);
}

TEST(BareDevice, AMotionThatTurnsDoesNotDependOnTheStep) {
  const DeviceBody body{0.1, 0.1, 0.2};
  const PassiveGrip grip{.push = {0.1, 0.0}};
  BareDevice coarse(body, grip, Vec2::Zero());
  BareDevice fine(body, grip, Vec2::Zero(), 0.01 * BareDevice::kStep);
  double apart = 0.0;
  for (BareDevice* device : {&coarse, &fine}) device->kick({0.5, 0.3});
  for (int i = 0; i < 300; ++i) {
    for (BareDevice* device : {&coarse, &fine}) device->advance(1e-3, -800.0 * device->position());
    apart = std::max(apart, (coarse.position() - fine.position()).norm());
  }
  EXPECT_LT(apart, BareDevice::kFinerMoves);
  EXPECT_GT(coarse.lost(), 1e-3);
}

TEST(Encoder, GivesCountsAndTheirDifference) {
  Encoder raw(0.1e-3, 0.0);
  raw.read({1.04e-3, -0.26e-3}, 1e-3);
  EXPECT_TRUE(raw.position().isApprox(Vec2(1.0e-3, -0.3e-3), 1e-12));
  EXPECT_EQ(raw.velocity(), Vec2::Zero()) << "nothing is known of before";
  raw.read({1.26e-3, -0.26e-3}, 2e-3);
  EXPECT_TRUE(raw.velocity().isApprox(Vec2(0.15, 0.0), 1e-9));
}

TEST(Encoder, SmoothsTheVelocityByItsCutoff) {
  Encoder slow(0.0, 30.0);
  for (int i = 0; i <= 5; ++i) slow.read({1e-3 * i, 0.0}, 1e-3);
  EXPECT_NEAR(slow.velocity().x(), 1.0 - std::exp(-2.0 * M_PI * 30.0 * 5e-3), 1e-12);
}

}  // namespace
}  // namespace handrail
