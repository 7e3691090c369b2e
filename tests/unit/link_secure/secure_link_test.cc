#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "server/link/codec.h"
#include "tests/support/made_up_net/made_up_net.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

using test::Bytes;
using test::SecurePair;
using ::testing::ElementsAre;
using Problem = DtlsChannel::Problem;

const Bytes kCommand(500, 0x17), kState(540, 0x42);

TEST(SecureLink, CarriesBothWaysBetweenTwoThatTrustEachOther) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kCommand));
  ASSERT_TRUE(pair.slave.send(kState));
  pair.step();
  EXPECT_THAT(pair.slave_got, ElementsAre(kCommand));
  EXPECT_THAT(pair.master_got, ElementsAre(kState));
  EXPECT_EQ(pair.slave.peer_name(), "desk");
  EXPECT_EQ(pair.master.peer_name(), "cell");
}

TEST(SecureLink, NothingOfWhatIsSaidCanBeReadOnTheWire) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kCommand));
  const Bytes run(16, 0x17);
  for (const auto& datagram : pair.net.sent) {
    EXPECT_EQ(std::search(datagram.bytes.begin(), datagram.bytes.end(), run.begin(), run.end()),
              datagram.bytes.end());
  }
}

TEST(SecureLink, ADatagramFitsIntoWhatIpv6CarriesEverywhere) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(Bytes(kMaxDatagram, 1)));
  for (const auto& datagram : pair.net.sent) EXPECT_LE(datagram.bytes.size() + 48, 1280u);
  EXPECT_EQ(pair.net.sent.back().bytes.size(), kMaxDatagram + 37u);
}

TEST(SecureLink, AKeyThatTheSlaveDoesNotKnowIsRefusedAndBothSidesSayWhose) {
  SecurePair pair;
  pair.slave.set_trusted(TrustList());
  EXPECT_FALSE(pair.connect());
  EXPECT_EQ(pair.master.problem(), Problem::kWeAre);
  EXPECT_EQ(pair.slave.refused().problem, Problem::kUntrusted);
  EXPECT_TRUE(pair.slave.refused().peer.shown);
  EXPECT_EQ(pair.slave.refused().peer.key, pair.master_key.public_key());
  EXPECT_EQ(pair.slave.refused().from, pair.master_socket.own());
  EXPECT_EQ(pair.slave.counts().sessions, 0u);
}

TEST(SecureLink, ASlaveWithAnotherKeyThanThePinnedIsRefused) {
  SecurePair pair;
  pair.master.set_trusted(test::trusting({{"cell", Role::kSlave, pair.master_key.public_key()}}));
  EXPECT_FALSE(pair.connect());
  EXPECT_EQ(pair.master.problem(), Problem::kUntrusted);
  EXPECT_EQ(pair.master.refused().key, pair.slave_key.public_key());
}

TEST(SecureLink, AKnownKeyWithAnotherRoleIsRefused) {
  for (const Role role : {Role::kSlave, Role::kOperator, Role::kObserver}) {
    SecurePair pair;
    pair.slave.set_trusted(test::trusting({{"desk", role, pair.master_key.public_key()}}));
    EXPECT_FALSE(pair.connect()) << role_text(role);
    EXPECT_EQ(pair.master.problem(), Problem::kWeAre);
  }
}

TEST(SecureLink, AKeyThatIsTakenOffTheListEndsItsSessionAtOnce) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kCommand));
  pair.slave.set_trusted(TrustList());
  EXPECT_EQ(pair.slave.leader(), nullptr);
  EXPECT_FALSE(pair.slave.send(kState));
  (void)pair.master.send(kCommand);
  pair.step();
  EXPECT_EQ(pair.slave_got.size(), 1u);
  EXPECT_EQ(pair.master.session(), nullptr);  // it was told
}

TEST(SecureLink, AKeyThatIsTakenOffTheListDuringItsHandshakeOpensNoSession) {
  // After each number of datagrams that have passed.
  int opened = 0;
  for (int passed = 0; passed < 12; ++passed) {
    SecurePair pair;
    int left = passed;
    pair.net.passes = [&](auto&) { return left-- > 0; };
    for (int i = 0; i < 20; ++i) pair.step();
    opened += pair.master.session() != nullptr ? 1 : 0;
    pair.master.set_trusted(TrustList());
    EXPECT_EQ(pair.master.session(), nullptr);
    pair.net.passes = [](auto&) { return true; };
    for (int i = 0; i < 300; ++i) {
      pair.step();
      ASSERT_EQ(pair.master.session(), nullptr) << passed;
    }
  }
  EXPECT_GT(opened, 0);
}

