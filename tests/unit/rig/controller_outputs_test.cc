// The digital outputs of the simulated controller: set, read back, kept.
#include <gtest/gtest.h>

#include "tests/unit/rig/controller_bench.h"

namespace handrail {
namespace {

using Bench = test::ControllerBench;

MxtPacket telling(std::uint16_t top, std::uint16_t mask, std::uint16_t data) {
  MxtPacket packet = Bench::move(Bench::start());
  packet.io = {.send_type = 1, .recv_type = 1, .bit_top = top, .bit_mask = mask, .data = data};
  return packet;
}

// What outputs `top` and on are, as a packet that sets none reads them.
std::uint16_t read(Bench& bench, std::uint16_t top) {
  bench.feed(telling(top, 0, 0xffff));
  EXPECT_EQ(bench.tick(), 1u);
  EXPECT_EQ(bench.reply().io.send_type, 1);
  EXPECT_EQ(bench.reply().io.bit_top, top);
  return bench.reply().io.data;
}

TEST(ControllerOutputs, ThoseOfTheMaskBecomeWhatThePacketSays) {
  Bench bench;
  bench.open();
  EXPECT_EQ(read(bench, 900), 0);
  bench.feed(telling(900, 0x8005, 0xffff));
  ASSERT_EQ(bench.tick(), 1u);
  EXPECT_EQ(bench.reply().io.data, 0x8005) << "the reply is of after it";
  bench.feed(telling(901, 0x0002, 0));
  bench.tick();
  EXPECT_EQ(read(bench, 900), 0x8001);
  EXPECT_EQ(read(bench, 915), 1);
  EXPECT_TRUE(bench.controller.output(900) && bench.controller.output(915));
}

TEST(ControllerOutputs, AreKeptWithoutASession) {
  Bench bench;
  bench.open();
  bench.feed(telling(900, 1, 1));
  bench.tick();
  bench.feed_end();
  bench.tick();
  bench.feed(telling(900, 1, 0));
  EXPECT_EQ(bench.tick(), 0u);
  EXPECT_TRUE(bench.controller.output(900)) << "nobody's packet";
  bench.open();
  EXPECT_EQ(read(bench, 900), 1);
}

TEST(ControllerOutputs, ThereAreNoneBeyondTheLastAndNoInputs) {
  Bench bench;
  bench.open();
  bench.feed(telling(1020, 0xffff, 0xffff));
  bench.tick();
  EXPECT_EQ(bench.reply().io.data, 0x000f);
  bench.feed(telling(65535, 0xffff, 0xffff));
  bench.tick();
  EXPECT_EQ(bench.reply().io.data, 0);
  MxtPacket inputs = telling(900, 1, 1);
  inputs.io.send_type = 0;
  inputs.io.recv_type = 2;
  bench.feed(inputs);
  bench.tick();
  EXPECT_EQ(bench.reply().io.send_type, 2);
  EXPECT_EQ(bench.reply().io.data, 0);
  EXPECT_EQ(read(bench, 900), 0) << "a packet that sends none sets none";
}

// A controller in alarm does nothing that it is told.
TEST(ControllerOutputs, AnAlarmKeepsThemAsTheyAre) {
  Bench bench;
  bench.open();
  MxtPacket wrong = telling(900, 1, 1);
  wrong.send_type = MxtType::kPose;
  bench.feed(wrong);
  bench.tick();
  ASSERT_EQ(bench.controller.alarm().kind, AlarmKind::kWrongMode);
  EXPECT_FALSE(bench.controller.output(900));
}

}  // namespace
}  // namespace handrail
