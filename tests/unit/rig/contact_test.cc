#include "devices/rig/world/contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "devices/rig/world/plane.h"
#include "tests/unit/rig/probe.h"

namespace handrail {
namespace {

using test::kStep;
using test::Probe;

Plane floor_of(const SurfaceSpec& surface) { return Plane({Vec3::Zero(), Vec3::UnitZ(), surface}); }

// Several planes at once.
struct Planes {
  std::array<Plane, 2> planes;
  void find(const TipStep& tip, ContactList& out) {
    for (Plane& plane : planes) plane.find(tip, out);
  }
};

TEST(Contact, AStiffWallHoldsWithTheForceOfItsSeriesSpring) {
  for (const double k : {1e3, 60e3, 1e6, 1e9}) {
    Probe probe(floor_of(test::smooth(k)), Vec3(0, 0, 1e-3), 1.0 / 60e3);
    const Vec3 f = probe.along(Vec3(0.002, 0.001, -1e-3));
    EXPECT_NEAR(f.z(), 1e-3 / (1.0 / 60e3 + 1.0 / k), 1e-9 * f.z()) << k;
    EXPECT_NEAR(probe.x().z(), -f.z() / k, 1e-15);
    EXPECT_NEAR(probe.x().x(), 0.002, 1e-15) << "nothing holds it sideways";
  }
}

TEST(Contact, ARigidArmFeelsTheWallAlone) {
  Probe probe(floor_of(test::smooth(1e6)), Vec3(0, 0, 1e-3), 0.0);
  EXPECT_NEAR(probe.along(Vec3(0, 0, -1e-4)).z(), 100.0, 1e-9);
}

TEST(Contact, AThousandMillionNewtonsPerMetreAreAsCalmAsAThousand) {
  constexpr double kArm = 60e3;
  for (const double k : {1e3, 1e5, 1e7, 1e9}) {
    for (const double b : {0.0, 500.0, 1e6}) {
      for (const double mu : {0.0, 0.3, 1.0}) {
        SCOPED_TRACE(testing::Message() << k << " N/m, " << b << " N s/m, friction " << mu);
        Probe probe(floor_of({k, b, mu}), Vec3(0, 0, 1e-3), 1.0 / kArm);
        Vec3 last = Vec3::Zero(), x_last(0, 0, 1e-3);
        for (int i = 0; i < 3000; ++i) {
          const double t = kStep * i;
          const Vec3 x0(1e-3 * std::sin(7 * t), 0, 1e-3 * std::cos(11 * t));
          const Vec3 f = probe.to(x0);
          ASSERT_GE(f.z(), 0.0);
          ASSERT_LE(f.z(), kArm * std::max(0.0, -x0.z()) * (1 + 1e-9)) << "the arm gives no more";
          ASSERT_LE(f.head<2>().norm(), mu * f.z() * (1 + 1e-9) + 1e-12);
          ASSERT_LE((f - last).norm(), 2.0 * kArm * (x0 - x_last).norm());
          last = f;
          x_last = x0;
        }
      }
    }
  }
}

TEST(Contact, FrictionHoldsWithoutCreepAndSlidesAtItsCone) {
  Probe probe(floor_of(test::rough(0.3)), Vec3(0, 0, 1e-3));
  probe.along(Vec3(0, 0, -1e-3));
  const double pressure = probe.force().z();
  const Vec3 held = probe.along(Vec3(1e-4, 0, -1e-3));
  EXPECT_NEAR(held.x(), -1e-4 / (1.0 / 60e3 + 1e-6), 1e-6) << "both springs, in series";
  EXPECT_LT(-held.x(), 0.3 * pressure);
  probe.rest(100'000);
  EXPECT_NEAR(probe.force().x(), held.x(), 1e-9) << "100 s later";
  const Vec3 slid = probe.along(Vec3(3e-3, 4e-3, -1e-3));
  EXPECT_NEAR(slid.head<2>().norm(), 0.3 * slid.z(), 1e-9);
  EXPECT_NEAR(slid.z(), pressure, 1e-6);
  const Vec3 back = probe.along(Vec3(0, 0, -1e-3));
  EXPECT_GT(back.head<2>().dot(Eigen::Vector2d(3, 4)), 0.0) << "against the way back";
  EXPECT_NEAR(back.head<2>().norm(), 0.3 * back.z(), 1e-9);
}

TEST(Contact, FrictionTakesHoldWhereTheTipMetTheSurface) {
  Probe probe(floor_of(test::rough(1.0)), Vec3(0, 0, 1e-3));
  probe.to(Vec3(2e-3, 0, -1e-3));
  EXPECT_NEAR(probe.force().x() / probe.force().z(), -1.0, 1e-9);
  EXPECT_NEAR(probe.x().x(), 1e-3, 1e-4) << "half of the step was in the air";
}

TEST(Contact, ADamperHoldsBackOnTheWayInAndNeverPulls) {
  Probe probe(floor_of({1e4, 1e3, 0.0}), Vec3::Zero(), 0.0);
  EXPECT_NEAR(probe.to(Vec3(0, 0, -1e-4)).z(), 1e4 * 1e-4 + 1e3 * 1e-4 / kStep, 1e-9);
  EXPECT_NEAR(probe.to(Vec3(0, 0, -1e-4)).z(), 1e4 * 1e-4, 1e-9) << "at rest the spring alone";
  EXPECT_EQ(probe.to(Vec3(0, 0, -0.9e-4)), Vec3::Zero()) << "the wall comes out more slowly";
  EXPECT_EQ(probe.to(Vec3(0, 0, 1e-3)), Vec3::Zero());
  EXPECT_GT(probe.work(), 0.0);
}

TEST(Contact, AWallThatCameOutSlowlyIsNotThereYet) {
  // After 1 ms without load it has come out by 1 / (1 + k h / b) only.
  Probe probe(floor_of({1e4, 1e3, 0.0}), Vec3::Zero(), 0.0);
  probe.to(Vec3(0, 0, -1e-3));
  probe.to(Vec3(0, 0, 1e-3));
  const double dent = 1e-3 / 1.01;
  EXPECT_EQ(probe.to(Vec3(0, 0, -0.9 * dent)), Vec3::Zero());
  EXPECT_GT(probe.to(Vec3(0, 0, -1.1 * dent)).z(), 0.0);
}

TEST(Contact, TwoFacesOfAGrooveShareTheLoad) {
  const double c = 1.0 / 60e3, k = 1e6;
  Planes groove{{Plane({Vec3::Zero(), Vec3(1, 0, 1).normalized(), test::smooth(k)}),
                 Plane({Vec3::Zero(), Vec3(-1, 0, 1).normalized(), test::smooth(k)})}};
  Probe probe(groove, Vec3(0, 0, 1e-3), c);
  Vec3 f = probe.along(Vec3(0, 0.001, -1e-3));
  EXPECT_NEAR(f.z(), 1e-3 / (c + 1.0 / k), 0.01);
  EXPECT_NEAR(f.x(), 0.0, 0.01);
  f = probe.along(Vec3(1e-3, 0, -3e-3));
  EXPECT_NEAR(probe.x().x(), (1e-3 + c * f.x()), 1e-12);
  EXPECT_LT(std::abs(probe.x().x()) - probe.x().z(), 3e-4) << "in the groove still";
  EXPECT_LE(probe.rounds(), 4) << "from the last forces it is near";
}

TEST(Contact, AStepOfAnyLengthAtRestChangesNothing) {
  Probe probe(floor_of({1e6, 500.0, 0.3}), Vec3(0, 0, 1e-3));
  probe.along(Vec3(1e-3, 0, -1e-3));
  probe.rest();
  const Vec3 f = probe.force();
  for (const double h : {1e-6, 1e-3, 0.5, 60.0}) {
    EXPECT_LT((probe.to(Vec3(1e-3, 0, -1e-3), h) - f).norm(), 1e-6) << h;
  }
}

TEST(Contact, AGripHoldsEitherWayUpToItsForce) {
  Contact grip;
  grip.grip = 20.0;
  grip.law = test::smooth(1e6);
  const Mat3 C = 1e-4 * Mat3::Identity();
  ContactList list;
  list.add(grip);
  EXPECT_NEAR(solve_contacts(list, Vec3::Zero(), Vec3(0, 0, 1e-3), C, kStep).force.z(),
              -1e-3 / (1e-4 + 1e-6), 1e-9);
  EXPECT_NEAR(solve_contacts(list, Vec3::Zero(), Vec3(0, 0, -1e-3), C, kStep).force.z(),
              1e-3 / (1e-4 + 1e-6), 1e-9);
  EXPECT_NEAR(solve_contacts(list, Vec3::Zero(), Vec3(0, 0, 1e-2), C, kStep).force.z(), -20.0,
              1e-9);
  const double back = solve_contacts(list, Vec3::Zero(), Vec3(0, 0, 9e-3), C, kStep).force.z();
  EXPECT_NEAR(back, -20.0 + 1e-3 / (1e-4 + 1e-6), 1e-6) << "it had slipped along";
}

}  // namespace
}  // namespace handrail
