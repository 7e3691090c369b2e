// The made-up network: each fault does what its level says, and the same seed does it again.
#include "server/lab/cell/virtual_link.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "server/base/fnv.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

struct Taken {
  std::uint32_t number = 0;  // as written into the bytes
  Nanos at = 0;
};

std::array<std::uint8_t, 64> bytes_of(std::uint32_t number) {
  std::array<std::uint8_t, 64> bytes{};
  for (int i = 0; i < 4; ++i) {
    bytes[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(number >> (8 * i));
  }
  return bytes;
}

// Numbers 0 to `count` - 1 sent a millisecond apart; everything received, at the time it came.
std::vector<Taken> pass(VirtualLink& link, std::uint32_t count) {
  std::vector<Taken> out;
  std::array<std::uint8_t, 600> buffer{};
  Nanos now = 0;
  const auto take = [&](Nanos until) {
    while (link.next_due() <= until) {
      now = link.next_due();
      link.at(now);
      while (const auto arrival = link.slave().receive(buffer)) {
        EXPECT_TRUE(arrival->from_peer);
        const std::uint32_t number = static_cast<std::uint32_t>(
            buffer[0] | (buffer[1] << 8) | (buffer[2] << 16) | (buffer[3] << 24));
        out.push_back({number, now});
      }
    }
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    const Nanos at = Nanos{i} * kMillisecond;
    take(at);
    link.at(at);
    EXPECT_TRUE(link.master().send(bytes_of(i)));
    link.to_slave().clear_deliveries();
  }
  take(kForever - 1);
  return out;
}

TEST(VirtualLinkTest, WithoutFaultsEverythingComesInOrderAtOnce) {
  VirtualLink link(1);
  const auto got = pass(link, 1000);
  ASSERT_EQ(got.size(), 1000u);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    EXPECT_EQ(got[i].number, i);
    EXPECT_EQ(got[i].at, Nanos{i} * kMillisecond);
  }
}

