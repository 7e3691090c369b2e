// A key is changed while the link runs: nothing is lost, and there is no way back to the old one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "tests/support/made_up_net/made_up_net.h"

namespace handrail {
namespace {

using test::Bytes;
using test::SecurePair;
using Problem = DtlsChannel::Problem;

const Bytes kThere(500, 0x17), kBack(540, 0x42);

class KeyChange : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(pair.connect());
    ASSERT_TRUE(pair.say(kThere));
    ASSERT_TRUE(pair.slave.send(kBack));
    pair.step();
    (void)pair.slave.take_begun();
    (void)pair.master.take_begun();
  }
  // Both ends speak every millisecond.
  void run(Nanos time) {
    for (const Nanos end = pair.now + time; pair.now < end;) {
      sent += pair.master.send(kThere) ? 1u : 0u;
      answered += pair.slave.send(kBack) ? 1u : 0u;
      pair.step();
    }
  }
  Trusted cell(const PublicKey& key) const { return {"cell", Role::kSlave, key}; }
  Trusted desk(const PublicKey& key) const { return {"desk", Role::kMaster, key}; }
  Trusted cell_with_next() const {
    return {"cell", Role::kSlave, pair.slave_key.public_key(), next.public_key()};
  }
  Trusted desk_with_next() const {
    return {"desk", Role::kMaster, pair.master_key.public_key(), next.public_key()};
  }

  // Before the pair, which speaks to its end.
  std::deque<std::pair<Nanos, test::MadeUpNet::Datagram>> under_way;
  SecurePair pair;
  const OwnKey next = *OwnKey::generate();
  std::size_t sent = 1, answered = 1;
};

TEST_F(KeyChange, OfASlaveMovesTheSessionOverAndNoDatagramIsLost) {
  ASSERT_TRUE(pair.slave.set_own(pair.slave_key, next));
  run(kSecond);
  EXPECT_EQ(pair.master.session()->peer().key, pair.slave_key.public_key());
  EXPECT_EQ(pair.slave.counts().sessions, 1u);
  pair.master.set_trusted(test::trusting({cell_with_next()}));
  run(kSecond);
  EXPECT_EQ(pair.master.session()->peer().key, next.public_key());
  EXPECT_EQ(pair.slave.counts().sessions, 2u);
  EXPECT_EQ(pair.slave_got.size(), sent);
  EXPECT_GE(answered, 2000u - 2);
  EXPECT_EQ(pair.master_got.size(), answered);
  // Both ends know which keys were shown, and tell it once.
  for (const auto& begun : {pair.slave.take_begun(), pair.master.take_begun()}) {
    ASSERT_TRUE(begun);
  }
  EXPECT_FALSE(pair.slave.take_begun() || pair.master.take_begun());
}

