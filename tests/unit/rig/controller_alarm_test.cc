#include <gtest/gtest.h>

#include <limits>

#include "devices/rig/controller.h"
#include "server/kinematics/rv2a.h"
#include "tests/unit/rig/controller_bench.h"

namespace handrail {
namespace {

using Bench = test::ControllerBench;

double top_step(int joint) { return rv2a_limits().max_speed[joint] * to_seconds(kMxtPeriod); }

class ControllerAlarm : public ::testing::Test {
 protected:
  void SetUp() override { bench_.open(); }

  // Sends `packet` and expects the alarm: silence, and an arm that stays where it was told to be.
  void expect_alarm(const MxtPacket& packet, AlarmKind kind, int joint) {
    const JointVector held = bench_.controller.arm().target();
    bench_.feed(packet);
    EXPECT_EQ(bench_.tick(), 0u);
    EXPECT_EQ(bench_.controller.alarm().kind, kind);
    EXPECT_EQ(bench_.controller.alarm().joint, joint);
    bench_.feed_move(held);
    bench_.feed_null();
    EXPECT_EQ(bench_.tick(), 0u) << "an alarm latches";
    EXPECT_EQ(bench_.controller.arm().target(), held);
  }

  Bench bench_;
};

TEST_F(ControllerAlarm, AStepAtTopSpeedIsFineAndTwoPercentMoreIsNot) {
  for (int joint = 0; joint < kJoints; ++joint) {
    for (const double sign : {1.0, -1.0}) {
      SCOPED_TRACE(joint);
      bench_.controller.reset_alarm();
      bench_.open();
      const JointVector from = bench_.controller.arm().target();
      JointVector q = from;
      q[joint] += sign * top_step(joint);
      bench_.feed_move(q);
      EXPECT_EQ(bench_.tick(), 1u);
      bench_.feed_move(from);
      EXPECT_EQ(bench_.tick(), 1u);
      q[joint] = from[joint] + sign * 1.02 * top_step(joint);
      expect_alarm(Bench::move(q), AlarmKind::kOverSpeed, joint + 1);
    }
  }
}

TEST_F(ControllerAlarm, ASkippedCycleDoesNotAllowALargerStep) {
  for (int i = 0; i < 3; ++i) bench_.tick();
  expect_alarm(Bench::move(Bench::start_with(0, 1.5 * top_step(0))), AlarmKind::kOverSpeed, 1);
}

TEST_F(ControllerAlarm, ATargetOutsideTheRangeStopsTheArm) {
  const JointLimits& limits = rv2a_limits();
  for (int joint = 0; joint < kJoints; ++joint) {
    for (const bool high : {false, true}) {
      SCOPED_TRACE(joint);
      const double end = high ? limits.upper[joint] : limits.lower[joint];
      ControllerOptions options = Bench::quiet();
      options.arm.q_start = Bench::start_with(joint, end);
      Bench at_end(options);
      at_end.open();
      at_end.feed_move(options.arm.q_start);
      EXPECT_EQ(at_end.tick(), 1u) << "the end itself is inside";
      at_end.feed_move(Bench::start_with(joint, end + (high ? 1e-4 : -1e-4)));
      EXPECT_EQ(at_end.tick(), 0u);
      EXPECT_EQ(at_end.controller.alarm().kind, AlarmKind::kJointRange);
      EXPECT_EQ(at_end.controller.alarm().joint, joint + 1);
    }
  }
}

TEST_F(ControllerAlarm, NanOrInfinityStopsTheArm) {
  expect_alarm(Bench::move(Bench::start_with(3, std::numeric_limits<double>::quiet_NaN())),
               AlarmKind::kNotFinite, 0);
  bench_.controller.reset_alarm();
  bench_.open();
  expect_alarm(Bench::move(Bench::start_with(3, std::numeric_limits<double>::infinity())),
               AlarmKind::kNotFinite, 0);
}

TEST_F(ControllerAlarm, AnyCommandButJointsStopsTheArm) {
  for (const MxtType type : {MxtType::kNull, MxtType::kPose, MxtType::kPulse}) {
    MxtPacket packet = Bench::move(Bench::start());
    packet.send_type = type;
    expect_alarm(packet, AlarmKind::kWrongMode, 0);
    bench_.controller.reset_alarm();
    bench_.open();
  }
}

TEST_F(ControllerAlarm, ABadPacketSpoilsTheCycleEvenBehindAGoodOne) {
  bench_.feed_move(Bench::start_with(0, std::numeric_limits<double>::quiet_NaN()));
  bench_.feed_move(Bench::start_with(0, 0.01));
  EXPECT_EQ(bench_.tick(), 0u);
  EXPECT_EQ(bench_.controller.alarm().kind, AlarmKind::kNotFinite);
  EXPECT_EQ(bench_.controller.arm().target(), Bench::start());
}

TEST_F(ControllerAlarm, TheTimeOutCountsCyclesInARow) {
  ControllerOptions options = Bench::quiet();
  options.time_out_cycles = 10;
  Bench bench(options);
  for (int i = 0; i < 50; ++i) bench.tick();
  EXPECT_EQ(bench.controller.alarm().kind, AlarmKind::kNone) << "no session, no time-out";
  bench.open();
  for (int i = 0; i < 9; ++i) bench.tick();
  bench.feed_move(Bench::start());
  bench.tick();
  for (int i = 0; i < 9; ++i) bench.tick();
  EXPECT_EQ(bench.controller.alarm().kind, AlarmKind::kNone);
  bench.tick();
  EXPECT_EQ(bench.controller.alarm().kind, AlarmKind::kTimeOut);
  EXPECT_FALSE(bench.controller.session());
}

TEST_F(ControllerAlarm, WaitsForeverWithoutATimeOut) {
  for (int i = 0; i < 70'000; ++i) bench_.tick();
  EXPECT_EQ(bench_.controller.alarm().kind, AlarmKind::kNone);
  bench_.feed_move(Bench::start());
  bench_.tick();
  EXPECT_EQ(bench_.reply().t_count, 65'535) << "the count stays at its end";
}

TEST_F(ControllerAlarm, TheOperatorsResetLetsANewSessionIn) {
  expect_alarm(Bench::move(Bench::start_with(0, 1.0)), AlarmKind::kOverSpeed, 1);
  bench_.controller.reset_alarm();
  bench_.feed_move(Bench::start());
  EXPECT_EQ(bench_.tick(), 0u) << "the old session is gone";
  bench_.open();
  bench_.feed_move(Bench::start_with(0, 0.01));
  EXPECT_EQ(bench_.tick(), 1u);
}

}  // namespace
}  // namespace handrail