TEST(VirtualLinkTest, DelayAndJitterStayInTheirBandAndKeepTheOrder) {
  VirtualLink link(2);
  link.to_slave().faults.delay = 50 * kMillisecond;
  link.to_slave().faults.jitter = 20 * kMillisecond;
  const auto got = pass(link, 10'000);
  ASSERT_EQ(got.size(), 10'000u);
  Nanos shortest = kForever;
  Nanos longest = 0;
  for (std::uint32_t i = 0; i < got.size(); ++i) {
    ASSERT_EQ(got[i].number, i);
    const Nanos took = got[i].at - Nanos{i} * kMillisecond;
    shortest = std::min(shortest, took);
    longest = std::max(longest, took);
  }
  // Keeping the order makes the early ones wait: the shortest is never the band's lower end.
  EXPECT_GE(shortest, 30 * kMillisecond);
  EXPECT_LE(longest, 70 * kMillisecond);
  EXPECT_GT(longest, 69 * kMillisecond);
}

TEST(VirtualLinkTest, IndependentLossHasItsShareAndShortGaps) {
  VirtualLink link(3);
  link.to_slave().faults.loss = 0.3;
  const auto got = pass(link, 100'000);
  EXPECT_NEAR(static_cast<double>(got.size()), 70'000.0, 4.0 * std::sqrt(21'000.0));
  int pairs = 0;
  for (std::size_t i = 1; i < got.size(); ++i) pairs += got[i].number == got[i - 1].number + 1;
  EXPECT_NEAR(pairs, 49'000, 600);  // neighbours are lost independently: 0.7 * 0.7
  EXPECT_EQ(link.to_slave().counters().lost, 100'000 - got.size());
}

TEST(VirtualLinkTest, BurstsHaveTheirMeanLengthAndShare) {
  VirtualLink link(4);
  link.to_slave().faults.burst_enter = 0.005;
  link.to_slave().faults.burst_leave = 0.1;
  const auto got = pass(link, 400'000);
  double bursts = 0;
  double lost = 0;
  for (std::size_t i = 1; i < got.size(); ++i) {
    const std::uint32_t gap = got[i].number - got[i - 1].number - 1;
    bursts += gap > 0;
    lost += gap;
  }
  EXPECT_NEAR(lost / bursts, 10.0, 1.0);
  EXPECT_NEAR(lost / 400'000.0, 0.005 / 0.105, 0.005);
}

TEST(VirtualLinkTest, DuplicatesComeTwiceWithTheSameBytes) {
  VirtualLink link(5);
  link.to_slave().faults.duplicate = 0.25;
  link.to_slave().faults.delay = 10 * kMillisecond;
  const auto got = pass(link, 20'000);
  std::vector<int> times(20'000, 0);
  for (const Taken& taken : got) ++times[taken.number];
  int twice = 0;
  for (const int n : times) {
    ASSERT_GE(n, 1);
    ASSERT_LE(n, 2);
    twice += n == 2;
  }
  EXPECT_NEAR(twice, 5000, 250);
}

TEST(VirtualLinkTest, ReorderedOnesComeLateAndTheOthersKeepTheirOrder) {
  VirtualLink link(6);
  link.to_slave().faults.reorder = 0.1;
  link.to_slave().faults.reorder_by = 5 * kMillisecond;
  const auto got = pass(link, 20'000);
  ASSERT_EQ(got.size(), 20'000u);
  int late = 0;
  for (const Taken& taken : got) {
    const Nanos took = taken.at - Nanos{taken.number} * kMillisecond;
    EXPECT_TRUE(took == 0 || took == 5 * kMillisecond);
    late += took > 0;
  }
  EXPECT_NEAR(late, 2000, 180);
}

TEST(VirtualLinkTest, ReplaysAreOldDatagramsAsOftenAsAsked) {
  VirtualLink link(7);
  link.to_slave().faults.replay = 2.5;
  const auto got = pass(link, 10'000);
  EXPECT_NEAR(static_cast<double>(got.size()), 35'000.0, 300.0);
  std::uint32_t newest = 0;
  std::uint32_t oldest = 0;
  for (const Taken& taken : got) {
    newest = std::max(newest, taken.number);
    oldest = std::max(oldest, newest - taken.number);
  }
  EXPECT_LT(oldest, WaySize{}.history);
  EXPECT_GT(oldest, WaySize{}.history * 9 / 10);
}

TEST(VirtualLinkTest, CorruptedOnesAreTheLengthTheyWereAndSaidToBeForged) {
  VirtualLink link(8);
  link.to_slave().faults.corrupt = 1.0;
  link.at(0);
  std::array<std::uint8_t, 600> buffer{};
  const std::array<std::uint8_t, 1> sent{7};  // one bit in eight is drawn twice in a row
  int changed = 0;
  for (int i = 0; i < 200; ++i) {
    EXPECT_TRUE(link.master().send(sent));
    link.at(0);
    const auto arrival = link.slave().receive(buffer);
    ASSERT_TRUE(arrival.has_value());
    ASSERT_EQ(arrival->size, sent.size());
    changed += !std::equal(sent.begin(), sent.end(), buffer.begin());
  }
  EXPECT_EQ(changed, 200);
  for (const Delivery& delivery : link.to_slave().deliveries()) EXPECT_FALSE(delivery.authentic());
}

// 64 + 28 bytes are 736 bits: at 368 kbit/s two milliseconds each, so every second one waits and
// the queue grows to its end.
TEST(VirtualLinkTest, ARateLimitQueuesUpToItsLengthThenDrops) {
  VirtualLink link(9);
  link.to_slave().faults.rate_bps = 368'000;
  link.to_slave().faults.queue = 100 * kMillisecond;
  const auto got = pass(link, 5000);
  EXPECT_NEAR(static_cast<double>(got.size()), 2500.0, 60.0);
  Nanos longest = 0;
  for (std::size_t i = 1; i < got.size(); ++i) {
    EXPECT_GE(got[i].at - got[i - 1].at, 2 * kMillisecond);
    longest = std::max(longest, got[i].at - Nanos{got[i].number} * kMillisecond);
  }
  EXPECT_NEAR(to_seconds(longest), 0.102, 0.002);
}

TEST(VirtualLinkTest, WhatNobodyTakesWaitsAsInASocketAndTheRestIsDropped) {
  VirtualLink link(10);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    link.at(Nanos{i} * kMillisecond);
    EXPECT_TRUE(link.master().send(bytes_of(i)));
  }
  link.at(kSecond);
  std::array<std::uint8_t, 600> buffer{};
  std::size_t got = 0;
  while (link.slave().receive(buffer)) EXPECT_EQ(buffer[0], got++ % 256);
  EXPECT_EQ(got, WaySize{}.socket_queue);
  EXPECT_TRUE(link.master().send(bytes_of(1)));
  link.at(kSecond);
  link.to_slave().flush();
  EXPECT_FALSE(link.slave().receive(buffer).has_value());
}

LinkFaults everything() {
  LinkFaults faults;
  faults.delay = 20 * kMillisecond;
  faults.jitter = 15 * kMillisecond;
  faults.loss = 0.1;
  faults.burst_enter = 0.01;
  faults.burst_leave = 0.2;
  faults.duplicate = 0.2;
  faults.reorder = 0.2;
  faults.reorder_by = 5 * kMillisecond;
  faults.replay = 0.5;
  return faults;
}

std::uint64_t fingerprint(std::uint64_t seed, const LinkFaults& faults) {
  VirtualLink link(seed);
  link.to_slave().faults = faults;
  Fnv fnv;
  for (const Taken& taken : pass(link, 5000)) {
    fnv.u64(taken.number).u64(static_cast<std::uint64_t>(taken.at));
  }
  return fnv.value();
}

TEST(VirtualLinkTest, TheSameSeedDoesTheSameAndAnotherSomethingElse) {
  EXPECT_EQ(fingerprint(1, everything()), fingerprint(1, everything()));
  EXPECT_NE(fingerprint(1, everything()), fingerprint(2, everything()));
}

// Otherwise a sweep over one fault's level would compare different draws of all the others.
TEST(VirtualLinkTest, OneFaultsLevelDoesNotDealTheOthersAnew) {
  LinkFaults some;
  some.loss = 0.2;
  VirtualLink plain(3);
  plain.to_slave().faults = some;
  some.duplicate = 0.5;
  some.corrupt = 0.3;
  some.replay = 1.5;
  VirtualLink more(3);
  more.to_slave().faults = some;
  pass(plain, 2000);
  pass(more, 2000);
  EXPECT_EQ(plain.to_slave().counters().lost, more.to_slave().counters().lost);
}

TEST(VirtualLinkTest, WorksWithoutTouchingTheHeap) {
  const auto link = std::make_unique<VirtualLink>(11);
  link->to_slave().faults = everything();
  std::array<std::uint8_t, 600> buffer{};
  test::NoAllocation guard("datagrams through the virtual link");
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    link->at(Nanos{i} * kMillisecond);
    (void)link->master().send(bytes_of(i));
    while (link->slave().receive(buffer)) link->to_slave().clear_deliveries();
  }
}

}  // namespace
}  // namespace handrail
