// How a session of real-time external control opens.
#include <gtest/gtest.h>

#include <deque>
#include <utility>

#include "devices/melfa/mxt_client.h"
#include "tests/support/mxt/mxt_golden.h"

namespace handrail {
namespace {

using golden::Packet;

constexpr Nanos kPeriod = kMxtPeriod;

Packet copy(MxtClient::Bytes bytes) { return {bytes.begin(), bytes.end()}; }

class MxtOpening : public ::testing::Test {
 protected:
  // The first reply comes at 0.
  void hear_first() {
    EXPECT_EQ(client_.on_datagram(golden::reply_long(), 0, reply_), std::nullopt);
    EXPECT_EQ(client_.poll(0, reply_), RobotEvent::kSilence) << "asks again at once";
    EXPECT_TRUE(client_.opening());
  }

  MxtClient client_{MxtClientOptions{}};
  RobotReply reply_;
};

TEST_F(MxtOpening, AsksAgainUntilTheFirstReply) {
  client_.start(-3 * kPeriod);
  Packet again = golden::null_long();
  again[60] = 1;
  EXPECT_EQ(client_.poll(-kPeriod, reply_), RobotEvent::kSilence);
  EXPECT_TRUE(client_.opening());
  EXPECT_EQ(copy(client_.packet()), again);
  hear_first();
  EXPECT_EQ(client_.on_datagram(golden::reply_long(), kPeriod, reply_), RobotEvent::kReply);
  EXPECT_FALSE(client_.opening());
}

// A controller at the end of a long way: in each of its cycles it answers all that has come.
struct FarController {
  explicit FarController(std::size_t packet_bytes) : client({.packet_bytes = packet_bytes}) {}

  // The session opens within a second.
  bool opens() {
    give(client.start(0));
    for (now = 0; now < kSecond; now += step) {
      if (now % kPeriod == 0) answer();
      if (!replies.empty() && replies.front().first <= now) {
        const Packet reply_bytes = replies.front().second;
        replies.pop_front();
        if (client.on_datagram(reply_bytes, now, reply) == RobotEvent::kReply) return true;
      }
      if (client.poll(now, reply)) give(client.packet());
    }
    return false;
  }
  void give(MxtClient::Bytes bytes) { packets.emplace_back(now + way, copy(bytes)); }
  void answer() {
    for (; !packets.empty() && packets.front().first <= now; packets.pop_front()) {
      const Packet& packet = packets.front().second;
      const bool held = packet.size() == kMxtShort && packet[4] == 2;
      replies.emplace_back(now + way, held                         ? golden::reply_short_held()
                                      : packet.size() == kMxtShort ? golden::reply_short()
                                                                   : golden::reply_long());
    }
  }

  static constexpr Nanos step = kPeriod / 100;
  MxtClient client;
  Nanos way = 0;  // each way
  RobotReply reply;
  Nanos now = 0;
  std::deque<std::pair<Nanos, Packet>> packets, replies;  // when they are there
};

TEST_F(MxtOpening, DoesNotOpenWhereTheWayThereAndBackTakesMoreThanACycle) {
  for (const std::size_t bytes : {kMxtLong, kMxtShort}) {
    for (const int percent : {0, 10, 30, 48, 52, 70, 99, 102, 130, 160, 240, 350, 470, 640}) {
      FarController controller(bytes);
      controller.way = percent * FarController::step;
      EXPECT_EQ(controller.opens(), percent < 50) << percent << " % of a cycle each way";
      EXPECT_EQ(controller.client.counters().far == 0, percent < 50);
    }
  }
}

TEST_F(MxtOpening, OpensAtTheNextTryWhereAReplyOfTheOpeningIsLost) {
  client_.start(-kPeriod);
  hear_first();
  EXPECT_EQ(client_.poll(client_.deadline(), reply_), std::nullopt) << "waits for what may come";
  EXPECT_EQ(client_.on_datagram(golden::reply_long(), client_.deadline() - 1, reply_),
            std::nullopt);
  const Nanos again = client_.deadline();
  EXPECT_EQ(client_.poll(again, reply_), RobotEvent::kSilence);
  EXPECT_EQ(client_.on_datagram(golden::reply_long(), again + kPeriod, reply_), std::nullopt);
  EXPECT_EQ(client_.poll(again + kPeriod, reply_), RobotEvent::kSilence);
  EXPECT_EQ(client_.on_datagram(golden::reply_long(), again + 2 * kPeriod, reply_),
            RobotEvent::kReply);
}

}  // namespace
}  // namespace handrail
