// How a session of real-time external control opens.
#include <gtest/gtest.h>

#include <deque>
#include <string>
#include <utility>

#include "devices/melfa/mxt_client.h"
#include "tests/support/mxt/mxt_golden.h"

namespace handrail {
namespace {

using golden::Packet;

Packet copy(MxtClient::Bytes bytes) { return {bytes.begin(), bytes.end()}; }

class MxtOpening : public ::testing::Test {
 protected:
  // The reply to the first packet comes, or one to a further packet; true: it opens the session.
  // Else the next packet is sent as soon as it is due.
  bool hear_first(Nanos at) { return hear(golden::reply_long(), at); }
  bool hear_further(Nanos at) { return hear(golden::reply_long_held(), at); }
  bool hear(const Packet& reply, Nanos at) {
    if (client_.on_datagram(reply, at, reply_) == RobotEvent::kReply) return true;
    EXPECT_EQ(client_.deadline(), at + kMxtPeriod * 15 / 16) << "late in its cycle";
    EXPECT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
    return false;
  }

  MxtClient client_{MxtClientOptions{}};
  RobotReply reply_;
};

TEST_F(MxtOpening, AsksAgainUntilTheFirstReply) {
  client_.start(-3 * kMxtPeriod);
  Packet again = golden::null_long();
  again[60] = 1;
  EXPECT_EQ(client_.poll(-kMxtPeriod, reply_), RobotEvent::kSilence);
  EXPECT_TRUE(client_.opening());
  EXPECT_EQ(copy(client_.packet()), again);
  EXPECT_FALSE(hear_first(0));
  EXPECT_EQ(copy(client_.packet()), golden::null_long_held(2));
  EXPECT_FALSE(hear_further(kMxtPeriod));
  EXPECT_FALSE(hear_further(2 * kMxtPeriod));
  EXPECT_TRUE(client_.opening());
  EXPECT_TRUE(hear_further(3 * kMxtPeriod));
  EXPECT_FALSE(client_.opening());
}

// A controller at the end of a long way: in each of its cycles it answers all that has come.
struct FarController {
  explicit FarController(std::size_t packet_bytes) : client({.packet_bytes = packet_bytes}) {}

  // The session opens within a second.
  bool opens() {
    give(client.start(0));
    for (now = 0; now < kSecond; now += step) {
      if (now % kMxtPeriod == 0) answer();
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
      const bool brief = packet.size() == kMxtShort, held = packet[4] == 2;
      replies.emplace_back(now + way, brief && held ? golden::reply_short_held()
                                      : brief       ? golden::reply_short()
                                      : held        ? golden::reply_long_held()
                                                    : golden::reply_long());
    }
  }

  static constexpr Nanos step = kMxtPeriod / 100;
  MxtClient client;
  Nanos way = 0;  // each way
  RobotReply reply;
  Nanos now = 0;
  std::deque<std::pair<Nanos, Packet>> packets, replies;  // when they are there
};

TEST_F(MxtOpening, OpensOnlyWhereAPacketWithoutAReplyWillBeThereInTime) {
  for (const std::size_t bytes : {kMxtLong, kMxtShort}) {
    for (const int percent : {0, 2, 4, 12, 21, 23, 30, 52, 70, 99, 102, 130, 160, 240, 350, 640}) {
      SCOPED_TRACE(std::to_string(percent) + " % of a cycle each way");
      FarController controller(bytes);
      controller.way = percent * FarController::step;
      ASSERT_EQ(controller.opens(), percent < 22);
      EXPECT_EQ(controller.client.counters().far == 0, percent < 3);
      if (percent >= 22) continue;
      const Nanos spare = controller.now + 2 * kMxtPeriod - controller.client.deadline();
      EXPECT_EQ(spare, kMxtPeriod / (percent < 3 ? 8 : 2));
      EXPECT_GT(spare, 2 * controller.way);
    }
  }
}

TEST_F(MxtOpening, OneReplyThatIsLateDoesNotMakeTheWayLongButTheCountBeginsAnew) {
  client_.start(-kMxtPeriod);
  hear_first(0);
  hear_further(kMxtPeriod);
  hear_further(2 * kMxtPeriod);
  EXPECT_FALSE(hear_further(4 * kMxtPeriod)) << "late by one";
  EXPECT_FALSE(hear_further(5 * kMxtPeriod));
  EXPECT_FALSE(hear_further(6 * kMxtPeriod));
  EXPECT_TRUE(hear_further(7 * kMxtPeriod));
  EXPECT_EQ(client_.deadline(), 9 * kMxtPeriod - kMxtPeriod / 8);
}

TEST_F(MxtOpening, WhereAReplyIsLostItBeginsAnewOnceNothingCanBeOnItsWay) {
  client_.start(-kMxtPeriod);
  hear_first(0);
  EXPECT_EQ(client_.poll(client_.deadline(), reply_), std::nullopt) << "waits for what may come";
  EXPECT_EQ(client_.on_datagram(golden::reply_long_held(), client_.deadline() - 1, reply_),
            std::nullopt);
  Nanos at = client_.deadline();
  EXPECT_EQ(client_.poll(at, reply_), RobotEvent::kSilence);
  hear_first(at += kMxtPeriod);
  const Nanos due = client_.deadline();
  EXPECT_EQ(client_.on_datagram(golden::reply_long(), at + kMxtPeriod, reply_), std::nullopt);
  EXPECT_EQ(client_.deadline(), due) << "the first reply once more is no answer";
  hear_further(at += kMxtPeriod);
  hear_further(at += kMxtPeriod);
  EXPECT_TRUE(hear_further(at += kMxtPeriod));
}

TEST_F(MxtOpening, GivesUpAtOnceWhereAnotherAnswerMayBeOnItsWay) {
  client_.start(-3 * kMxtPeriod);
  EXPECT_EQ(client_.poll(-kMxtPeriod, reply_), RobotEvent::kSilence);
  hear_first(0);
  EXPECT_EQ(client_.on_datagram(golden::reply_long_held(), 2 * kMxtPeriod, reply_), std::nullopt);
  EXPECT_EQ(client_.deadline(), 16 * kMxtPeriod);
}

TEST_F(MxtOpening, AfterTooLongAWayItBeginsWithTheShortOneAgain) {
  client_.start(-kMxtPeriod);
  hear_first(0);
  for (int late = 1; late <= 5; ++late) {
    const Nanos at = 2 * late * kMxtPeriod;
    EXPECT_EQ(client_.on_datagram(golden::reply_long_held(), at, reply_), std::nullopt);
    EXPECT_EQ(client_.deadline(), at + kMxtPeriod * (late < 3 ? 15 : 9) / 16) << late;
    EXPECT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  }
  EXPECT_EQ(client_.on_datagram(golden::reply_long_held(), 12 * kMxtPeriod, reply_), std::nullopt);
  ASSERT_EQ(client_.deadline(), 26 * kMxtPeriod);
  EXPECT_EQ(client_.poll(26 * kMxtPeriod, reply_), RobotEvent::kSilence);
  hear_first(27 * kMxtPeriod);
}

}  // namespace
}  // namespace handrail
