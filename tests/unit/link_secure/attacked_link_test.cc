#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/made_up_net/made_up_net.h"

namespace handrail {
namespace {

using test::Bytes;
using test::SecurePair;

const Bytes kOrder(500, 0x17), kAnswer(540, 0x42);  // of a link's size

TEST(SecureLinkAttacked, ARepeatedDatagramIsNotTakenTwice) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kOrder));
  const auto recorded = pair.net.sent.back();
  for (int i = 0; i < 1000; ++i) {
    pair.net.put(recorded);
    pair.step();
  }
  EXPECT_EQ(pair.slave_got.size(), 1u);
  EXPECT_EQ(pair.slave.counts().strangers, 1000u);
}

TEST(SecureLinkAttacked, NoChangedBitPassesAndTheSessionGoesOn) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kOrder));
  const std::size_t sent = pair.net.sent.size();
  pair.net.passes = [](auto&) { return false; };
  ASSERT_TRUE(pair.master.send(kOrder));
  const auto whole = pair.net.sent[sent];
  pair.net.passes = [](auto&) { return true; };
  for (std::size_t bit = 0; bit < 8 * whole.bytes.size(); ++bit) {
    auto broken = whole;
    broken.bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    pair.net.put(broken);
    pair.step();
    ASSERT_EQ(pair.slave_got.size(), 1u) << "bit " << bit;
    ASSERT_NE(pair.slave.leader(), nullptr) << "bit " << bit;
  }
  pair.net.put(whole);
  pair.step();
  EXPECT_EQ(pair.slave_got.size(), 2u);
  // Not answered for over a second, the master has made another session by now.
  ASSERT_TRUE(pair.say(kOrder));
  ASSERT_TRUE(pair.slave.send(kAnswer));
  pair.step();
  EXPECT_EQ(pair.master_got.size(), 1u);
}

// Anybody can send these from the other side's address.
TEST(SecureLinkAttacked, ForgedRecordsOfAnyTypeEpochAndLengthLeaveBothEndsAlone) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kOrder));
  const DtlsChannel* const at_master = pair.master.session();
  const DtlsChannel* const at_slave = pair.slave.leader();
  for (std::uint8_t type = 19; type <= 25; ++type) {
    for (std::uint8_t epoch = 0; epoch <= 2; ++epoch) {
      for (const std::uint8_t sequence : Bytes{0, 1, 200}) {
        for (std::size_t length = 0; length <= 64; ++length) {
          Bytes record = {type,
                          0xfe,
                          0xfd,
                          0,
                          epoch,
                          0,
                          0,
                          0,
                          0,
                          0,
                          sequence,
                          0,
                          static_cast<std::uint8_t>(length)};
          // As an alert that is not encrypted: fatal, close_notify.
          for (std::size_t i = 0; i < length; ++i) record.push_back(i == 0 ? 2 : 0);
          pair.net.put({pair.master_socket.own(), pair.slave_socket.own(), record});
          pair.net.put({pair.slave_socket.own(), pair.master_socket.own(), record});
          SecurePair::drain(pair.slave, pair.slave_got, pair.slave_strangers);
          SecurePair::drain(pair.master, pair.master_got, pair.master_strangers);
          ASSERT_EQ(pair.slave.leader(), at_slave)
              << int{type} << " epoch " << int{epoch} << " length " << length;
          ASSERT_EQ(pair.master.session(), at_master)
              << int{type} << " epoch " << int{epoch} << " length " << length;
        }
      }
    }
  }
  ASSERT_TRUE(pair.say(kOrder));
  ASSERT_TRUE(pair.slave.send(kAnswer));
  pair.step();
  EXPECT_EQ(pair.slave_got.size(), 2u);
  EXPECT_EQ(pair.master_got.size(), 1u);
}

