#include "server/link/pump.h"

#include <gtest/gtest.h>

#include <deque>

#include "tests/unit/link/link_samples.h"

namespace handrail {
namespace {

constexpr Nanos kPumpStart = 1000 * kSecond;

// Plays datagrams from a script and keeps what is sent.
class ScriptedTransport : public Transport {
 public:
  struct Entry {
    std::vector<std::uint8_t> bytes;
    bool from_peer = true;
  };
  std::deque<Entry> waiting;
  std::vector<std::size_t> sent;
  int adopted = 0;

  std::optional<Arrival> receive(std::span<std::uint8_t> buffer) noexcept override {
    if (waiting.empty()) return std::nullopt;
    const Entry entry = waiting.front();
    waiting.pop_front();
    const std::size_t size = std::min(entry.bytes.size(), buffer.size());
    std::copy_n(entry.bytes.begin(), size, buffer.begin());
    return Arrival{size, entry.from_peer};
  }
  void adopt_sender() noexcept override { ++adopted; }
  bool send(std::span<const std::uint8_t> bytes) noexcept override {
    sent.push_back(bytes.size());
    return true;
  }
  bool answer(std::span<const std::uint8_t> bytes) noexcept override {
    answered.emplace_back(bytes.begin(), bytes.end());
    return true;
  }
  std::string_view peer_name() const noexcept override { return "process 4711"; }
  std::vector<std::vector<std::uint8_t>> answered;
};

class PumpTest : public ::testing::Test {
 protected:
  void arrive(std::uint64_t sequence, bool from_peer = true) {
    MasterState state = sample_master();
    state.stop_epoch = static_cast<std::uint32_t>(sequence);
    net.waiting.push_back({datagram(sample_header(7, sequence), state), from_peer});
  }
  std::uint64_t rejected(Reject cause) { return peer.rejects()[static_cast<std::size_t>(cause)]; }

