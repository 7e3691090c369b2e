// Where a device's thread and the loop meet.
#include "devices/input/turn_gate.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "server/base/pacer.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

using Gate = TurnGate<int>;

// As a device does.
struct Turner {
  Gate& gate;
  double force = -1.0;
  Nanos written = 0, took = 0;

  double turn(int reading) {
    const Nanos began = monotonic_now();
    gate.give(reading, began);
    force = gate.answer(written).x();
    took = monotonic_now() - began;
    return force;
  }
};

TEST(TurnGate, ALoopThatTakesItsOwnTimeIsNotWaitedFor) {
  Gate gate;
  gate.reset();
  Turner device{gate};
  int reading = 0;
  EXPECT_FALSE(gate.take(reading));
  EXPECT_EQ(device.turn(7), 0.0);
  EXPECT_EQ(device.written, -kForever);
  EXPECT_TRUE(gate.take(reading));
  EXPECT_EQ(reading, 7);
  EXPECT_FALSE(gate.take(reading));
  gate.write(Vec3(2.0, 0.0, 0.0));
  EXPECT_EQ(device.turn(8), 2.0);
  EXPECT_LE(device.written, monotonic_now());
  EXPECT_TRUE(gate.take(reading));
  EXPECT_FALSE(gate.missed());
}

TEST(TurnGate, AForceThatComesTooLateIsCountedAndTheOldOneGoesOn) {
  Gate gate;
  gate.reset();
  Turner device{gate};
  int reading = 0;
  ASSERT_EQ(device.turn(1), 0.0);
  EXPECT_NE(gate.wait(monotonic_now()), 0);
  ASSERT_TRUE(gate.take(reading));
  gate.write(Vec3(10.0, 0.0, 0.0));  // that turn is over, but from now on it is waited for
  EXPECT_FALSE(gate.missed());
  EXPECT_EQ(device.turn(2), 10.0);
  EXPECT_GE(device.took, kAnswerPatience);
  ASSERT_TRUE(gate.take(reading));
  EXPECT_FALSE(gate.missed()) << "known with the next reading only";
  gate.write(Vec3(20.0, 0.0, 0.0));
  EXPECT_EQ(device.turn(3), 20.0);
  ASSERT_TRUE(gate.take(reading));
  EXPECT_TRUE(gate.missed());
  EXPECT_FALSE(gate.missed());
}

TEST(TurnGate, ALoopThatStandsStillDoesNotMakeTheDeviceLateForLong) {
  Gate gate;
  gate.reset();
  Turner device{gate};
  int reading = 0;
  ASSERT_EQ(device.turn(1), 0.0);
  (void)gate.wait(monotonic_now());
  ASSERT_TRUE(gate.take(reading));
  gate.write(Vec3(1.0, 0.0, 0.0));
  int waited = 0;
  for (int i = 0; i < 100; ++i) {
    (void)device.turn(i);
    // Its count of those that came too late goes on only while it waits.
    ASSERT_TRUE(gate.take(reading));
    waited += gate.missed() ? 1 : 0;
  }
  EXPECT_EQ(waited, 10);
}

// Each force belongs to the reading of its turn, or was counted as late.
TEST(TurnGate, TheForceOfATurnIsThatForItsReading) {
  Gate gate;
  gate.reset();
  std::atomic<bool> ends{false};
  int late = 0;
  std::thread loop([&] {
    int reading = 0;
    Nanos due = monotonic_now();
    while (!ends.load()) {
      due = gate.wait(due) + kMillisecond;
      if (gate.take(reading)) gate.write(Vec3(reading, 0.0, 0.0));
      late += gate.missed() ? 1 : 0;
    }
  });
  Turner device{gate};
  int in_turn = 0, behind = 0, behind_since = 0;  // since the loop first answered in a turn
  const test::NoAllocation guard("the gate");
  for (int i = 1; i <= 2000; ++i) {
    const double force = device.turn(i);
    ASSERT_LE(force, i);
    (force == i ? in_turn : behind) += 1;
    behind_since += force != i && in_turn > 0 ? 1 : 0;
    sleep_until(monotonic_now() + 200 * kMicrosecond);
  }
  ends = true;
  loop.join();
  EXPECT_GT(in_turn, 0);
  // Those between two readings that the loop takes count once, and the last may not be heard of.
  EXPECT_LE(late, behind);
  EXPECT_TRUE(late > 0 || behind_since <= 1) << behind_since;
}

TEST(TurnGate, WhileTheDeviceIsSilentTheLoopHasItsOwnClock) {
  Gate gate;
  gate.reset();
  Turner device{gate};
  int reading = 0;
  Nanos due = monotonic_now() + 2 * kMillisecond;
  EXPECT_EQ(gate.wait(due), due);
  EXPECT_GE(monotonic_now(), due);
  (void)device.turn(1);
  const Nanos turned = monotonic_now();
  due = turned + kSecond;
  EXPECT_LE(gate.wait(due), turned) << "the reading's time, at once";
  ASSERT_TRUE(gate.take(reading));
  // Once it is waited for beyond when it is expected, then no more.
  const Nanos expected = gate.wait(turned + kMillisecond);
  EXPECT_LE(expected, turned + kMillisecond) << "the reading was a little before";
  EXPECT_GT(expected, turned);
  EXPECT_GE(monotonic_now(), expected + kTurnPatience);
  due = monotonic_now() - kMillisecond;
  EXPECT_EQ(gate.wait(due), due);
  (void)device.turn(2);
  EXPECT_NE(gate.wait(due), due);
  EXPECT_TRUE(gate.take(reading));
}

// As one that pauses a millisecond between two turns.
TEST(TurnGate, ATurnIsExpectedWhenTheDeviceIsToTurnByItsOwnPeriod) {
  constexpr Nanos kPeriod = 1100 * kMicrosecond;
  constexpr int kTurns = 200;
  Gate gate;
  gate.reset();
  int reading = 0;
  const Nanos last = monotonic_now() + kMillisecond;
  for (int i = 1; i <= kTurns; ++i) {
    const Nanos at = last - (kTurns - i) * kPeriod;
    gate.give(i, at);
    EXPECT_EQ(gate.wait(at), at);
    ASSERT_TRUE(gate.take(reading));
  }
  const Nanos expected = gate.wait(last + kMillisecond);
  EXPECT_NEAR(static_cast<double>(expected - last), static_cast<double>(kPeriod), 1e3);
  EXPECT_GE(monotonic_now(), expected + kTurnPatience);
}

TEST(TurnGate, WhatIsWrittenAgainAfterAResetIsNotOfBefore) {
  Gate gate;
  gate.reset();
  Turner device{gate};
  int reading = 0;
  (void)device.turn(1);
  gate.write(Vec3(5.0, 0.0, 0.0));
  gate.reset();
  EXPECT_FALSE(gate.take(reading));
  EXPECT_EQ(device.turn(2), 0.0);
  EXPECT_EQ(device.written, -kForever);
  ASSERT_TRUE(gate.take(reading));
  EXPECT_EQ(reading, 2);
}

}  // namespace
}  // namespace handrail
