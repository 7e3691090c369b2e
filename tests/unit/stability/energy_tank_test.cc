#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "server/base/random.h"
#include "server/stability/energy_governor.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

constexpr double kTankTick = 1e-3;     // [s]
constexpr double kTankSpring = 200.0;  // [N/m]

GovernorSettings tank_settings(double friction = 0.0, double damping = 0.0) {
  GovernorSettings out;
  out.on = true;
  out.friction = friction;
  out.damping = damping;
  out.peak = 1e3;
  return out;
}

TEST(EnergyTank, WhateverItsOtherEndDoesTheHandGetsNoMoreThanItGave) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    EnergyTank tank;
    GovernorSettings settings = tank_settings();
    Vec3 tip = Vec3::Zero(), hand = Vec3::Zero(), v = Vec3::Zero(), force = Vec3::Zero();
    double given = 0.0, most_work = 0.0, most_given = 0.0;
    bool cut = false;  // as in a hold
    const auto any = [&random] {
      return Vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
    };
    for (int i = 0; i < 3000; ++i) {
      v += 0.02 * any() - 0.01 * v;
      const Vec3 moved = v * kTankTick;
      hand += moved;
      tip += 2e-4 * any();
      if (random.uniform() < 1e-3) tip += 0.02 * any();
      if (random.uniform() < 1e-2) cut = !cut;
      given += force.dot(moved);
      most_work = std::max(most_work, std::abs(force.dot(moved)));
      most_given = std::max(most_given, given);
      const Vec3 wanted = cut ? Vec3(Vec3::Zero()) : Vec3(200.0 * (tip - hand));
      force = tank.govern(settings, wanted, 200.0, moved, kTankTick).force;
      tank.told(force);
    }
    // A way may turn out other than the one before it, by which the force was made smaller: a
    // tick's work.
    EXPECT_LE(most_given, most_work) << "seed " << seed;
  }
}

// A force that acts late makes energy with a far end that stands, too: pi K A^2 w d in each swing.
TEST(EnergyTank, WhatActsLateIsCountedWhereItActs) {
  for (const int delay : {0, 5, kMostForceDelay}) {
    EnergyTank tank;
    GovernorSettings settings = tank_settings();
    settings.delay = delay;
    ToldForces on_way;
    double given = 0.0, at = 0.0, most_work = 0.0;
    for (int i = 1; i <= 20000; ++i) {
      const double now = 5e-3 * std::sin(2.0 * std::numbers::pi * 2.0 * kTankTick * i);
      const Vec3 moved(now - at, 0.0, 0.0);
      at = now;
      const double work = on_way.acting(delay).dot(moved);
      given += work;
      most_work = std::max(most_work, std::abs(work));
      const Vec3 force =
          tank.govern(settings, Vec3(-kTankSpring * now, 0, 0), kTankSpring, moved, kTankTick)
              .force;
      tank.told(force);
      on_way.add(force);
    }
    // At each turn of the hand what was told before it is still on its way.
    EXPECT_LE(given, (delay + 1) * most_work) << delay;
  }
}

TEST(EnergyTank, AStandingTipIsFeltInFull) {
  EnergyTank tank;
  for (int i = 1; i <= 100; ++i) {
    const Vec3 wanted(-0.2 * 0.1 * i, 0.0, 0.0);
    const Governed out = tank.govern(tank_settings(), wanted, 200.0, Vec3(1e-4, 0, 0), kTankTick);
    ASSERT_EQ(out.force, wanted);
    tank.told(out.force);
  }
  // And gives back what was put in, but for what holding it made.
  Vec3 force(-2.0, 0.0, 0.0);
  double back = 0.0;
  for (int i = 99; i >= 0; --i) {
    back += force.x() * -1e-4;
    force = tank.govern(tank_settings(), Vec3(-0.02 * i, 0, 0), 200.0, Vec3(-1e-4, 0, 0), kTankTick)
                .force;
    tank.told(force);
  }
  EXPECT_NEAR(back, 0.5 * 200.0 * 1e-4, 0.03 * 0.5 * 200.0 * 1e-4);
}