// OpenSSL passes over the head of a record of another version and reads on in its body, 13 bytes at
// a time: there lies a record that is too short to be sealed.
TEST(SecureLinkAttacked, WhatARecordOfAnotherVersionHidesIsNotRead) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kOrder));
  const DtlsChannel* const at_master = pair.master.session();
  const DtlsChannel* const at_slave = pair.slave.leader();
  const Bytes before = {20, 0xfe, 0xfd, 0, 0, 0, 0, 0, 0, 0, 9, 0, 1, 1};  // one that is whole
  for (std::uint8_t type = 20; type <= 23; ++type) {
    for (std::uint8_t hidden = 20; hidden <= 23; ++hidden) {
      for (std::size_t length = 0; length <= 30; ++length) {
        for (const bool alone : {true, false}) {
          Bytes body(13, 0);
          const Bytes head = {hidden, 0xfe, 0xfd, 0, 1, 0, 0, 0, 0, 0, 9, 0};
          body.insert(body.end(), head.begin(), head.end());
          body.push_back(static_cast<std::uint8_t>(length));
          body.resize(body.size() + length, 2);
          Bytes record = {type, 0xfe, 0xff, 0, 0, 0, 0, 0, 0, 0, 9, 0};
          record.push_back(static_cast<std::uint8_t>(body.size()));
          record.insert(record.end(), body.begin(), body.end());
          if (!alone) record.insert(record.begin(), before.begin(), before.end());
          pair.net.put({pair.master_socket.own(), pair.slave_socket.own(), record});
          pair.net.put({pair.slave_socket.own(), pair.master_socket.own(), record});
          SecurePair::drain(pair.slave, pair.slave_got, pair.slave_strangers);
          SecurePair::drain(pair.master, pair.master_got, pair.master_strangers);
          ASSERT_EQ(pair.slave.leader(), at_slave)
              << int{type} << " hides " << int{hidden} << " of " << length;
          ASSERT_EQ(pair.master.session(), at_master)
              << int{type} << " hides " << int{hidden} << " of " << length;
        }
      }
    }
  }
  ASSERT_TRUE(pair.say(kOrder));
  ASSERT_TRUE(pair.slave.send(kAnswer));
  pair.step();
  EXPECT_EQ(pair.slave_got.size(), 2u);
  EXPECT_EQ(pair.master_got.size(), 1u);
}

TEST(SecureLinkAttacked, WhoHasNoSessionIsNeverAnsweredWithMoreThanItSent) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  std::vector<Bytes> from_master;
  for (const auto& d : pair.net.sent) {
    if (d.from == pair.master_socket.own()) from_master.push_back(d.bytes);
  }
  Random random(std::random_device{}());
  const Address stranger = test::address_of(66, 6666);
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes = from_master[static_cast<std::size_t>(i) % from_master.size()];
    for (int change = i % 4; change > 0; --change) {
      const auto at =
          static_cast<std::size_t>(random.uniform() * static_cast<double>(bytes.size()));
      bytes[std::min(at, bytes.size() - 1)] ^= static_cast<std::uint8_t>(256.0 * random.uniform());
    }
    if (i % 5 == 0) bytes.resize(static_cast<std::size_t>(random.uniform() * 80.0));
    pair.net.sent.clear();
    pair.net.put({stranger, pair.slave_socket.own(), bytes});
    pair.step();
    std::size_t answered = 0;
    for (const auto& d : pair.net.sent) answered += d.to == stranger ? d.bytes.size() : 0;
    ASSERT_LE(answered, bytes.size());
  }
  EXPECT_EQ(pair.slave_got.size(), 0u);
}

TEST(SecureLinkAttacked, HandshakesOfStrangersLeaveTheSessionAlone) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(kOrder));
  const OwnKey key = *OwnKey::generate();
  const auto context = SecurePair::context(
      key, {{"cell", Role::kSlave, pair.slave_key.public_key()}}, SecureContext::Side::kClient);
  std::vector<std::unique_ptr<test::MadeUpSocket>> sockets;
  std::vector<std::unique_ptr<SecureClient>> strangers;
  for (std::uint16_t i = 0; i < 40; ++i) {
    sockets.push_back(std::make_unique<test::MadeUpSocket>(
        pair.net, test::address_of(100, static_cast<std::uint16_t>(2000 + i))));
    strangers.push_back(std::make_unique<SecureClient>(*context, *sockets.back()));
    strangers.back()->set_addresses({pair.slave_socket.own()});
  }
  int said = 0;
  for (int ms = 0; ms < 2000; ++ms) {
    for (auto& stranger : strangers) {
      stranger->tick(pair.now);
      std::vector<Bytes> got;
      int dropped = 0;
      SecurePair::drain(*stranger, got, dropped);
    }
    said += pair.say(kOrder);
    (void)pair.slave.send(kAnswer);
  }
  EXPECT_EQ(said, 2000);
  EXPECT_EQ(pair.slave_got.size(), 2001u);
  EXPECT_EQ(pair.slave.counts().sessions, 1u);
  EXPECT_GT(pair.slave.counts().untrusted, 10u);
  for (auto& stranger : strangers) EXPECT_EQ(stranger->session(), nullptr);
}

}  // namespace
}  // namespace handrail