TEST_F(KeyChange, NeitherSideHearsAGapOverALongWay) {
  constexpr Nanos kWay = 80 * kMillisecond;
  pair.net.passes = [this](test::MadeUpNet::Datagram& datagram) {
    under_way.emplace_back(pair.now + kWay, datagram);
    return false;
  };
  const OwnKey masters_next = *OwnKey::generate();
  ASSERT_TRUE(pair.slave.set_own(pair.slave_key, next));
  ASSERT_TRUE(pair.master.set_own(pair.master_key, masters_next));
  pair.master.set_trusted(test::trusting({cell_with_next()}));
  pair.slave.set_trusted(test::trusting(
      {{"desk", Role::kMaster, pair.master_key.public_key(), masters_next.public_key()}}));
  std::size_t at_master = 0, at_slave = 0;
  Nanos master_heard = pair.now, slave_heard = pair.now;
  Nanos worst_at_master = 0, worst_at_slave = 0;
  for (const Nanos end = pair.now + 2 * kSecond; pair.now < end;) {
    run(kMillisecond);
    // Each side retires the old keys as soon as it may.
    if (pair.master.take_begun()) {
      pair.master.set_trusted(test::trusting({cell(next.public_key())}));
      ASSERT_TRUE(pair.master.set_own(masters_next, std::nullopt));
    }
    if (pair.slave.take_begun()) {
      pair.slave.set_trusted(test::trusting({desk(masters_next.public_key())}));
      ASSERT_TRUE(pair.slave.set_own(next, std::nullopt));
    }
    for (; !under_way.empty() && under_way.front().first <= pair.now; under_way.pop_front()) {
      pair.net.put(under_way.front().second);
    }
    if (pair.master_got.size() != std::exchange(at_master, pair.master_got.size())) {
      worst_at_master = std::max(worst_at_master, pair.now - std::exchange(master_heard, pair.now));
    }
    if (pair.slave_got.size() != std::exchange(at_slave, pair.slave_got.size())) {
      worst_at_slave = std::max(worst_at_slave, pair.now - std::exchange(slave_heard, pair.now));
    }
  }
  EXPECT_EQ(pair.slave.leader()->own(), next.public_key());
  EXPECT_EQ(pair.master.session()->own(), masters_next.public_key());
  // The first comes after the way.
  EXPECT_LE(worst_at_master, kWay + 5 * kMillisecond);
  EXPECT_LE(worst_at_slave, kWay + 5 * kMillisecond);
  EXPECT_GT(pair.master_got.size(), 1900u);
}

TEST_F(KeyChange, OfAMasterIsTriedUntilTheSlaveTrustsItAndTheOldSessionServes) {
  ASSERT_TRUE(pair.master.set_own(pair.master_key, next));
  run(25 * kSecond);
  EXPECT_EQ(pair.slave.counts().sessions, 1u);
  EXPECT_EQ(pair.slave.counts().untrusted, 3u);  // at once, after 10 s and after 20
  EXPECT_EQ(pair.slave.refused().peer.key, next.public_key());
  EXPECT_EQ(pair.master.problem(), Problem::kNone);
  pair.slave.set_trusted(test::trusting({desk_with_next()}));
  run(6 * kSecond);
  EXPECT_EQ(pair.slave.leader()->peer().key, next.public_key());
  EXPECT_EQ(pair.master.session()->own(), next.public_key());
  EXPECT_EQ(pair.slave_got.size(), sent);
  EXPECT_GE(answered, 31000u - 2);
  const auto begun = pair.slave.take_begun();
  ASSERT_TRUE(begun);
  EXPECT_EQ(begun->theirs, next.public_key());
  EXPECT_EQ(begun->ours, pair.slave_key.public_key());
  EXPECT_EQ(pair.master.take_begun()->ours, next.public_key());
}

TEST_F(KeyChange, AMasterIsNotShownAKeyThatItDoesNotAskFor) {
  ASSERT_TRUE(pair.slave.set_own(pair.slave_key, next));
  // ... and starts anew: it has the old one pinned.
  SecureClient again(*pair.master_context, pair.master_socket);
  again.set_addresses({pair.slave_socket.own()});
  std::vector<Bytes> got;
  int strangers = 0;
  for (int i = 0; i < 50; ++i) {
    again.tick(pair.now);
    pair.now += kMillisecond;
    pair.slave.tick(pair.now);
    SecurePair::drain(pair.slave, pair.slave_got, pair.slave_strangers);
    SecurePair::drain(again, got, strangers);
  }
  ASSERT_NE(again.session(), nullptr);
  EXPECT_EQ(again.session()->peer().key, pair.slave_key.public_key());
}