TEST(SecureLink, TheSessionSurvivesAChangeOfTheMastersAddress) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kCommand));
  pair.master_socket.move_to(test::address_of(9, 1234));
  ASSERT_TRUE(pair.say(kCommand));
  EXPECT_EQ(pair.slave_got.size(), 2u);
  ASSERT_TRUE(pair.slave.send(kState));
  pair.step();
  EXPECT_EQ(pair.master_got.size(), 1u);
  EXPECT_EQ(pair.slave.counts().sessions, 1u);
}

TEST(SecureLink, ARecordingFromAnotherAddressDoesNotMoveTheSession) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kCommand));
  auto recorded = pair.net.sent.back();
  recorded.from = test::address_of(66, 6666);
  pair.net.put(recorded);
  pair.step();
  EXPECT_EQ(pair.slave.leader()->address(), pair.master_socket.own());
}

TEST(SecureLink, ASlaveThatWasStartedAnewIsFoundAgain) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kCommand));
  ASSERT_TRUE(pair.slave.send(kState));
  pair.step();
  SecureServer second(*pair.slave_context, pair.slave_socket);
  std::vector<Bytes> got;
  int strangers = 0, steps = 0;
  for (; steps < 3000 && got.empty(); ++steps) {
    (void)pair.master.send(kCommand);
    pair.now += kMillisecond;
    pair.master.tick(pair.now);
    second.tick(pair.now);
    SecurePair::drain(second, got, strangers);
    SecurePair::drain(pair.master, pair.master_got, pair.master_strangers);
  }
  EXPECT_FALSE(got.empty());
  EXPECT_LT(steps, 1100);  // a second of silence, then a handshake
}

TEST(SecureLink, ASlaveThatHasMovedIsFoundWhereItsNameSaysThatItIs) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kCommand));
  ASSERT_TRUE(pair.slave.send(kState));
  pair.step();
  EXPECT_FALSE(pair.master.calls());
  pair.slave_socket.move_to(test::address_of(7, 47002));
  int ms = 0;
  for (; ms < 3000 && !pair.master.calls(); ++ms) (void)pair.say(kCommand);
  EXPECT_LT(ms, 1100);
  pair.master.set_addresses({pair.slave_socket.own()});
  const std::size_t before = pair.slave_got.size();
  for (; ms < 3000 && pair.slave_got.size() == before; ++ms) (void)pair.say(kCommand);
  EXPECT_LT(ms, 2200);
}

TEST(SecureLink, ARefusalIsNotForgottenForOneAttemptWithoutAnAnswer) {
  SecurePair pair;
  pair.slave.set_trusted(TrustList());
  EXPECT_FALSE(pair.connect());
  EXPECT_EQ(pair.master.problem(), Problem::kWeAre);
  pair.net.passes = [](auto&) { return false; };
  const auto attempts = pair.master.counts().attempts;
  while (pair.master.counts().attempts < attempts + 2) pair.step();
  EXPECT_EQ(pair.master.problem(), Problem::kWeAre);
  while (pair.master.counts().attempts < attempts + 3) pair.step();
  EXPECT_EQ(pair.master.problem(), Problem::kNoAnswer);
}

TEST(SecureLink, AMasterThatWasStartedAnewAtTheSamePortGetsASessionAndLeads) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kCommand));
  SecureClient second(*pair.master_context, pair.master_socket);
  second.set_addresses({pair.slave_socket.own()});
  std::vector<Bytes> got;
  int strangers = 0, steps = 0;
  for (; steps < 100 && second.session() == nullptr; ++steps) {
    pair.now += kMillisecond;
    second.tick(pair.now);
    pair.slave.tick(pair.now);
    SecurePair::drain(pair.slave, pair.slave_got, pair.slave_strangers);
    SecurePair::drain(second, got, strangers);
  }
  EXPECT_LT(steps, 20);
  ASSERT_TRUE(second.send(kState));
  SecurePair::drain(pair.slave, pair.slave_got, pair.slave_strangers);
  EXPECT_THAT(pair.slave_got, ElementsAre(kCommand, kState));
}

