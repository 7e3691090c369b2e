// When a device's next turn is expected, against turns whose times are known.
#include "devices/input/turn_clock.h"

#include <gtest/gtest.h>

#include <cmath>

#include "server/base/random.h"

namespace handrail {
namespace {

// As measured at a Touch: so much does a turn vary by [ns], as a standard deviation.
constexpr double kVaries = 40e3;

struct Turns {
  TurnClock clock;
  std::uint32_t number = 0;
  Nanos at = 5 * kSecond;

  void turn(Nanos after) { clock.turned(++number, at += after); }
};

TEST(TurnClock, ExpectsTheFirstTurnAMillisecondAfterOne) {
  Turns device;
  device.turn(0);
  EXPECT_EQ(device.clock.expected(device.at + kMillisecond), device.at + kMillisecond);
}

TEST(TurnClock, LearnsThePeriodOfADeviceWhoseTurnsVary) {
  for (const double mean : {977e3, 1000e3, 1013e3, 1070e3}) {
    Random random(static_cast<std::uint64_t>(mean));
    Turns device;
    double worst = 0.0;
    for (int i = 0; i < 5000; ++i) {
      device.turn(static_cast<Nanos>(mean + kVaries * random.normal()));
      if (i < 200) continue;  // it begins at a millisecond
      worst = std::max(worst, std::abs(static_cast<double>(device.clock.period()) - mean));
    }
    // Of a mean over some 30 turns, in 5000: less than five standard deviations.
    EXPECT_LT(worst, 5.0 * kVaries / std::sqrt(31.0)) << mean;
  }
}

TEST(TurnClock, ATurnThatIsLateSaysNothingOfThePeriod) {
  Turns device;
  for (int i = 0; i < 500; ++i) device.turn(1030 * kMicrosecond);
  const Nanos period = device.clock.period();
  EXPECT_NEAR(static_cast<double>(period), 1030e3, 1e3);
  device.turn(2400 * kMicrosecond);
  device.turn(20 * kMillisecond);
  device.turn(3 * kMicrosecond);  // and the next comes after at once
  EXPECT_EQ(device.clock.period(), period);
  EXPECT_EQ(device.clock.expected(device.at + kMillisecond), device.at + period);
}

// As to a loop that slept over some.
TEST(TurnClock, TurnsThatAreNotHeardOfSayNothing) {
  Turns device;
  for (int i = 0; i < 500; ++i) {
    ++device.number;
    device.turn(900 * kMicrosecond);
  }
  EXPECT_EQ(device.clock.period(), TurnClock::kNominal);
}

TEST(TurnClock, ExpectsTheTurnThatIsNearestToTheLoopsOwn) {
  Turns device;
  device.turn(0);
  const Nanos first = device.at + kMillisecond;
  EXPECT_EQ(device.clock.expected(device.at - kSecond), first) << "never the one that was";
  EXPECT_EQ(device.clock.expected(device.at), first);
  EXPECT_EQ(device.clock.expected(device.at + 3400 * kMicrosecond), device.at + 3 * kMillisecond);
  EXPECT_EQ(device.clock.expected(device.at + 3600 * kMicrosecond), device.at + 4 * kMillisecond);
}

// The number counts on from 2^32 - 1 with 1 in a gate, which leaves out 0.
TEST(TurnClock, ANumberThatWrapsIsATurnThatIsNotHeardOf) {
  TurnClock clock;
  clock.turned(0xffffffff, kSecond);
  clock.turned(1, kSecond + 900 * kMicrosecond);
  EXPECT_EQ(clock.period(), TurnClock::kNominal);
  clock.turned(2, kSecond + 1800 * kMicrosecond);
  EXPECT_LT(clock.period(), TurnClock::kNominal);
}

}  // namespace
}  // namespace handrail
