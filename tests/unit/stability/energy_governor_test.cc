#include "server/stability/energy_governor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/stability/sampled_wall.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTick = 1e-3;  // [s]

GovernorSettings governed(double friction = 0.0, double damping = 0.0) {
  GovernorSettings out;
  out.on = true;
  out.friction = friction;
  out.damping = damping;
  out.peak = 1e3;
  return out;
}

// A wall of x > 0 in springs of `stiffness`, or a spring to x = 0 on both sides, that a governor
// watches; the force of a tick is told as it is.
struct Port {
  GovernorSettings settings;
  double stiffness = 1000.0;
  bool both_sides = false;
  double damping = 0.0;  // rendered, by backward difference [N s/m]
  double warm = 1e9;     // what the device's heat leaves of its peak [N]
  EnergyGovernor governor;
  ToldForces on_way;
  Vec3 last = Vec3::Zero(), force = Vec3::Zero();
  double given = 0.0;    // to the hand [J]
  double used = 0.0;     // for it, of what the device took [J]
  double changed = 0.0;  // sum of |change of the force| [N]
  double asked = 0.0;    // sum of |force| that the law asks for [N]

  double push(double x, double dt = kTick) {
    const Vec3 p(x, 0.0, 0.0), moved = p - last;
    last = p;
    given += on_way.acting(settings.delay).dot(moved);
    RenderedForce law;
    if (both_sides || x > 0.0) {
      law.springs = -stiffness * p;
      law.stiffness = stiffness;
    }
    law.wanted = law.springs - (law.springs.isZero() ? 0.0 : damping / dt) * moved;
    const Governed out = governor.govern(settings, law, moved, dt);
    EXPECT_LE(out.force.norm(), law.wanted.norm() * (1.0 + 1e-12));
    EXPECT_GE(out.force.dot(law.wanted), -1e-12);
    used += out.used;
    changed += (out.force - law.wanted).norm();
    asked += law.wanted.norm();
    const double most = std::min(settings.peak, warm), size = out.force.norm();
    force = size > most ? Vec3(out.force * (most / size)) : out.force;
    governor.told(force);
    on_way.add(force);
    return force.x();
  }
};

// Into the wall and out again, `times` times, as a sine of `amplitude` [m] and `frequency` [Hz].
void swing(Port& port, double amplitude, double frequency, int times) {
  const int ticks = static_cast<int>(std::lround(times / (frequency * kTick)));
  for (int i = 1; i <= ticks; ++i) {
    port.push(amplitude * std::sin(2.0 * std::numbers::pi * frequency * kTick * i));
  }
}

TEST(EnergyGovernor, OffItChangesNothingAndSaysWhatWasMadeByNoOne) {
  Port port;
  port.settings = governed();
  port.settings.on = false;
  port.both_sides = true;
  swing(port, 5e-3, 5.0, 1);
  EXPECT_EQ(port.changed, 0.0);
  // What stability has to say of it.
  EXPECT_NEAR(port.given, energy_per_cycle(1000.0, 5e-3, 5.0, kTick, 0.0), 1e-6);
}

TEST(EnergyGovernor, SeesTheEnergyThatAHeldSpringMakes) {
  // As much friction as takes it up exactly keeps it from acting; nothing is left over then.
  for (const double frequency : {1.0, 2.0, 5.0, 10.0}) {
    Port port;
    port.both_sides = true;
    port.settings = governed();
    port.settings.damping = 0.5 * port.stiffness * kTick * 0.999;
    swing(port, 5e-3, frequency, 4);
    const double made = 4.0 * energy_per_cycle(1000.0, 5e-3, frequency, kTick, 0.0);
    EXPECT_LT(port.governor.made(), 0.01 * made) << frequency;
    EXPECT_GT(port.governor.made(), 0.0) << frequency;
  }
}

