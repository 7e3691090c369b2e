#include "server/motion/jerk_law.h"

#include <gtest/gtest.h>

#include "server/base/random.h"
#include "tests/unit/motion/motion_rig.h"

namespace handrail {
namespace {

using test::between;

// Acceleration is 1 in these tests: every law scales.
AxisLimits any_limits(Random& random, double quickest = 0.25) {
  return {between(random, 2.0, 60.0), 1.0, 1.0 / between(random, quickest, 12.5)};
}

struct Stop {
  double furthest = 0.0;  // in the positive direction
  double peak = 0.0;      // largest |v| passed through
  double change = 0.0;    // largest |a|
  double jerk = 0.0;      // largest change of a
  int cycles = 0;
  double v = 0.0, a = 0.0;  // left at the end
};

Stop roll_out(const AxisLimits& limits, double v, double a) {
  Stop out;
  double x = 0.0;
  out.peak = std::abs(v);
  while (out.cycles < 500 && (v != 0.0 || a != 0.0)) {
    const double next = stop_change(limits, v, a);
    out.change = std::max(out.change, std::abs(next));
    out.jerk = std::max(out.jerk, std::abs(next - a));
    a = next;
    v += a;
    x += v;
    out.furthest = std::max(out.furthest, x);
    out.peak = std::max(out.peak, std::abs(v));
    ++out.cycles;
  }
  out.v = v;
  out.a = a;
  return out;
}

TEST(JerkLaw, ARampIsTheSumOfItsChangesAndItsInverseFindsThem) {
  for (const double j : {0.1, 0.5, 1.0}) {
    for (double y = 0.0; y < 6.0; y += 0.017) {
      double sum = 0.0;
      for (double rest = y; rest > 0.0; rest -= j) sum += rest;
      ASSERT_NEAR(ramp(y, j), sum, 1e-12);
      ASSERT_NEAR(ramp_inverse(sum, j), y, 1e-12);
    }
  }
  EXPECT_EQ(ramp(-1.0, 0.5), 0.0);
  EXPECT_EQ(ramp_inverse(-1.0, 0.5), 0.0);
}

TEST(JerkLaw, AStopEndsExactlyAtRestWithinEveryLimitAndInTime) {
  Random random(3);
  for (int i = 0; i < 100000; ++i) {
    const AxisLimits l = any_limits(random, 1.0);
    const double v = between(random, -l.speed, l.speed), a = between(random, -1.0, 1.0);
    const Stop stop = roll_out(l, v, a);
    ASSERT_EQ(stop.v, 0.0);
    ASSERT_EQ(stop.a, 0.0);
    ASSERT_LE(stop.change, 1.0 + 1e-12);
    ASSERT_LE(stop.jerk, l.jerk * (1.0 + 1e-12));
    // v/a + 2.5 a/j, rounded up to cycles; in the last one it stands.
    ASSERT_LT(stop.cycles - 1, std::abs(v) + 2.5 / l.jerk + 1.0) << v << " " << a << " " << l.jerk;
  }
}

TEST(JerkLaw, TheBoundOnAStopsReachIsNeverShort) {
  Random random(4);
  double longest = 0.0, excess = 0.0;
  for (int i = 0; i < 300000; ++i) {
    const AxisLimits l = any_limits(random);
    const double speed = i % 3 == 0 ? 3.0 : l.speed;
    const double v = between(random, -speed, speed), a = between(random, -1.0, 1.0);
    const double bound = stop_reach(l, v, a), exact = roll_out(l, v, a).furthest;
    ASSERT_GE(bound, exact - 1e-12) << "v " << v << " a " << a << " j " << l.jerk;
    const double fastest = std::abs(v) + 0.5 * a * a / l.jerk;
    ASSERT_GE(stop_reach_at_most(l, fastest), bound) << v << " " << a << " " << l.jerk;
    longest += exact;
    excess += bound - exact;
  }
  EXPECT_LT(excess, 0.05 * longest);
}

TEST(JerkLaw, ThePeakOfAStopIsExact) {
  Random random(5);
  for (int i = 0; i < 100000; ++i) {
    const AxisLimits l = any_limits(random);
    const double v = between(random, -3.0, 3.0), a = between(random, -1.0, 1.0);
    ASSERT_NEAR(stop_peak(l, v, a), roll_out(l, v, a).peak, 1e-12);
  }
}

TEST(JerkLaw, TrackingArrivesAndNeverPassesATarget) {
  Random random(6);
  for (int run = 0; run < 2000; ++run) {
    const AxisLimits l = any_limits(random);
    AxisState s;
    const double target = between(random, -200.0, 200.0);
    for (int i = 0; i < 600; ++i) {
      const double a = track_change(l, s, target);
      ASSERT_LE(std::abs(a), 1.0 + 1e-12);
      ASSERT_LE(std::abs(a - s.a), l.jerk * (1.0 + 1e-12));
      s.a = a;
      s.v += a;
      s.x += s.v;
      ASSERT_LE(std::abs(s.v), l.speed * (1.0 + 1e-12));
      ASSERT_LE(std::abs(s.x), std::abs(target) + 1e-9);
    }
    ASSERT_NEAR(s.x, target, 1e-6) << "a/j " << 1.0 / l.jerk << " speed " << l.speed;
  }
}

TEST(JerkLaw, ATargetThatJumpsBehindIsComeBackTo) {
  Random random(7);
  for (int run = 0; run < 1000; ++run) {
    const AxisLimits l = any_limits(random);
    AxisState s;
    for (int leg = 0; leg < 4; ++leg) {
      const double target = between(random, -100.0, 100.0);
      const int cycles = leg == 3 ? 800 : 20;
      for (int i = 0; i < cycles; ++i) {
        s.a = track_change(l, s, target);
        s.v += s.a;
        s.x += s.v;
      }
      if (leg == 3) {
        ASSERT_NEAR(s.x, target, 1e-6);
      }
    }
  }
}

TEST(JerkLaw, ASpeedAboveALoweredLimitIsSlowedToIt) {
  AxisLimits l{20.0, 1.0, 0.35};
  AxisState s;
  for (int i = 0; i < 60; ++i) {
    s.a = track_change(l, s, 1e6);
    s.v += s.a;
    s.x += s.v;
  }
  EXPECT_NEAR(s.v, 20.0, 1e-9);
  l.speed = 5.0;
  for (int i = 0; i < 60; ++i) {
    s.a = track_change(l, s, 1e6);
    s.v += s.a;
    s.x += s.v;
  }
  EXPECT_NEAR(s.v, 5.0, 1e-9);
  EXPECT_EQ(s.a, 0.0);
}

}  // namespace
}  // namespace handrail
