#include "devices/rig/controller.h"

#include <gtest/gtest.h>

#include "tests/support/no_allocation.h"
#include "tests/unit/rig/controller_bench.h"

namespace handrail {
namespace {

using Bench = test::ControllerBench;
using test::kPc;

constexpr double kFloat = 1e-6;  // what float32 loses [rad]

TEST(Controller, AnswersTheOpeningPacketWithTheCurrentJointsInTheNextCycle) {
  Bench bench;
  bench.feed_null();
  EXPECT_TRUE(bench.controller.replies().empty());
  ASSERT_EQ(bench.tick(), 1u);
  const MxtPacket reply = bench.reply();
  EXPECT_EQ(bench.controller.replies()[0].to, kPc);
  EXPECT_EQ(reply.type[0], MxtType::kFeedbackJoint);
  EXPECT_EQ(reply.send_type, MxtType::kFeedbackJoint);
  EXPECT_LT((reply.block[0].joints() - Bench::start()).norm(), kFloat);
  EXPECT_LT((reply.block[1].joints() - Bench::start()).norm(), kFloat);
  EXPECT_EQ(bench.tick(), 0u) << "one packet, one reply";
}

TEST(Controller, RepliesInTheSizeReceived) {
  Bench bench;
  for (const std::size_t size : {kMxtShort, kMxtLong, kMxtShort}) {
    bench.feed_null(size);
    ASSERT_EQ(bench.tick(), 1u);
    EXPECT_EQ(bench.controller.replies()[0].bytes().size(), size);
  }
}

TEST(Controller, NeedsTheOpeningPacketBeforeItMoves) {
  Bench bench;
  bench.feed_move(Bench::start_with(0, 0.01));
  EXPECT_EQ(bench.tick(), 0u);
  EXPECT_EQ(bench.controller.counters().ignored, 1u);
  EXPECT_EQ(bench.controller.arm().target(), Bench::start());
  EXPECT_EQ(bench.controller.alarm().kind, AlarmKind::kNone);
}

TEST(Controller, AnOpeningPacketMovesNothingEvenWithDataInIt) {
  Bench bench;
  MxtPacket packet = Bench::move(Bench::start_with(0, 0.01));
  packet.command = MxtCommand::kNull;
  bench.feed(packet);
  EXPECT_EQ(bench.tick(), 1u);
  bench.tick();
  EXPECT_EQ(bench.controller.arm().joints(), Bench::start());
}

TEST(Controller, MovesFromTheCycleAfterTheCommand) {
  Bench bench;
  bench.open();
  bench.feed_move(Bench::start_with(0, 0.01));
  EXPECT_EQ(bench.controller.arm().target()[0], 0.0);
  ASSERT_EQ(bench.tick(), 1u);
  const MxtPacket reply = bench.reply();
  EXPECT_NEAR(reply.block[0].joints()[0], 0.0, kFloat) << "the arm has not moved yet";
  EXPECT_NEAR(reply.block[1].joints()[0], 0.01, kFloat) << "but the command is in force";
  bench.tick();
  const double lag = bench.controller.arm().lag()[0];
  EXPECT_NEAR(bench.controller.arm().joints()[0],
              0.01 * (1.0 - std::exp(-to_seconds(kMxtPeriod) / lag)), 1e-9);
}

TEST(Controller, HoldsTheLastTargetWhenNothingComes) {
  Bench bench;
  bench.open();
  bench.feed_move(Bench::start_with(0, 0.01));
  for (int i = 0; i < 300; ++i) bench.tick();
  EXPECT_NEAR(bench.controller.arm().joints()[0], 0.01, 1e-8);
  EXPECT_TRUE(bench.controller.session());
}

TEST(Controller, TheNewestOfSeveralPacketsWinsAndEachIsAnswered) {
  Bench bench;
  bench.open();
  // The first would be an alarm had it counted.
  bench.feed_move(Bench::start_with(0, 0.5));
  bench.feed_move(Bench::start_with(0, 0.01));
  EXPECT_EQ(bench.tick(), 2u);
  EXPECT_NEAR(bench.controller.arm().target()[0], 0.01, kFloat);
  EXPECT_EQ(bench.controller.alarm().kind, AlarmKind::kNone);
}

TEST(Controller, HandsBackThePacketCounter) {
  Bench bench;
  MxtPacket packet;
  packet.type[0] = MxtType::kFeedbackJoint;
  packet.c_count = 0xdeadbeef;
  bench.feed(packet);
  bench.tick();
  EXPECT_EQ(bench.reply().c_count, 0xdeadbeefu);
}

TEST(Controller, GivesTheMonitorsAskedFor) {
  Bench bench;
  bench.open();
  MxtPacket packet = Bench::move(Bench::start_with(0, 0.01));
  packet.type = {MxtType::kFeedbackPose, MxtType::kFilteredJoint, MxtType::kPose,
                 MxtType::kFeedbackCurrent};
  bench.feed(packet);
  bench.tick();
  const MxtPacket reply = bench.reply();
  EXPECT_EQ(reply.type, packet.type);
  EXPECT_NEAR(reply.block[1].joints()[0], 0.01, kFloat);
  EXPECT_EQ(reply.block[3].words, MxtBlock{}.words);
  // Tool down at the start pose, 216 mm longer than the flange: x 350, z 645 - 216 mm.
  const MxtBlock& measured = reply.block[0];
  EXPECT_NEAR(measured.real(0), 350.0, 1e-3);
  EXPECT_NEAR(measured.real(1), 0.0, 1e-3);
  EXPECT_NEAR(measured.real(2), 429.0, 1e-3);
  EXPECT_NEAR(std::abs(measured.real(3)), 180.0 * kDeg, 1e-5);
  EXPECT_NEAR(measured.real(4), 0.0, 1e-5);
  EXPECT_NEAR(std::abs(measured.real(5)), 180.0 * kDeg, 1e-5);
  EXPECT_EQ(measured.words[8], 7u);
  EXPECT_NEAR(reply.block[2].real(1), 350.0 * std::sin(0.01), 1e-3) << "the command turns J1";
}

TEST(Controller, ReportsAnglesSoThatTheirRotationsComposeToThePose) {
  ControllerOptions options = Bench::quiet();
  options.arm.q_start << 45 * kDeg, -20 * kDeg, 100 * kDeg, 30 * kDeg, 60 * kDeg, -40 * kDeg;
  options.arm.geometry.d6 = kFlangeLength;
  Bench bench(options);
  MxtPacket packet;
  packet.type[0] = MxtType::kFeedbackPose;
  bench.feed(packet);
  bench.tick();
  // Check pose of the flange for this configuration, in mm and degrees.
  const double expected[] = {179.776, 231.827, 700.959, 179.435, 49.322, -100.929};
  const MxtBlock pose = bench.reply().block[0];
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(pose.real(i), expected[i], 1e-3);
  for (std::size_t i = 3; i < 6; ++i) EXPECT_NEAR(pose.real(i) / kDeg, expected[i], 1e-3);
}

TEST(Controller, CountsCyclesWithoutAPacket) {
  Bench bench;
  bench.tick();
  EXPECT_EQ(bench.controller.t_count(), 0u) << "nobody to wait for yet";
  bench.open();
  for (int i = 0; i < 5; ++i) bench.tick();
  bench.feed_move(Bench::start());
  bench.tick();
  EXPECT_EQ(bench.reply().t_count, 5);
  bench.feed_move(Bench::start());
  bench.tick();
  EXPECT_EQ(bench.reply().t_count, 0);
}

TEST(Controller, EndsExternalControlUntilTheNextOpeningPacket) {
  Bench bench;
  bench.open();
  bench.feed_end();
  EXPECT_EQ(bench.tick(), 0u) << "END is not answered";
  EXPECT_FALSE(bench.controller.session());
  bench.feed_move(Bench::start_with(0, 0.01));
  EXPECT_EQ(bench.tick(), 0u);
  EXPECT_EQ(bench.controller.arm().target(), Bench::start());
  bench.open();
  bench.feed_move(Bench::start_with(0, 0.01));
  EXPECT_EQ(bench.tick(), 1u);
}

TEST(Controller, ServesNobodyButTheSessionsPeer) {
  Bench bench;
  bench.open();
  bench.feed_move(Bench::start_with(0, 0.01), kMxtLong, kPc + 1);
  EXPECT_EQ(bench.tick(), 0u);
  EXPECT_EQ(bench.controller.arm().target(), Bench::start());
  // A restarted driver opens anew from another port, and its count of cycles too.
  bench.feed_null(kMxtLong, kPc + 1);
  EXPECT_EQ(bench.tick(), 1u);
  EXPECT_EQ(bench.reply().t_count, 0);
  EXPECT_EQ(bench.controller.session(), kPc + 1);
  bench.feed_move(Bench::start_with(0, 0.01));
  EXPECT_EQ(bench.tick(), 0u);
}

TEST(Controller, DropsGarbageAndCountsIt) {
  Bench bench;
  bench.open();
  const std::vector<std::uint8_t> garbage(195, 0x55);
  bench.controller.on_datagram(garbage, kPc);
  bench.controller.on_datagram({}, kPc);
  bench.controller.on_datagram(std::vector<std::uint8_t>(196, 0xff), kPc);
  MxtPacket unknown;
  unknown.command = MxtCommand{7};
  bench.feed(unknown);
  EXPECT_EQ(bench.tick(), 0u);
  EXPECT_EQ(bench.controller.counters().ignored, 4u);
  EXPECT_EQ(bench.controller.alarm().kind, AlarmKind::kNone);
  bench.feed_move(Bench::start());
  EXPECT_EQ(bench.tick(), 1u);
}

TEST(Controller, SurvivesAFloodInOneCycle) {
  Bench bench;
  bench.open();
  for (int i = 0; i < 1000; ++i) bench.feed_move(Bench::start());
  EXPECT_EQ(bench.tick(), Controller::kMaxPerCycle);
  EXPECT_EQ(bench.controller.counters().ignored, 1000 - Controller::kMaxPerCycle);
}

TEST(Controller, TheSwitchDropsItsShareBothWays) {
  ControllerOptions options = Bench::quiet();
  options.drop_share = 0.01;
  Bench bench(options);
  int replies = 0;
  constexpr int kCycles = 100'000;
  for (int i = 0; i < kCycles; ++i) {
    bench.feed_null();
    replies += static_cast<int>(bench.tick());
  }
  // Both ways survive with 0.99^2 = 0.9801; five standard deviations are 0.0022.
  EXPECT_NEAR(static_cast<double>(replies) / kCycles, 0.9801, 0.0022);
  const double requests_lost = kCycles - static_cast<double>(bench.controller.counters().packets);
  EXPECT_NEAR(requests_lost / kCycles, 0.01, 0.0016);
}

TEST(Controller, DoesNotAllocate) {
  Bench bench;
  test::NoAllocation guard("a control cycle");
  bench.feed_null();
  bench.tick();
  bench.feed_move(Bench::start_with(0, 0.01));
  bench.tick();
  bench.feed_move(Bench::start_with(0, 1.0));
  bench.tick();
}

}  // namespace
}  // namespace handrail
