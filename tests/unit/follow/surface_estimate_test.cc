// What is known of a surface after it was touched.
#include "server/follow/surface_estimate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/unit/follow/follow_floor.h"

namespace handrail {
namespace {

using test::Floor;

// A point that is pushed into a plane through the origin, its sensor a cycle late.
struct Pressing {
  BumperSettings settings;
  BumperState bumper;
  SurfaceEstimate estimate;
  Vec3 n = Vec3::UnitZ();
  double stiffness = 20e3;
  double height = 0.0;    // of the plane, along n [m]
  double friction = 0.0;  // against the way to +x
  double noise = 0.0;     // [N]
  bool touched = true;    // there is something there
  Vec3 p = Vec3::Zero(), last = Vec3::Zero();
  std::mt19937_64 random{5};

  Pressing() { settings.sensor_lag = 0.0071, settings.stiffest = 1e6; }
  double wobble() {
    return noise == 0.0 ? 0.0 : noise * std::normal_distribution<double>()(random);
  }
  void cycle(const Vec3& to) {
    const double deep = touched ? std::max(0.0, height - n.dot(last)) : 0.0;
    last = p = to;
    BumperInput in;
    in.p_SU = in.p_last = in.p_ST = p;
    in.f_E_S =
        stiffness * deep * (n - friction * Vec3::UnitX()) + Vec3(wobble(), wobble(), wobble());
    (void)bump(settings, in, bumper);
    estimate.step(settings, in, bumper);
  }
  // From 5 mm out straight in to `newtons`, 0.2 s there.
  void press(double newtons, const Vec3& at = Vec3::Zero(), double speed = 0.02) {
    const double bottom = height - newtons / stiffness, step = speed * 0.0071;
    const Vec3 beside = at - at.dot(n) * n;
    for (double h = height + 5e-3; h > bottom; h -= step) cycle(beside + h * n);
    for (int i = 0; i < 28; ++i) cycle(beside + bottom * n);
  }
  const Surface& surface() const { return estimate.surface().value(); }
};

TEST(SurfaceEstimate, NothingIsKnownBeforeATouch) {
  Pressing it;
  for (int i = 0; i < 100; ++i) it.cycle({0, 0, 0.01 - 1e-5 * i});
  EXPECT_FALSE(it.estimate.surface());
}

TEST(SurfaceEstimate, APressFindsPlaceNormalAndStiffness) {
  for (const double k : {1e3, 5e3, 20e3, 60e3, 200e3}) {
    for (const Vec3& n : {Vec3(0, 0, 1), Vec3(0.6, 0, -0.8), Vec3(-0.48, 0.6, 0.64)}) {
      Pressing it;
      it.stiffness = k, it.n = n, it.height = 0.3;
      it.press(40.0, {0.1, 0.2, 0.05}, std::min(0.02, 400.0 / k));  // some readings within it
      EXPECT_LT((it.surface().n_S - n).norm(), kNormalError) << k;
      EXPECT_NEAR(it.surface().stiffness, k, 0.03 * k) << n.transpose();
      EXPECT_NEAR(it.surface().out_of(it.p), -40.0 / k, 2e-5 + 0.03 * 40.0 / k) << k;
    }
  }
}

TEST(SurfaceEstimate, NoiseOfTheForceMakesItLittleStiffer) {
  Pressing it;
  it.noise = it.settings.noise = 1.0;
  it.press(45.0);
  EXPECT_NEAR(it.surface().stiffness, 20e3, 0.25 * 20e3);
  EXPECT_NEAR(it.surface().d, 0.0, 5e-4);
}

TEST(SurfaceEstimate, WhatDoesNotGiveWayIsAsStiffAsIsReckonedWith) {
  Pressing it;
  it.settings.stiffest = 60e3;
  it.stiffness = 1e7;
  it.press(40.0, Vec3::Zero(), 1e-4);
  EXPECT_EQ(it.surface().stiffness, 60e3);
}

TEST(SurfaceEstimate, WhatGivesWayALotIsAsSoftAsTheWireTells) {
  Pressing it;
  it.stiffness = 40.0;
  it.press(30.0, Vec3::Zero(), 0.2);
  EXPECT_EQ(it.surface().stiffness, kSoftestSurface);
}

TEST(SurfaceEstimate, FrictionDoesNotTiltItFurtherThanItsCone) {
  Pressing it;
  it.friction = 0.3;
  it.press(40.0);
  for (int i = 0; i < 50; ++i) it.cycle({1e-4 * i, 0, -2e-3});
  EXPECT_LT(std::acos(it.surface().n_S.z()), 0.30);
  EXPECT_NEAR(it.surface().stiffness, 20e3, 4e3);
  EXPECT_NEAR(it.surface().out_of(it.p), -2e-3, 1e-3);
}

// Held just above what makes a contact: no change of the force tells more.
TEST(SurfaceEstimate, WhatIsPressedLittleMoreThanAContactNeedsIsKnownAtOnce) {
  for (const double k : {500.0, 1e3, 5e3}) {
    for (const double left : {0.0, 3.0}) {  // of a payload, along the normal [N]
      Pressing it;
      it.stiffness = k;
      it.height = left / k;
      for (int i = 0; i < 3; ++i) it.cycle({0, 0, 0});
      it.press(it.settings.contact + 1.5, Vec3::Zero(), 1.0 / k);
      ASSERT_TRUE(it.estimate.surface()) << k;
      EXPECT_NEAR(it.surface().stiffness, k, 0.1 * k) << left;
      EXPECT_NEAR(it.surface().d, it.height, 0.1 * 12.0 / k) << k;
    }
  }
}

// The arm may have been moved meanwhile: where little was felt before says nothing.
TEST(SurfaceEstimate, ForgottenAndInContactElsewhereItIsNoFurtherOutThanTheTip) {
  Pressing it;
  it.press(40.0);
  it.estimate.forget();
  it.bumper = BumperState();
  it.height = -0.1;
  const Vec3 there = it.last = Vec3(0, 0, it.height - 40.0 / it.stiffness);
  for (int i = 0; i < 5; ++i) it.cycle(there);
  EXPECT_NEAR(it.surface().out_of(there), 0.0, 1e-4);
}

TEST(SurfaceEstimate, ASlideWhoseForceChangesDoesNotTellOfTheStiffness) {
  for (const double change : {-5.0, 5.0}) {
    Pressing it;
    it.friction = 0.3;
    it.press(40.0);
    const double k = it.surface().stiffness;
    ASSERT_GT(std::acos(it.surface().n_S.z()), 0.2);  // a part of what follows looks like depth
    for (int i = 0; i < 56; ++i) {
      it.cycle({20e-3 * i / 56, 0, -(40.0 + change * i / 56) / it.stiffness});
    }
    EXPECT_EQ(it.surface().stiffness, k) << change;
  }
}

TEST(SurfaceEstimate, FrictionThatComesAndGoesDoesNotTellOfTheStiffness) {
  Pressing it;
  it.friction = 0.3;
  it.press(40.0);
  const double k = it.surface().stiffness;
  const Vec3 at = it.p;
  for (const double friction : {0.0, 0.3, -0.25, 0.0}) {
    it.friction = friction;
    for (int i = 0; i < 5; ++i) it.cycle(at);
    EXPECT_NEAR(it.surface().stiffness, k, 1e-9 * k) << friction;
  }
}

TEST(SurfaceEstimate, ItIsKeptInFreeSpaceNearbyAndForgottenFurther) {
  Pressing it;
  it.press(30.0);
  it.cycle({0, 0, 0});
  const Surface before = it.surface();
  for (double h = 0.0; h < 0.045; h += 5e-4) it.cycle({0, 0, h});
  ASSERT_TRUE(it.estimate.surface());
  EXPECT_EQ(it.surface(), before);
  for (double h = 0.045; h < 0.055; h += 5e-4) it.cycle({0, 0, h});
  EXPECT_FALSE(it.estimate.surface());
}

TEST(SurfaceEstimate, ItIsForgottenBesideItToo) {
  Pressing it;
  it.press(30.0);
  for (double h = 0.0; h < 2e-3; h += 1e-4) it.cycle({0, 0, h});
  for (double x = 0.0; x < 0.045; x += 5e-4) it.cycle({x, 0, 2e-3});
  EXPECT_TRUE(it.estimate.surface());
  for (double x = 0.045; x < 0.055; x += 5e-4) it.cycle({x, 0, 2e-3});
  EXPECT_FALSE(it.estimate.surface());
}

TEST(SurfaceEstimate, ASecondTouchOfTheSameKeepsWhatIsKnown) {
  Pressing it;
  it.stiffness = 2e3;
  it.press(40.0);
  const double k = it.surface().stiffness;
  for (double h = 0.0; h < 6e-3; h += 1e-4) it.cycle({0, 0, h});
  // To 12 N, which would not say much by itself.
  it.press(12.0, Vec3::Zero(), 0.05);
  EXPECT_NEAR(it.surface().stiffness, k, 0.05 * k);
  EXPECT_NEAR(it.surface().d, 0.0, 2e-4);
}

TEST(SurfaceEstimate, AContactElsewhereTakesItsPlace) {
  Pressing it;
  it.stiffness = 2e3;
  it.press(40.0);
  for (double h = 0.0; h < 0.03; h += 2e-4) it.cycle({0, 0, h});
  it.height = 0.02, it.stiffness = 50e3;
  it.press(40.0);
  EXPECT_NEAR(it.surface().d, 0.02, 1e-4);
  EXPECT_NEAR(it.surface().stiffness, 50e3, 2e3);
}

TEST(SurfaceEstimate, AContactThatPointsElsewhereTakesItsPlace) {
  Pressing it;
  it.stiffness = 2e3;
  it.press(40.0);
  for (double h = 0.0; h < 5e-3; h += 2e-4) it.cycle({0, 0, h});
  for (int i = 0; i < 300; ++i) it.cycle({0, 0, 5e-3});  // long enough to be free again
  it.n = {-1, 0, 0}, it.height = -2e-3, it.stiffness = 30e3;
  it.press(40.0, {0, 0, 5e-3});
  EXPECT_LT((it.surface().n_S - it.n).norm(), 1e-3);
  EXPECT_NEAR(it.surface().stiffness, 30e3, 1e3);
}

TEST(SurfaceEstimate, WhatIsNotFeltWhereItShouldBeIsForgotten) {
  Pressing it;
  it.press(30.0);
  for (double h = 0.0; h < 3e-3; h += 1e-4) it.cycle({0, 0, h});
  it.touched = false;
  for (double h = 3e-3; h > 0.0; h -= 1e-4) it.cycle({0, 0, h});
  ASSERT_TRUE(it.estimate.surface());
  for (double h = 0.0; h > -3e-3; h -= 1e-4) it.cycle({0, 0, h});
  EXPECT_FALSE(it.estimate.surface());
}

TEST(SurfaceEstimate, ReadingsThatAreNoNewsOrNoNumbersChangeNothing) {
  Pressing it;
  it.press(30.0);
  const Surface before = it.surface();
  BumperInput in;
  in.f_E_S = {0, 0, 45.0};
  in.fresh = false;
  it.estimate.step(it.settings, in, it.bumper);
  in.fresh = true;
  in.f_E_S.x() = std::numeric_limits<double>::quiet_NaN();
  it.estimate.step(it.settings, in, it.bumper);
  EXPECT_EQ(it.surface(), before);
}

TEST(SurfaceEstimate, TheSlaveTellsTheFloorThatItTouches) {
  Floor it(20e3);
  for (int i = 0; i < 300; ++i) it.down(0.01, 1.5e-3);
  ASSERT_TRUE(it.rig.out.link.surface);
  const Surface& floor = *it.rig.out.link.surface;
  EXPECT_LT((floor.n_S - Vec3::UnitZ()).norm(), 1e-3);
  EXPECT_NEAR(floor.out_of({it.X.p.x(), it.X.p.y(), it.surface}), 0.0, 1e-4);
  EXPECT_NEAR(floor.stiffness, 20e3, 3e3);
}

TEST(SurfaceEstimate, TheSlaveForgetsItWithTheSensorOrWithTheEngagement) {
  for (const bool sensor : {true, false}) {
    Floor it(20e3);
    for (int i = 0; i < 300; ++i) it.down(0.01, 1.5e-3);
    ASSERT_TRUE(it.rig.out.link.surface);
    it.rig.in.wrench_valid = !sensor;
    if (!sensor) it.rig.in.master.desired = Desired::kOff;
    if (!sensor) it.rig.in.master.state = SessionState::kOff;
    for (int i = 0; i < 20; ++i) it.cycle();
    EXPECT_FALSE(it.rig.out.link.surface) << sensor;
  }
}

TEST(SurfaceEstimate, ThePublishedBumperTellsOfNone) {
  Floor it(20e3);
  it.rig.settings.bumper.form = BumperSettings::Form::kPublished;
  for (int i = 0; i < 300; ++i) it.down(0.01, 1.5e-3);
  EXPECT_GT(it.rig.out.link.f_E_S.force.z(), 15.0);
  EXPECT_FALSE(it.rig.out.link.surface);
}

}  // namespace
}  // namespace handrail