// Nothing is in the spring: the far end has gone by itself. The hand creeps out and turns about.
TEST(EnergyTank, WhatWasBoundedOnTheWayOutComesBackAsTheHandPressesIn) {
  constexpr double kStep = 1e-4;  // of the hand in a tick [m]
  const Vec3 wanted(-2.0, 0.0, 0.0);
  const auto give = [&wanted](EnergyTank& tank, double moved) {
    const Governed out =
        tank.govern(tank_settings(0.2), wanted, kTankSpring, Vec3(moved, 0, 0), kTankTick);
    tank.told(out.force);
    return -out.force.x();
  };
  EnergyTank tank;
  double force = 0.0;
  for (int i = 0; i < 20; ++i) force = give(tank, -kStep);
  EXPECT_NEAR(force, 0.2, 1e-9) << "the device's friction is left";
  EXPECT_NEAR(give(tank, 0.0), force, 1e-9) << "a hand that stands feels the same";
  double pressed = 0.0;
  while (force < 2.0 && pressed < 0.1) {
    const double before = force;
    force = give(tank, kStep);
    pressed += kStep;
    ASSERT_GE(force, before) << pressed;
    ASSERT_LE(force, before + 2.0 * kTankSpring * kStep + 1e-9) << pressed;
  }
  EXPECT_NEAR(pressed, (2.0 - 0.2) / (2.0 * kTankSpring), 1.01 * kStep);
  EXPECT_EQ(give(tank, 0.0), 2.0);
}

// In a hold the spring is cut off, and comes back as it was: nothing of it is lost.
TEST(EnergyTank, WhatWasPutInIsThereAfterACut) {
  constexpr double kStep = 1e-4;  // [m]
  EnergyTank tank;
  const auto give = [&tank](double wanted, double moved) {
    const Governed out =
        tank.govern(tank_settings(), Vec3(wanted, 0, 0), kTankSpring, Vec3(moved, 0, 0), kTankTick);
    tank.told(out.force);
    return out.force.x();
  };
  double force = 0.0, back = 0.0;
  for (int i = 1; i <= 100; ++i) force = give(-kTankSpring * kStep * i, kStep);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(give(0.0, 0.0), 0.0);
  EXPECT_EQ(give(force, 0.0), force);
  for (int i = 99; i >= 0; --i) {
    back += force * -kStep;
    force = give(-kTankSpring * kStep * i, -kStep);
  }
  EXPECT_NEAR(back, 0.5 * kTankSpring * 1e-4, 0.03 * 0.5 * kTankSpring * 1e-4);
}

// The far end goes elsewhere in a hold, while the hand is shaken: what the device takes of that is
// not given to the hand afterwards.
TEST(EnergyTank, WhatTheDeviceTakesInACutIsNotPutIn) {
  constexpr double kStep = 1e-4, kFriction = 0.5;  // [m], [N]
  EnergyTank tank;
  const auto give = [&tank](double wanted, double moved) {
    const Governed out = tank.govern(tank_settings(kFriction), Vec3(wanted, 0, 0), kTankSpring,
                                     Vec3(moved, 0, 0), kTankTick);
    tank.told(out.force);
    return out.force.x();
  };
  for (int i = 1; i <= 10; ++i) give(-kTankSpring * kStep * i, kStep);
  give(0.0, 0.0);
  for (int i = 0; i < 500; ++i) {
    give(0.0, kStep);
    give(0.0, -kStep);
  }
  double force = 0.0, given = 0.0, way = 0.0;
  for (int i = 0; i < 200; ++i) {
    given += force * kStep;
    way += kStep;
    force = give(4.0, kStep);
  }
  // What ten steps put in, friction and all, and what the device takes on the way.
  const double put_in = 0.5 * kTankSpring * std::pow(10 * kStep, 2) + 10 * kFriction * kStep;
  EXPECT_LE(given, put_in + kFriction * way);
  EXPECT_GE(given, 0.9 * kFriction * way) << "and some it is given";
}

TEST(EnergyTank, ABoundedForceKeepsItsDirection) {
  Random random(11);
  EnergyTank tank;
  int bounded = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 wanted(-2.0, 0.3 * std::sin(1e-2 * i), 0.5);
    const Vec3 moved =
        1e-4 * Vec3(random.uniform() - 0.6, random.uniform() - 0.5, random.uniform() - 0.5);
    const Governed out = tank.govern(tank_settings(0.1), wanted, kTankSpring, moved, kTankTick);
    tank.told(out.force);
    bounded += out.acted ? 1 : 0;
    ASSERT_LE(out.force.cross(wanted).norm(), 1e-12) << i;
    ASSERT_GE(out.force.dot(wanted), 0.0) << i;
    ASSERT_LE(out.force.norm(), wanted.norm() * (1.0 + 1e-12)) << i;
  }
  EXPECT_GT(bounded, 100);
}

TEST(EnergyTank, AllocatesNothing) {
  EnergyTank tank;
  const Vec3 push(-1.0, 0.0, 0.0);
  const test::NoAllocation none("tank");
  for (int i = 0; i < 100; ++i) {
    tank.told(tank.govern(tank_settings(), push, kTankSpring, Vec3(1e-4, 0, 0), kTankTick).force);
  }
  EXPECT_EQ(none.allocations(), 0u);
}