// A force that is late by a part of a tick acts for the rest of it; one that missed its tick not at
// all.
TEST(EnergyGovernor, APartOfATickIsReckonedByTheForceThatGoesOnInIt) {
  struct Row {
    int delay;
    double late;
    bool missed;
    double work;  // of the last way [J]
  };
  for (const Row& row :
       {Row{0, 0.0, false, 3e-3}, Row{0, 0.25, false, 2.75e-3}, Row{1, 0.25, false, 1.75e-3},
        Row{0, 0.25, true, 2e-3}, Row{1, 0.0, true, 1e-3}}) {
    EnergyGovernor governor;
    GovernorSettings settings = governed();
    settings.delay = row.delay;
    settings.late = row.late;
    for (const double force : {1.0, 2.0, 3.0}) governor.told(Vec3(force, 0.0, 0.0));
    const double made = governor.govern(settings, {}, Vec3(1e-3, 0.0, 0.0), kTick, row.missed).made;
    EXPECT_NEAR(made, row.work, 1e-15) << row.delay << ", " << row.late << ", " << row.missed;
  }
}

TEST(EnergyGovernor, SeesWhatAForceMakesThatIsLate) {
  for (const int late : {1, 3, 10, kMostForceDelay}) {
    Port port;
    port.both_sides = true;
    port.settings = governed();
    port.settings.delay = late;
    port.settings.damping = (0.5 + late) * port.stiffness * kTick * 0.999;
    swing(port, 5e-3, 1.0, 4);
    const double made = energy_per_cycle(1000.0, 5e-3, 1.0, kTick, late * kTick);
    // At first the forces that are on their way are none.
    EXPECT_NEAR(port.given, 4.0 * made, 0.1 * made) << late;
    EXPECT_LT(port.governor.made(), 0.1 * made) << late;
  }
  Port unsaid;
  unsaid.both_sides = true;
  unsaid.settings = governed();
  unsaid.settings.delay = 3;
  unsaid.settings.damping = 0.5 * unsaid.stiffness * kTick;
  swing(unsaid, 5e-3, 1.0, 4);
  EXPECT_GT(unsaid.changed, 0.0) << "what the delay makes is taken back";
}

// On the way in nothing can be taken back: a quarter of the cycle's is there at its end, less what
// the first forces lack, which are on their way.
TEST(EnergyGovernor, OnTheWayInItCountsALateForceWhereItActs) {
  for (const int late : {1, 3, 10, kMostForceDelay}) {
    Port port;
    port.both_sides = true;
    port.settings = governed();
    port.settings.delay = late;
    for (int i = 1; i <= 250; ++i) {
      port.push(5e-3 * std::sin(2.0 * std::numbers::pi * 1e-3 * i));
    }
    const double made = 0.25 * energy_per_cycle(1000.0, 5e-3, 1.0, kTick, late * kTick);
    EXPECT_NEAR(port.governor.made(), made, 0.15 * made) << late;
  }
}

TEST(EnergyGovernor, WhatTheDeviceTakesUpItLeavesAlone) {
  Port viscous, dry;
  viscous.settings = governed(0.0, 0.5 * viscous.stiffness * kTick * (1.0 + 1e-9));
  dry.settings = governed(0.3);  // K v T / 2 is 0.16 N at most
  for (Port* port : {&viscous, &dry}) {
    for (const bool both : {false, true}) {
      port->both_sides = both;
      swing(*port, 10e-3, 5.0, 20);
    }
    EXPECT_EQ(port->changed, 0.0);
    EXPECT_LT(port->governor.made(), 1e-12);
  }
}

TEST(EnergyGovernor, WithoutAnythingTakenUpTheHandGetsNoMoreThanItGave) {
  for (const double frequency : {0.5, 2.0, 10.0, 30.0}) {
    for (const bool both : {false, true}) {
      Port port;
      port.both_sides = both;
      port.settings = governed();
      swing(port, 10e-3, frequency, 20);
      port.push(0.0);
      // What the ways turned out other than foreseen, once.
      EXPECT_LT(port.given, 0.02 * 0.5 * 1000.0 * 1e-4) << frequency << both;
    }
  }
}

TEST(EnergyGovernor, APressingHandMeetsAllOfTheForce) {
  Port port;
  port.settings = governed();
  for (int i = 0; i <= 1000; ++i) {
    const double x = 1e-5 * i;
    EXPECT_EQ(port.push(x), i == 0 ? 0.0 : -1000.0 * x);
  }
  for (int i = 0; i < 100; ++i) EXPECT_EQ(port.push(10e-3), -10.0);
}

