#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <openssl/ssl.h>

#include <map>
#include <random>

#include "server/link/arrivals.h"
#include "tests/support/made_up_net/made_up_net.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

using test::Bytes;
using test::SecurePair;
using ::testing::Contains;
using ::testing::Not;

const Bytes kHeldBack(500, 0x55), kOthers(500, 0x17);

// A pair in which one datagram of `End` is held back while so many others come.
struct HeldBack {
  SecurePair pair;
  test::MadeUpNet::Datagram datagram;

  bool from_master(int others) {
    if (!pair.connect()) return false;
    pair.net.passes = [this](test::MadeUpNet::Datagram& d) {
      datagram = d;
      return false;
    };
    const bool sent = pair.master.send(kHeldBack);
    pair.net.passes = [](auto&) { return true; };
    for (int i = 0; i < others; ++i) (void)pair.say(kOthers);
    return sent;
  }
  void arrive(const test::MadeUpNet::Datagram& what) {
    pair.net.put(what);
    pair.step();
  }
};

TEST(RecordOpener, WhatComesBehindHundredsOfOthersIsOpenedOnce) {
  for (const int others : {1, 63, 64, 65, 100, 199, 200}) {
    HeldBack held;
    ASSERT_TRUE(held.from_master(others));
    held.arrive(held.datagram);
    ASSERT_EQ(held.pair.slave_got.size(), static_cast<std::size_t>(others) + 1) << others;
    EXPECT_EQ(held.pair.slave_got.back(), kHeldBack) << others;
    for (int i = 0; i < 10; ++i) held.arrive(held.datagram);
    EXPECT_EQ(held.pair.slave_got.size(), static_cast<std::size_t>(others) + 1) << others;
    EXPECT_EQ(held.pair.slave.counts().strangers, 10u) << others;
  }
}

TEST(RecordOpener, WhatTheLinkDoesNotCountAnyMoreIsNotOpened) {
  HeldBack held;
  ASSERT_TRUE(held.from_master(static_cast<int>(Arrivals::kLatest) + 1));
  held.arrive(held.datagram);
  EXPECT_THAT(held.pair.slave_got, Not(Contains(kHeldBack)));
  EXPECT_EQ(held.pair.slave.counts().strangers, 1u);
}

TEST(RecordOpener, WhatHasComeIsNotOpenedAgainWhenItIsLate) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  std::vector<test::MadeUpNet::Datagram> recorded;
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(pair.say(kOthers));
    recorded.push_back(pair.net.sent.back());
  }
  ASSERT_EQ(pair.slave_got.size(), 300u);
  for (const auto& datagram : recorded) {
    pair.net.put(datagram);
    pair.step();
  }
  EXPECT_EQ(pair.slave_got.size(), 300u);
  EXPECT_EQ(pair.slave.counts().strangers, 300u);
}

TEST(RecordOpener, NoChangedBitPassesAndTheWholeOneStillDoes) {
  HeldBack held;
  ASSERT_TRUE(held.from_master(100));
  const std::size_t before = held.pair.slave_got.size();
  for (std::size_t bit = 0; bit < 8 * held.datagram.bytes.size(); ++bit) {
    auto broken = held.datagram;
    broken.bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    held.arrive(broken);
    ASSERT_EQ(held.pair.slave_got.size(), before) << "bit " << bit;
    ASSERT_NE(held.pair.slave.leader(), nullptr) << "bit " << bit;
  }
  held.arrive(held.datagram);
  EXPECT_EQ(held.pair.slave_got.back(), kHeldBack);
}

// The number that counts is that of the record that was opened: no made up one before it.
TEST(RecordOpener, OfADatagramOfTwoRecordsNothingIsTaken) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kOthers));
  pair.net.passes = [](auto& d) {
    Bytes made_up = d.bytes;
    std::fill(made_up.begin() + 5, made_up.begin() + 11, std::uint8_t{0x7f});  // its number
    d.bytes.insert(d.bytes.begin(), made_up.begin(), made_up.end());
    return true;
  };
  ASSERT_TRUE(pair.say(kOthers));
  pair.net.passes = [](auto&) { return true; };
  const std::size_t before = pair.slave_got.size();
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(pair.say(kOthers));
  EXPECT_EQ(pair.slave_got.size(), before + 10);
}

TEST(RecordOpener, TheMasterOpensThoseOfTheSlaveAndTheLongerKeyDoesAsWell) {
  for (const char* suite : {"ECDHE-ECDSA-AES128-GCM-SHA256", "ECDHE-ECDSA-AES256-GCM-SHA384"}) {
    SecurePair pair;
    ASSERT_EQ(SSL_CTX_set_cipher_list(pair.master_context->get(), suite), 1);
    ASSERT_TRUE(pair.connect());
    ASSERT_TRUE(pair.say(kOthers));
    test::MadeUpNet::Datagram held;
    pair.net.passes = [&held](auto& d) {
      held = d;
      return false;
    };
    ASSERT_TRUE(pair.slave.send(kHeldBack));
    pair.net.passes = [](auto&) { return true; };
    for (int i = 0; i < 150; ++i) {
      (void)pair.slave.send(kOthers);
      pair.step();
    }
    pair.net.put(held);
    pair.step();
    EXPECT_EQ(pair.master_got.size(), 151u) << suite;
    EXPECT_EQ(pair.master_got.back(), kHeldBack) << suite;
  }
}

// 50 +- 50 ms, a datagram a millisecond: OpenSSL alone takes three of four.
TEST(RecordOpener, ALinkThatIsLateByATenthOfASecondLosesNothing) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  const auto seed = std::random_device{}();
  Random random(seed);
  std::multimap<Nanos, test::MadeUpNet::Datagram> under_way;
  pair.net.passes = [&](auto& d) {
    under_way.emplace(pair.now + static_cast<Nanos>(random.uniform() * 100e6), d);
    return false;
  };
  for (int i = 0; i < 2000; ++i) {
    if (i < 1800) (void)pair.master.send(kOthers);
    while (!under_way.empty() && under_way.begin()->first <= pair.now) {
      if (under_way.begin()->second.to == pair.slave_socket.own()) {
        pair.net.put(under_way.begin()->second);
      }
      under_way.erase(under_way.begin());
    }
    pair.step();
  }
  pair.net.passes = [](auto&) { return true; };  // at its end the pair says so
  EXPECT_EQ(pair.slave_got.size(), 1800u) << "seed " << seed;
}

TEST(RecordOpener, OpeningOneAllocatesNothing) {
  HeldBack held;
  ASSERT_TRUE(held.from_master(100));
  held.pair.slave_socket.quiet = true;
  std::array<std::uint8_t, 549> buffer{};
  bool taken = false;
  {
    const test::NoAllocation guard("a late datagram opened");
    held.pair.slave_socket.prepared = &held.datagram;
    const auto arrival = held.pair.slave.receive(buffer);
    taken = arrival && arrival->from_peer;
  }
  EXPECT_TRUE(taken);
}

}  // namespace
}  // namespace handrail