// OpenSSL's clock is gettimeofday(): the test's own stands in its place (made_up_net.cc).
TEST(SecureLink, AtThirtyPercentLossEachWayAHandshakeTakesLessThanASecondInNineteenOfTwenty) {
  const auto seed = std::random_device{}();
  Random random(seed);
  std::vector<int> took;
  for (int run = 0; run < 100; ++run) {
    SecurePair pair;
    pair.net.passes = [&](auto&) { return random.uniform() >= 0.3; };
    int ms = 0;
    for (; ms < 10000 && (pair.master.session() == nullptr || pair.slave_got.empty()); ++ms) {
      pair.step();
      (void)pair.master.send(kCommand);
    }
    took.push_back(ms);
  }
  std::sort(took.begin(), took.end());
  EXPECT_LE(took[94], 1000) << "seed " << seed << ": median " << took[50] << " ms, worst "
                            << took[99] << " ms";
}

// Three round trips, and the time that the first of them was not waited for.
TEST(SecureLink, AFarSlaveGetsASessionAndKeepsIt) {
  for (const Nanos one_way : {20, 100, 200, 300, 500, 600, 1000, 1500}) {
    SecurePair pair;
    std::multimap<Nanos, test::MadeUpNet::Datagram> under_way;
    pair.net.passes = [&](auto& d) {
      under_way.emplace(pair.now + one_way * kMillisecond, d);
      return false;
    };
    const auto step = [&] {
      while (!under_way.empty() && under_way.begin()->first <= pair.now) {
        pair.net.put(under_way.begin()->second);
        under_way.erase(under_way.begin());
      }
      (void)pair.master.send(kCommand);
      (void)pair.slave.send(kState);
      pair.step();
    };
    Nanos took = 0;
    for (; took < 30'000 && pair.master_got.empty(); ++took) step();
    EXPECT_LE(took, 8 * one_way + 4000) << one_way << " ms each way";
    for (int ms = 0; ms < 10'000; ++ms) step();
    EXPECT_EQ(pair.master.counts().sessions, 1u) << one_way << " ms each way";
    EXPECT_GT(pair.master_got.size(), 9000u) << one_way << " ms each way";
    pair.net.passes = [](auto&) { return true; };  // at its end the pair says so
  }
}

TEST(SecureLink, AnAttemptSurvivesACalendarThatLeapsByYears) {
  for (const Nanos leap : {-400 * 24 * 3600 * kSecond, 4000 * 24 * 3600 * kSecond}) {
    SecurePair pair;
    int lost = 1;
    pair.net.passes = [&](auto&) { return lost-- != 0; };
    for (int ms = 0; ms < 20; ++ms) {
      pair.step();
    }
    pair.net.passes = [](auto&) { return true; };
    test::wall_clock += leap;
    int ms = 20;
    for (; ms < 5000 && pair.master.session() == nullptr; ++ms) {
      pair.step();
    }
    EXPECT_LE(ms, 1100) << leap;
  }
}

TEST(SecureLink, AValidDatagramAllocatesNothing) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kCommand));
  ASSERT_TRUE(pair.slave.send(kState));
  pair.step();
  std::vector<test::MadeUpNet::Datagram> waiting;
  pair.net.passes = [](auto&) { return false; };
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(pair.master.send(kCommand));
    waiting.push_back(pair.net.sent.back());
  }
  pair.master_socket.quiet = pair.slave_socket.quiet = true;
  std::array<std::uint8_t, 549> buffer{};
  int taken = 0, sent = 0;
  {
    const test::NoAllocation guard("a datagram opened and sealed");
    for (const auto& datagram : waiting) {
      pair.slave_socket.prepared = &datagram;
      const auto arrival = pair.slave.receive(buffer);
      taken += arrival && arrival->from_peer;
      pair.slave.adopt_sender();
      sent += pair.slave.send(kState);
      sent += pair.master.send(kCommand);
      pair.slave.tick(pair.now);
      pair.master.tick(pair.now);
    }
  }
  EXPECT_EQ(taken, 100);
  EXPECT_EQ(sent, 200);
}

}  // namespace

}  // namespace handrail