// In whole swings the law's spring gives nothing: what is given was made, and the device took it.
TEST(EnergyGovernor, OfWhatTheDeviceTakesNoMoreIsUsedThanIsMade) {
  constexpr double kSwing = 5e-3, kHz = 2.0;
  const auto swung = [](double damping) {
    Port port;
    port.settings = governed(0.0, damping);
    port.both_sides = true;
    for (int i = 1; i <= 5000; ++i)
      port.push(kSwing * std::sin(2.0 * std::numbers::pi * kHz * kTick * i));
    return port;
  };
  const Port damped = swung(5.0);
  EXPECT_GT(damped.given, 1e-3);
  EXPECT_NEAR(damped.used, damped.given, 1e-3 * damped.given);
  EXPECT_EQ(damped.changed, 0.0);
  EXPECT_EQ(swung(0.0).used, 0.0);
  // What is made and cannot be taken is no more than what there is to take.
  const double way = 2.0 * std::numbers::pi * kHz * kSwing;
  EXPECT_LE(swung(0.1).used, 0.1 * 0.5 * way * way * 5.0);
  EXPECT_GT(swung(0.1).used, 0.09 * 0.5 * way * way * 5.0);
}

// What a slanted way asked for alone would push the hand along the wall.
TEST(EnergyGovernor, AForceThatIsMadeSmallerStaysInItsDirection) {
  constexpr double kStiffness = 1000.0, kCount = 50e-6;  // [N/m], [m]
  EnergyGovernor governor;
  Vec3 at(0.5e-3, 0.0, 0.0), last = at;
  int acted = 0;
  for (int i = 0; i < 2000; ++i) {
    // In counts of an encoder: into the wall and out of it, and along it now and then.
    at.x() = kCount * std::round((0.5e-3 + 0.3e-3 * std::sin(0.01 * i)) / kCount);
    at.y() = kCount * std::round(0.4e-3 * std::cos(0.007 * i) / kCount);
    RenderedForce law;
    law.springs = law.wanted = Vec3(-kStiffness * at.x(), 0.0, 0.0);
    law.stiffness = kStiffness;
    const Governed out = governor.govern(governed(), law, at - last, kTick);
    last = at;
    acted += out.acted;
    EXPECT_EQ(out.force.y(), 0.0) << "tick " << i;
    EXPECT_EQ(out.force.z(), 0.0) << "tick " << i;
    governor.told(out.force);
  }
  EXPECT_GT(acted, 10);
}

// The spring changes with the part of the way along the force alone: at a slant of 1 : 10 by 1 % of
// what it would straight out.
TEST(EnergyGovernor, AHandThatSlidesAlongAWallIsLeftItsForce) {
  constexpr double kStiffness = 1000.0, kDepth = 1e-3;  // [N/m], [m]
  const Vec3 out_and_along = 20e-6 * Vec3(-0.1, 1.0, 0.0).normalized();
  Vec3 at(kDepth, 0.0, 0.0);
  EnergyGovernor governor;
  for (int i = 0; i < 100; ++i) {
    RenderedForce law;
    law.springs = law.wanted = Vec3(-kStiffness * at.x(), 0.0, 0.0);
    law.stiffness = kStiffness;
    const Governed out =
        governor.govern(governed(), law, i > 0 ? out_and_along : Vec3::Zero(), kTick);
    EXPECT_GT(out.force.norm(), 0.99 * law.wanted.norm()) << "tick " << i;
    governor.told(out.force);
    at += out_and_along;
  }
}

TEST(EnergyGovernor, ADampersWorkIsTakenUpToo) {
  Port port;
  port.settings = governed();
  port.damping = 0.6;  // more than K T / 2
  swing(port, 5e-3, 2.0, 20);
  EXPECT_LT(port.changed, 0.01 * port.asked);
}