TEST_F(KeyChange, AMasterWhoseOldKeyIsNotTrustedAnyMoreCallsWithTheNextAtOnce) {
  SecurePair fresh;
  ASSERT_TRUE(fresh.master.set_own(fresh.master_key, next));
  fresh.slave.set_trusted(test::trusting({desk(next.public_key())}));
  ASSERT_TRUE(fresh.connect());
  EXPECT_EQ(fresh.slave.counts().untrusted, 1u);
  EXPECT_EQ(fresh.master.session()->own(), next.public_key());
  EXPECT_EQ(fresh.master.problem(), Problem::kNone);
  // A slave that trusts neither is called once a second, with one after the other.
  fresh.slave.set_trusted(test::trusting({desk(pair.master_key.public_key())}));
  for (int ms = 0; ms < 3500; ++ms) fresh.step();
  EXPECT_EQ(fresh.master.session(), nullptr);
  EXPECT_EQ(fresh.master.problem(), Problem::kWeAre);
  EXPECT_LE(fresh.slave.counts().untrusted, 9u);
}

TEST_F(KeyChange, AMasterThatHasOnlyTheNewKeyFindsASlaveThatStillHasBoth) {
  ASSERT_TRUE(pair.slave.set_own(pair.slave_key, next));
  pair.master.set_trusted(test::trusting({cell(next.public_key())}));
  EXPECT_EQ(pair.master.session(), nullptr);
  run(500 * kMillisecond);
  ASSERT_NE(pair.master.session(), nullptr);
  EXPECT_EQ(pair.master.session()->peer().key, next.public_key());
}

TEST_F(KeyChange, ThereIsNoWayBackToAKeyThatWasRetired) {
  // Who has stolen the slave's old key answers in its place.
  pair.master.set_trusted(test::trusting({cell(next.public_key())}));
  run(kSecond);
  EXPECT_EQ(pair.master.session(), nullptr);
  EXPECT_EQ(pair.master.problem(), Problem::kUntrusted);
  // ... and the master's.
  SecurePair other;
  other.slave.set_trusted(test::trusting({desk(next.public_key())}));
  EXPECT_FALSE(other.connect());
  EXPECT_EQ(other.master.problem(), Problem::kWeAre);
}

TEST_F(KeyChange, ASlaveWithoutTheNextKeyThatIsAskedForKeepsItsSession) {
  pair.master.set_trusted(test::trusting({cell_with_next()}));
  const auto* before = pair.master.session();
  run(15 * kSecond);
  EXPECT_EQ(pair.master.session(), before);
  EXPECT_EQ(pair.master.session()->peer().key, pair.slave_key.public_key());
  EXPECT_EQ(pair.slave_got.size(), sent);
  EXPECT_FALSE(pair.master.take_begun());
}

TEST_F(KeyChange, AHelloNamesTheIdsThatAreCalledAndNoKey) {
  const auto holds = [&](std::string text) {
    std::erase(text, '-');
    return std::any_of(pair.net.sent.begin(), pair.net.sent.end(), [&](const auto& datagram) {
      return std::search(datagram.bytes.begin(), datagram.bytes.end(), text.begin(), text.end()) !=
             datagram.bytes.end();
    });
  };
  EXPECT_TRUE(holds(key_id(pair.slave_key.public_key())));
  pair.net.sent.clear();
  pair.master.set_trusted(test::trusting({cell_with_next()}));
  run(kSecond);
  EXPECT_TRUE(holds(key_id(next.public_key())));
  EXPECT_FALSE(holds(key_id(pair.slave_key.public_key())));
  EXPECT_FALSE(holds(key_text(next.public_key())));
}

TEST_F(KeyChange, AListOfManySlavesStillMakesAHelloThatFits) {
  std::vector<Trusted> many;
  for (int i = 0; i < 40; ++i) {
    many.push_back({"cell" + std::to_string(i), Role::kSlave, OwnKey::generate()->public_key()});
  }
  SecurePair fresh;
  many.push_back(cell(fresh.slave_key.public_key()));
  fresh.master.set_trusted(test::trusting(many));
  EXPECT_TRUE(fresh.connect());
  for (const auto& datagram : fresh.net.sent) EXPECT_LE(datagram.bytes.size(), 1232u);
}

}  // namespace
}  // namespace handrail