// The far end swings by itself and the hand goes with it, slowly, seen in counts: in most ticks it
// does not seem to move.
TEST(EnergyTank, AHandThatMovesByACountNowAndThenIsGivenNoMoreThanItGave) {
  constexpr double kCount = 0.055e-3, kHz = 1.0;
  EnergyTank tank;
  double given = 0.0, at = 0.0, seen = 0.0, most = 0.0;
  Vec3 told = Vec3::Zero();
  for (int i = 1; i <= 5000; ++i) {
    const double phase = 2.0 * std::numbers::pi * kHz * kTankTick * i;
    const double now = -2e-3 * std::cos(phase), read = std::floor(now / kCount) * kCount;
    given += told.x() * (now - at);
    most = std::max(most, std::abs(told.x()));
    const Vec3 wanted(kTankSpring * 5e-3 * std::sin(phase), 0.0, 0.0);
    told =
        tank.govern(tank_settings(), wanted, kTankSpring, {read - seen, 0.0, 0.0}, kTankTick).force;
    tank.told(told);
    at = now;
    seen = read;
  }
  EXPECT_GT(most, 0.0);
  // At each end of a swing it takes two counts to see that the hand turns.
  EXPECT_LT(given, 4.0 * 5e-3 * kTankSpring * kCount);
}

// What the device takes is there once: where a tool has used it the tank is as of a device that
// takes nothing.
TEST(EnergyTank, WhatAGovernorUsedOfTheDevicesLossIsNotPutIn) {
  Random random(23);
  const auto any = [&random] {
    return Vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
  };
  constexpr double kLosing = 0.2, kDamping = 3.0;
  EnergyTank lossless, used_up, lossy;
  Vec3 v = Vec3::Zero(), off = Vec3::Zero();
  int more = 0;
  for (int i = 0; i < 5000; ++i) {
    v += 0.02 * any() - 0.01 * v;
    off += 4e-4 * any() - 0.01 * off;
    const Vec3 moved = v * kTankTick, wanted = kTankSpring * off;
    const double way = moved.norm();
    // Of any way what is taken is at most this.
    const double used = way * (kLosing + kDamping * way / kTankTick);
    const auto give = [&](EnergyTank& tank, const GovernorSettings& settings, double of_it) {
      Vec3 force = tank.govern(settings, wanted, kTankSpring, moved, kTankTick, false, of_it).force;
      tank.told(force);
      return force;
    };
    const Vec3 least = give(lossless, tank_settings(), 0.0);
    ASSERT_EQ(give(used_up, tank_settings(kLosing, kDamping), used * (1.0 + 1e-12)), least) << i;
    more += give(lossy, tank_settings(kLosing, kDamping), 0.0).norm() > least.norm() ? 1 : 0;
  }
  EXPECT_GT(more, 1000) << "what is not used is given";
}

TEST(HandWay, AHandThatIsSeenInCountsLosesAsMuchAsOneThatIsSeenAsItGoes) {
  constexpr double kSpeed = 0.02, kCount = 0.1e-3, kSeconds = 2.0;
  const GovernorSettings settings = tank_settings(0.3, 3.0);
  HandWay fine, coarse;
  double by_way = 0.0, by_counts = 0.0, seen = 0.0;
  for (int i = 1; i * kTankTick <= kSeconds; ++i) {
    const double read = std::floor(kSpeed * kTankTick * i / kCount + 1e-9) * kCount;
    by_way += fine.add(settings, {kSpeed * kTankTick, 0.0, 0.0}, kTankTick);
    by_counts += coarse.add(settings, {read - seen, 0.0, 0.0}, kTankTick);
    seen = read;
  }
  EXPECT_NEAR(by_way, kSeconds * kSpeed * (0.3 + 3.0 * kSpeed), 1e-9);
  EXPECT_NEAR(by_counts, by_way, 0.01 * by_way);
}

// Counts of one axis and of another by turns are longer than the slanted way.
TEST(HandWay, ASlantedWayIsNotLongerThanItIs) {
  const GovernorSettings settings = tank_settings(1.0);
  for (const double slope : {0.2, 0.5, 1.0}) {
    HandWay hand;
    double lost = 0.0;
    Vec3 seen = Vec3::Zero();
    const Vec3 end = 0.01 * Vec3(1.0, slope, 0.0).normalized();
    for (int i = 1; i <= 1000; ++i) {
      const Vec3 read = (end * (i * 1e-3) / 5e-5).array().floor().matrix() * 5e-5;
      lost += hand.add(settings, read - seen, kTankTick);
      seen = read;
    }
    EXPECT_LE(lost, 1.01 * 0.01) << slope;
    EXPECT_GE(lost, 0.5 * 0.01) << slope;
    EXPECT_GT(hand.along().dot(end.normalized()), 0.85) << slope;
  }
}

}  // namespace
}  // namespace handrail