  ScriptedTransport net;
  SlavePeer peer{1};
  LinkPump<SlaveState, MasterState> pump{net, peer};
};

TEST_F(PumpTest, TakesEverythingThatWaitsAndKeepsTheNewest) {
  for (const std::uint64_t n : {1U, 3U, 2U}) arrive(n);
  EXPECT_TRUE(pump.receive(kPumpStart));
  EXPECT_EQ(peer.newest().stop_epoch, 3u);
  EXPECT_TRUE(net.waiting.empty());
  EXPECT_FALSE(pump.receive(kPumpStart + 1));
}

TEST_F(PumpTest, OnlyAcceptedDatagramsTellWhereThePeerIs) {
  arrive(1);
  arrive(1);
  net.waiting.push_back({{1, 2, 3}});
  (void)pump.receive(kPumpStart);
  EXPECT_EQ(net.adopted, 1);
}

TEST_F(PumpTest, WhoIsRefusedForAnotherIsToldNotOftenAndInFewerBytes) {
  // The master that leads has answered us.
  pump.send(kPumpStart, sample_slave());
  DatagramHeader header = sample_header(7, 1);
  header.echo_session = 1;
  header.echo_sequence = 1;
  header.echo_sent = kPumpStart;
  net.waiting.push_back({datagram(header, sample_master())});
  ASSERT_TRUE(pump.receive(kPumpStart));
  int adopted = net.adopted;
  for (std::uint64_t n = 1; n <= 1000; ++n) {
    const Nanos now = kPumpStart + static_cast<Nanos>(n) * kMillisecond;
    arrive(n + 1);
    net.waiting.push_back({datagram(sample_header(8, n), sample_master())});
    (void)pump.receive(now);
    ++adopted;
  }
  EXPECT_EQ(net.adopted, adopted);
  ASSERT_EQ(net.answered.size(), 5u) << "one in 200 ms";
  Codec codec;
  Refusal refusal;
  ASSERT_EQ(codec.decode(net.answered.back(), refusal), Reject::kNone);
  EXPECT_EQ(refusal,
            (Refusal{8, false, fixed_text<LeaderName>("process 4711"), 801 * kMillisecond}));
  EXPECT_LT(net.answered.back().size(), datagram(sample_header(8, 1), sample_master()).size());
}

// A master of another version learns no more than that.
TEST_F(PumpTest, AnotherWireVersionMovesNothingAndIsToldOursNotOften) {
  auto other = datagram(sample_header(7, 1), sample_master());
  other[4] = kWireVersion + 1;
  for (int ms = 0; ms < 400; ++ms) {
    net.waiting.push_back({other});
    EXPECT_FALSE(pump.receive(kPumpStart + ms * kMillisecond));
  }
  const Nanos now = kPumpStart + 400 * kMillisecond;
  EXPECT_EQ(rejected(Reject::kVersion), 400u);
  EXPECT_EQ(net.adopted, 0);
  EXPECT_EQ(peer.snapshot().peer_epoch, 0u);
  EXPECT_EQ(peer.snapshot().other_version(now), kWireVersion + 1);
  ASSERT_EQ(net.answered.size(), 2u) << "one in 200 ms";
  EXPECT_LT(net.answered[0].size(), other.size());
  net.waiting.push_back({{other.begin(), other.begin() + kFrameBytes + 1}});
  EXPECT_FALSE(pump.receive(now));
  EXPECT_EQ(net.answered.size(), 2u) << "never with more than was sent";
  MasterPeer master{9};
  for (auto answer : net.answered) {
    EXPECT_NE(master.on_datagram(answer, now), Reject::kRefused) << "of nobody's session";
    answer[4] = kWireVersion + 1;  // as a master of that version sees ours
    EXPECT_EQ(master.on_datagram(answer, now), Reject::kVersion);
  }
  EXPECT_EQ(master.snapshot().other_version(now), kWireVersion + 1);
  EXPECT_EQ(master.snapshot().other_version(now + kSecond), kWireVersion + 1);
  EXPECT_EQ(master.snapshot().other_version(now + kSecond + 1), 0) << "not for ever";
  arrive(1);
  EXPECT_TRUE(pump.receive(now + 1));
  EXPECT_EQ(peer.snapshot().other_version(now + 1), 0) << "one of ours has come since";
}

TEST_F(PumpTest, StrangersAreCountedAndNotRead) {
  arrive(1, false);
  EXPECT_FALSE(pump.receive(kPumpStart));
  EXPECT_EQ(rejected(Reject::kSender), 1u);
  EXPECT_EQ(peer.snapshot().peer_epoch, 0u);
  EXPECT_EQ(net.adopted, 0);
}

TEST_F(PumpTest, WhatWaitedThroughOurOwnStallIsDropped) {
  arrive(1);
  (void)pump.receive(kPumpStart);
  for (std::uint64_t n = 2; n < 12; ++n) arrive(n);
  EXPECT_FALSE(pump.receive(kPumpStart + 20 * kMillisecond + 1));
  EXPECT_EQ(rejected(Reject::kAfterStall), 10u);
  EXPECT_EQ(peer.newest().stop_epoch, 1u);
  arrive(12);
  EXPECT_TRUE(pump.receive(kPumpStart + 22 * kMillisecond));
  EXPECT_EQ(peer.newest().stop_epoch, 12u);
}

TEST_F(PumpTest, APauseWithinTheLimitDropsNothing) {
  arrive(1);
  (void)pump.receive(kPumpStart);
  arrive(2);
  EXPECT_TRUE(pump.receive(kPumpStart + 20 * kMillisecond));
}

TEST_F(PumpTest, AQueueLongerThanABatchIsDroppedToItsEndAfterAStall) {
  (void)pump.receive(kPumpStart);
  for (std::uint64_t n = 1; n <= 300; ++n) arrive(n);
  (void)pump.receive(kPumpStart + kSecond);
  EXPECT_EQ(rejected(Reject::kAfterStall), 256u);
  EXPECT_FALSE(pump.receive(kPumpStart + kSecond));
  EXPECT_EQ(rejected(Reject::kAfterStall), 300u);
  EXPECT_EQ(peer.snapshot().accepted, 0u);
}

TEST_F(PumpTest, AnOversizedDatagramIsRefused) {
  auto bytes = datagram(sample_header(), sample_master());
  bytes.resize(2000);
  net.waiting.push_back({bytes});
  EXPECT_FALSE(pump.receive(kPumpStart));
  EXPECT_EQ(rejected(Reject::kSize), 1u);
}

TEST_F(PumpTest, SendsWhatIsDueAndNoMore) {
  for (Nanos t = 0; t < 10 * kMillisecond; t += kMillisecond / 4) {
    pump.send(kPumpStart + t, sample_slave());
  }
  EXPECT_EQ(net.sent, std::vector<std::size_t>(10, 546));
}

TEST_F(PumpTest, AStateThatIsNoLongerTrueIsNotSentAndDoesNotHurryTheSchedule) {
  pump.send(kPumpStart, sample_slave(), kPumpStart);
  pump.send(kPumpStart + kMillisecond, sample_slave(), kPumpStart);
  EXPECT_EQ(net.sent.size(), 1u);
  EXPECT_EQ(peer.snapshot().withheld, 1u);
  EXPECT_EQ(peer.snapshot().unsendable, 0u);
  EXPECT_EQ(peer.wait_time(kPumpStart + kMillisecond), kMillisecond);
  pump.send(kPumpStart + 2 * kMillisecond, sample_slave(), kPumpStart + 2 * kMillisecond);
  EXPECT_EQ(net.sent.size(), 2u);
}

TEST_F(PumpTest, WhatThePeerSendsAndWhatIsSentIsLeftInATap) {
  const auto tap = std::make_unique<PacketTap>();
  pump.keep(tap.get());
  arrive(1);
  arrive(2, false);
  net.waiting.push_back({{1, 2, 3}, true});
  const std::vector<std::uint8_t> first = net.waiting.front().bytes;
  EXPECT_TRUE(pump.receive(kPumpStart));
  pump.send(kPumpStart + 1, SlaveState());
  KeptPacket packet;
  const auto kept = [&packet] {
    return std::vector<std::uint8_t>(packet.kept().begin(), packet.kept().end());
  };
  ASSERT_TRUE(tap->take(packet));
  EXPECT_EQ(packet.way, PacketWay::kLinkIn);
  EXPECT_EQ(packet.at, kPumpStart);
  EXPECT_EQ(kept(), first);
  // Not the stranger's. What the peer sends and is no datagram of the link is.
  ASSERT_TRUE(tap->take(packet));
  EXPECT_EQ(kept(), (std::vector<std::uint8_t>{1, 2, 3}));
  ASSERT_TRUE(tap->take(packet));
  EXPECT_EQ(packet.way, PacketWay::kLinkOut);
  EXPECT_EQ(packet.at, kPumpStart + 1);
  ASSERT_EQ(net.sent.size(), 1u);
  EXPECT_EQ(packet.size, net.sent.front());
  EXPECT_FALSE(tap->take(packet));
}

}  // namespace
}  // namespace handrail
