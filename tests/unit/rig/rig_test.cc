#include "devices/rig/rig.h"

#include <gtest/gtest.h>

#include "devices/melfa/mxt_client.h"
#include "devices/net_ft/rdt_client.h"
#include "server/base/fnv.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

constexpr PeerId kComputer = 1;
constexpr Nanos kStart = 3 * kSecond;

TEST(Rig, RunsCyclesAndPeriodsAtTheirOwnTimes) {
  Rig rig(RigOptions{}, kStart);
  EXPECT_EQ(rig.next(), kStart + kMillisecond);
  EXPECT_EQ(rig.step(kStart + kMillisecond - 1), RigEvent::kNone);
  int cycles = 0;
  int periods = 0;
  for (Nanos now = kStart; now <= kStart + 100 * kMxtPeriod; now += 100 * kMicrosecond) {
    for (RigEvent event; (event = rig.step(now)) != RigEvent::kNone;) {
      (event == RigEvent::kControl ? cycles : periods)++;
    }
  }
  EXPECT_EQ(cycles, 100);
  EXPECT_EQ(periods, 710);
  EXPECT_EQ(rig.skipped(), 0u);
}

TEST(Rig, DoesNotCatchUpByABurstAfterALongPause) {
  Rig rig(RigOptions{}, kStart);
  int events = 0;
  while (rig.step(kStart + 60 * kSecond) != RigEvent::kNone) ++events;
  EXPECT_LE(events, 4);
  EXPECT_GT(rig.skipped(), 60'000u);
  EXPECT_GT(rig.next(), kStart + 60 * kSecond);
}

// Drives the rig with the two real clients in virtual time and hashes every byte it sends.
struct Session {
  explicit Session(const RigOptions& options) : rig(options, 0) {}

  void run(Nanos span) {
    const Nanos end = now + span;
    while (rig.next() <= end) {
      if (robot.open() && robot.deadline() < rig.next()) {
        now = std::max(now, robot.deadline());
        if (robot.poll(now, reply) == RobotEvent::kSilence) {
          give(robot.opening() ? robot.packet() : robot.send(q_target, now));
        }
        continue;
      }
      now = rig.next();
      const RigEvent event = rig.step(now);
      if (event == RigEvent::kControl) on_control();
      if (event == RigEvent::kSensor) on_sensor();
    }
  }

  void on_control() {
    bool fresh = false;
    for (const auto& out : rig.controller().replies()) {
      for (const std::uint8_t byte : out.bytes()) hash.byte(byte);
      fresh = robot.on_datagram(out.bytes(), now, reply) == RobotEvent::kReply || fresh;
    }
    if (fresh) {
      q_target[0] += 0.005;
      give(robot.send(q_target, now));
    } else if (!robot.open()) {
      q_target = ServoArmOptions::default_start();
      give(robot.start(now));
    }
  }

  void on_sensor() {
    if (const auto& record = rig.sensor().record()) {
      for (const std::uint8_t byte : record->bytes) hash.byte(byte);
      sensor.on_datagram(record->bytes, now, sample);
    } else if (sensor.counters().requests == 0) {
      rig.sensor().on_datagram(sensor.start(now), kComputer);
    }
  }

  void give(std::span<const std::uint8_t> bytes) { rig.controller().on_datagram(bytes, kComputer); }

  Rig rig;
  MxtClient robot{MxtClientOptions{}};
  RdtClient sensor{RdtClientOptions{}};
  JointVector q_target = ServoArmOptions::default_start();
  RobotReply reply;
  FtSample sample;
  Nanos now = 0;
  Fnv hash;
};

TEST(Rig, PacesTheClientAtTheControllersCycle) {
  Session session{RigOptions{}};
  session.run(2 * kSecond);
  EXPECT_EQ(session.robot.counters().silences, 0u);
  // 281 cycles in 2 s; the first asks, the second answers.
  EXPECT_EQ(session.robot.counters().replies, 280u);
  EXPECT_EQ(session.sensor.counters().records, 1999u);
  EXPECT_EQ(session.rig.controller().alarm().kind, AlarmKind::kNone);
}

TEST(Rig, SameSeedSameBytes) {
  RigOptions options;
  options.controller.drop_share = 0.05;
  options.sensor.drop_share = 0.05;
  Session first(options);
  Session again(options);
  options.controller.arm.seed = 2;
  Session other(options);
  for (Session* session : {&first, &again, &other}) session->run(3 * kSecond);
  EXPECT_EQ(first.hash.value(), again.hash.value());
  EXPECT_NE(first.hash.value(), other.hash.value());
  EXPECT_GT(first.robot.counters().silences, 0u);
}

TEST(Rig, TheClientRidesOutASwitchThatDropsOnePercent) {
  RigOptions options;
  options.controller.drop_share = 0.01;
  Session session(options);
  session.run(3 * kSecond);
  EXPECT_GT(session.robot.counters().silences, 0u);
  EXPECT_GT(session.robot.counters().replies, 400u);
  EXPECT_EQ(session.rig.controller().alarm().kind, AlarmKind::kNone);
  EXPECT_TRUE(session.robot.open());
}

TEST(Rig, AnAlarmLooksLikeALostControllerToTheClient) {
  Session session{RigOptions{}};
  session.run(kSecond);
  session.q_target[0] += 1.0;
  session.run(kSecond);
  ASSERT_EQ(session.rig.controller().alarm().kind, AlarmKind::kOverSpeed);
  EXPECT_GT(session.robot.counters().silences, 40u);
  const std::uint64_t replies = session.robot.counters().replies;
  session.run(kSecond);
  EXPECT_EQ(session.robot.counters().replies, replies);
}

TEST(Rig, DoesNotAllocate) {
  Session session{RigOptions{}};
  test::NoAllocation guard("a rig session");
  session.run(kSecond);
}

}  // namespace
}  // namespace handrail
