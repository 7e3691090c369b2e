// What is a stuck force sensor, and what is one that has nothing new to tell.
#include "server/follow/stuck_monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "server/base/joints.h"
#include "tests/unit/constraint/tool_samples.h"

namespace handrail {
namespace {

using test::Dice;

constexpr double kStuckCycle = 0.0071;  // [s]
constexpr double kDay = 86400.0;
const Vec3 kPress(0.0, 0.0, 20.0);  // in a contact [N]

// In counts of 1 uN and 1 uNm.
Wrench counted(Wrench f) {
  for (Vec3* v : {&f.force, &f.torque}) *v = (*v * 1e6).array().round() / 1e6;
  return f;
}

Wrench stuck_noise(Dice& dice, const Vec3& force = Vec3::Zero()) {
  return counted({force + dice.within(0.05), dice.within(1e-3)});
}

WrenchReading reading(const Wrench& f, bool still, const Vec3& p_ST = Vec3::Zero()) {
  WrenchReading out;
  out.f_E_T = f;
  out.fresh = true;
  out.still = still;
  out.X_ST.p = p_ST;
  return out;
}

bool judge(StuckMonitor& monitor, const WrenchReading& now) {
  return monitor.judge(BumperSettings(), kStuckCycle, now);
}

// How long a sensor that says `f` for ever is believed, on a tip that goes at `v` [s].
double believed(StuckMonitor& monitor, const Wrench& f, const Vec3& v, bool still = false,
                const BumperSettings& bumper = {}) {
  constexpr int kPatience = 300;
  for (int i = 0; i < kPatience; ++i) {
    if (monitor.judge(bumper, kStuckCycle, reading(f, still, i * kStuckCycle * v)))
      return i * kStuckCycle;
  }
  return 1e9;
}

TEST(StuckMonitor, NoiseThatStopsIsFoundInATenthOfASecondWhateverTheArmDoes) {
  for (const bool moving : {false, true}) {
    Dice dice(1);
    StuckMonitor monitor;
    for (int i = 0; i < 141; ++i) ASSERT_FALSE(judge(monitor, reading(stuck_noise(dice), true)));
    for (int i = 0; i < 50; ++i) {
      ASSERT_FALSE(judge(monitor, reading(stuck_noise(dice, i * Vec3(0, 0, 1)), !moving)));
    }
    EXPECT_LT(believed(monitor, stuck_noise(dice), Vec3::Zero(), !moving), 0.1) << moving;
  }
}

// A sensor that is slow to change, as behind a filter, or whose zero wanders.
TEST(StuckMonitor, NoiseOfAnyColourIsNoise) {
  for (const double kept : {0.0, 0.5, 0.9, 1.0}) {
    int found = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      Dice dice(seed);
      StuckMonitor monitor;
      Wrench f;
      for (int i = 0; i < 280; ++i) {
        f.force = kept * f.force + dice.within(0.05);
        ASSERT_FALSE(judge(monitor, reading(counted(f), true)));
      }
      found += believed(monitor, counted(f), Vec3::Zero()) < 0.1;
    }
    EXPECT_EQ(found, 100) << kept;
  }
}

TEST(StuckMonitor, AnHourOfANoisySensorIsSilent) {
  Dice dice(2);
  StuckMonitor monitor;
  for (int i = 0; i < static_cast<int>(3600.0 / kStuckCycle); ++i) {
    // With contacts that come and go.
    const Vec3 load = i / 1000 % 2 == 0 ? Vec3(0, 0, 40) : Vec3(Vec3::Zero());
    ASSERT_FALSE(judge(monitor, reading(stuck_noise(dice, load), i % 500 < 250))) << i;
  }
}

// An arm of six joints, each behind its own lag and told in 32 bits, presses, slides, leaves and
// rests for as long as it likes, led by a hand that is now steady, now trembles. The sensor reads
// the contact as it is, to the count.
TEST(StuckMonitor, ADayOfContactWithoutNoiseIsSilent) {
  Dice dice(3);
  Eigen::Matrix<double, 3, kJoints> jacobian;
  jacobian << 0.0, 0.1, 0.4, 0.0, 0.1, 0.0,  //
      0.4, 0.0, 0.0, 0.05, 0.0, 0.0,         //
      0.0, -0.4, -0.3, 0.0, 0.1, 0.0;
  const Eigen::Matrix<double, kJoints, 3> back =
      jacobian.transpose() * (jacobian * jacobian.transpose()).inverse();
  JointVector share;  // of the way to the command, a cycle
  for (int j = 0; j < kJoints; ++j)
    share[j] = 1.0 - std::exp(-kStuckCycle / dice.between(0.03, 0.06));
  StuckMonitor monitor;
  JointVector q = JointVector::Zero(), told = q;
  Vec3 goal = Vec3::Zero(), p = goal;
  double speed = 0.05, tremor = 0.0, rest = 0.0;
  std::int64_t changed = 0;
  const auto cycles = static_cast<std::int64_t>(kDay / kStuckCycle);
  for (std::int64_t i = 0; i < cycles; ++i) {
    if (p == goal && (rest -= kStuckCycle) < 0.0) {
      goal = dice.within(5e-3);
      rest = dice.between(0.0, 1.0) < 0.8 ? dice.between(0.0, 2.0) : 20.0;
      speed = dice.between(0.0, 1.0) < 0.5 ? 0.05 : 0.001;
      tremor = dice.between(0.0, 1.0) < 0.3 ? 1e-4 : 0.0;
    }
    const double length = (goal - p).norm(), step = speed * kStuckCycle;
    p = length <= step ? goal : Vec3(p + step / length * (goal - p));
    const Vec3 shaken =
        p + tremor * std::sin(62.8 * kStuckCycle * static_cast<double>(i)) * Vec3(0.5, 0.3, 0.8);
    const JointVector last = told;
    told = (back * shaken).cast<float>().cast<double>();
    q += share.cwiseProduct(told - q);
    const Vec3 tip = jacobian * q;
    const double push = 57e3 * std::max(0.0, -tip.z());
    const Vec3 force(-0.3 * push * std::tanh(1e3 * tip.x()), 0.1 * push, push);
    const WrenchReading now = reading(counted({force, 0.1 * force.cross(tip)}), told == last, tip);
    changed += push > 0.0;
    ASSERT_FALSE(judge(monitor, now)) << i;
  }
  EXPECT_GT(changed, cycles / 10);
}

// Before anybody engages, the arm stands and somebody tries the sensor by hand.
TEST(StuckMonitor, APersonWhoLeansOnASensorWithoutNoiseIsNoNoise) {
  for (const double rate : {1.0, 5.0, 12.0}) {
    StuckMonitor monitor;
    Vec3 f;
    for (int i = 0; i < 1000; ++i) {
      const double t = i * kStuckCycle;
      f = Vec3(1.0, 2.0, 20.0) * (1.5 + std::sin(6.2832 * rate * t) + 0.3 * std::sin(3.0 * t));
      ASSERT_FALSE(judge(monitor, reading(counted({f, Vec3::Zero()}), true)));
    }
    EXPECT_GT(believed(monitor, counted({f, Vec3::Zero()}), Vec3::Zero(), true), 1.0) << rate;
  }
}

TEST(StuckMonitor, AReadingThatStandsStillWhileTheTipGoesInOrOutIsStuck) {
  for (const Vec3& way : {Vec3(0, 0, -1), Vec3(0, 0, 1), Vec3(0.6, 0, -0.8)}) {
    // As fast as a contact is led, and as a surface is left.
    for (const double speed : {0.01, 0.02, 0.1}) {
      StuckMonitor monitor;
      const double found = believed(monitor, {kPress, Vec3::Zero()}, speed * way);
      // From when it has gone half a millimetre into any surface there may be.
      const double gone = 0.55e-3 / speed / (std::abs(way.z()) - 0.3 * std::abs(way.x()));
      EXPECT_LT(found, gone + 0.1) << way.transpose() << " at " << speed;
    }
  }
}

TEST(StuckMonitor, AReadingMayStandWhileTheTipSlidesOrStandsOrTouchesNothing) {
  const BumperSettings bumper;
  const Vec3 along = Vec3(1.0, 0.0, -0.95 * bumper.friction);
  for (const auto& [force, v] : {std::pair<Vec3, Vec3>{kPress, 0.05 * Vec3::UnitX()},
                                 {kPress, 0.05 * along},
                                 {kPress, Vec3::Zero()},
                                 {0.4 * kPress, 0.05 * Vec3::UnitZ()},
                                 {Vec3::Zero(), 0.05 * Vec3::UnitZ()}}) {
    StuckMonitor monitor;
    EXPECT_GT(believed(monitor, {force, Vec3::Zero()}, v), 1.0) << v.transpose();
  }
}

TEST(StuckMonitor, AReadingThatStandsWhileItsPayloadIsTurnedIsStuck) {
  for (const double rate : {0.0, 0.5, 2.0}) {
    StuckMonitor monitor;
    const double weight = 9.8;  // [N]
    double found = 1e9;
    for (int i = 0; i < 300 && found > 1.0; ++i) {
      const double angle = rate * i * kStuckCycle;
      WrenchReading now = reading({{0.0, 0.0, weight}, Vec3::Zero()}, false);
      now.own_T = weight * Vec3(std::sin(angle), 0.0, std::cos(angle));
      if (judge(monitor, now)) found = i * kStuckCycle;
    }
    if (rate == 0.0) {
      EXPECT_GT(found, 1.0);
    } else {
      EXPECT_LT(found, 0.5 / (weight * rate) + 0.1) << rate;
    }
  }
}

TEST(StuckMonitor, OneWildReadingOfTheEncodersMakesNoSensorStuck) {
  StuckMonitor monitor;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = i % 50 == 0 ? Vec3(0, 0, 0.03) : Vec3(Vec3::Zero());
    ASSERT_FALSE(judge(monitor, reading({kPress, Vec3::Zero()}, false, p))) << i;
  }
}

// What the force is of is where the tip was when it was felt.
TEST(StuckMonitor, ALateSensorMayRepeatWhatItFeltBeforeTheTipMoved) {
  BumperSettings bumper;
  for (const double lag : {1e-3, 0.02, 0.1}) {
    bumper.sensor_lag = lag;
    StuckMonitor monitor;
    std::deque<double> late(static_cast<std::size_t>(std::lround(lag / kStuckCycle)) + 1, 0.0);
    double height = 0.0;
    for (int i = 0; i < 2000; ++i) {
      if (i % 100 < 50) height += (i / 100 % 2 == 0 ? 1.0 : -1.0) * 2e-4;
      late.push_back(height);
      const Wrench f{(kPress.z() - 1e3 * late.front()) * Vec3::UnitZ(), Vec3::Zero()};
      late.pop_front();
      ASSERT_FALSE(
          monitor.judge(bumper, kStuckCycle, reading(counted(f), false, height * Vec3::UnitZ())))
          << lag << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace handrail