TEST(EnergyGovernor, AnUnstableWallDoesNotGrow) {
  // A bare mass between the two sides of a spring far beyond its onset of 200 N/m; the motion of a
  // held force is exact: no damping.
  for (const bool on : {false, true}) {
    Port port;
    port.both_sides = true;
    port.stiffness = 3000.0;
    port.settings = governed();
    port.settings.on = on;
    double x = 0.0, v = 0.2, most_late = 0.0;
    for (int i = 0; i < 5000; ++i) {
      const double a = port.push(x) / 0.1;
      x += v * kTick + 0.5 * a * kTick * kTick;
      v += a * kTick;
      if (i >= 4000) most_late = std::max(most_late, std::abs(v));
      if (std::abs(v) > 50.0) break;
    }
    if (on) {
      EXPECT_LT(most_late, 1.01 * 0.2);
    } else {
      EXPECT_GT(std::max(most_late, std::abs(v)), 10.0);
    }
  }
}

TEST(EnergyGovernor, AForceThatWasHeldForLongIsTakenBack) {
  Port port;
  port.settings = governed();
  for (int i = 0; i <= 50; ++i) port.push(1e-4 * i);
  // The loop stood still for 20 ms while the hand was thrown out.
  port.push(1e-3, 0.020);
  EXPECT_GT(port.governor.made(), 5e-3);
  port.push(-1e-3);
  const double before = port.given;
  for (int i = -10; i <= 50; ++i) port.push(1e-4 * i);
  for (int i = 50; i >= -10; --i) port.push(1e-4 * i);
  EXPECT_LT(port.given, before - 5e-3);
}

TEST(EnergyGovernor, AForceAtTheDevicesPeakMakesNothingOfItself) {
  Port port;
  port.settings = governed(0.3);
  port.settings.peak = 3.0;
  swing(port, 20e-3, 2.0, 5);
  EXPECT_LT(port.changed, 1e-9);
}

TEST(EnergyGovernor, NorDoesOneThatHeatHoldsBelowThePeak) {
  Port port;
  port.settings = governed(0.3);
  port.warm = 2.0;
  swing(port, 20e-3, 2.0, 5);
  EXPECT_LT(port.changed, 1e-9);
}

TEST(EnergyGovernor, WhatIsNoNumberCreditsNothing) {
  EnergyGovernor governor;
  const GovernorSettings settings = governed(1e9, 1e9);
  const RenderedForce push{{-1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, 1000.0};
  for (const Vec3& moved : {Vec3(kNan, 0, 0), Vec3(1e9, 0, 0)}) {
    EXPECT_TRUE(is_finite(governor.govern(settings, push, moved, kTick).force));
  }
  for (const double dt : {0.0, -1.0, kNan, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(governor.govern(settings, push, Vec3(1e-4, 0, 0), dt).force, push.wanted);
  }
  const RenderedForce none{{kNan, 0.0, 0.0}, {0.0, 0.0, 0.0}, kNan};
  EXPECT_EQ(governor.govern(settings, none, Vec3(1e-4, 0, 0), kTick).force, Vec3::Zero());
  governor.told({kNan, 0.0, 0.0});
  EXPECT_EQ(governor.made(), 0.0);
}

TEST(EnergyGovernor, AClockThatLeapsBackwardCreditsNoMoreThanAPeriod) {
  Port slow, quick;
  slow.settings = quick.settings = governed(0.0, 0.3);
  for (int i = 0; i <= 40; ++i) {
    slow.push(1e-4 * i, kTick);
    quick.push(1e-4 * i, 1e-6);
  }
  EXPECT_EQ(slow.governor.made(), quick.governor.made());
  EXPECT_GT(slow.governor.made(), 0.0);
}

TEST(EnergyGovernor, AllocatesNothing) {
  EnergyGovernor governor;
  const test::NoAllocation none("governor");
  const RenderedForce push{{-1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, 1000.0};
  for (int i = 0; i < 100; ++i) {
    governor.told(governor.govern(governed(), push, Vec3(1e-4, 0, 0), kTick).force);
  }
  EXPECT_EQ(none.allocations(), 0u);
}

}  // namespace
}  // namespace handrail
