#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "tests/support/made_up_net/made_up_net.h"

namespace handrail {
namespace {

using test::Bytes;
using test::SecurePair;

constexpr int kFlood = 100'000;  // of each kind
const Bytes kSaid(500, 0x17);

// A stranger that sends so many of one kind while a session is open.
struct Flood {
  SecurePair pair;
  Random random{std::random_device{}()};
  const Address stranger = test::address_of(66, 6666);
  Bytes hello, data;  // as the master sent them

  bool ready() {
    if (!pair.connect() || !pair.say(kSaid)) return false;
    hello = pair.net.sent.front().bytes;
    data = pair.net.sent.back().bytes;
    return true;
  }
  void spoil(Bytes& bytes, std::size_t from) {
    for (std::size_t i = from; i < bytes.size(); ++i) {
      bytes[i] = static_cast<std::uint8_t>(random.bits());
    }
  }
  // No answer is larger than what it answers, nothing is taken, and the session goes on.
  void expect_nothing_comes_of(const std::function<Bytes()>& make) {
    const DtlsChannel* const leader = pair.slave.leader();
    std::size_t answers = 0;
    for (int i = 0; i < kFlood; ++i) {
      const Bytes bytes = make();
      pair.net.sent.clear();
      pair.net.put({stranger, pair.slave_socket.own(), bytes});
      if (i % 100 == 0) pair.now += kMillisecond;  // 100 000 a second
      pair.slave.tick(pair.now);
      SecurePair::drain(pair.slave, pair.slave_got, pair.slave_strangers);
      std::size_t answered = 0;
      for (const auto& d : pair.net.sent) answered += d.to == stranger ? d.bytes.size() : 0;
      answers += answered != 0;
      ASSERT_LE(answered, bytes.size()) << "datagram " << i;
    }
    EXPECT_EQ(pair.slave_got.size(), 1u);
    EXPECT_EQ(pair.slave.leader(), leader);
    EXPECT_EQ(pair.slave.counts().sessions, 1u);
    EXPECT_LE(answers, 2u * SecureServer::kCookiesPerSecond);
    ASSERT_TRUE(pair.say(kSaid));
    EXPECT_EQ(pair.slave_got.size(), 2u);
  }
};

TEST(SecureLinkFlooded, RandomBytesAreNotAnswered) {
  Flood flood;
  ASSERT_TRUE(flood.ready());
  flood.expect_nothing_comes_of([&] {
    Bytes bytes(static_cast<std::size_t>(600.0 * flood.random.uniform()));
    flood.spoil(bytes, 0);
    return bytes;
  });
}

TEST(SecureLinkFlooded, ForgedDataRecordsAreNotTaken) {
  Flood flood;
  ASSERT_TRUE(flood.ready());
  flood.expect_nothing_comes_of([&] {
    Bytes bytes = flood.data;
    bytes[10] = static_cast<std::uint8_t>(flood.random.bits());  // its number
    flood.spoil(bytes, 13);
    return bytes;
  });
}

TEST(SecureLinkFlooded, RecordedDataIsNotTakenAgain) {
  Flood flood;
  ASSERT_TRUE(flood.ready());
  flood.expect_nothing_comes_of([&] { return flood.data; });
}

TEST(SecureLinkFlooded, HellosGetACookieThatIsSmallerAtMost) {
  Flood flood;
  ASSERT_TRUE(flood.ready());
  flood.expect_nothing_comes_of([&] {
    Bytes bytes = flood.hello;
    for (std::size_t i = 27; i < 27 + 32; ++i) {  // another random number: another attempt
      bytes[i] = static_cast<std::uint8_t>(flood.random.bits());
    }
    return bytes;
  });
}

TEST(SecureLinkFlooded, HellosWithDamageAreAnsweredByNoMoreThanACookie) {
  Flood flood;
  ASSERT_TRUE(flood.ready());
  flood.expect_nothing_comes_of([&] {
    Bytes bytes = flood.hello;
    flood.spoil(bytes, bytes.size() - 1 - flood.random.bits() % (bytes.size() - 14));
    return bytes;
  });
}

}  // namespace
}  // namespace handrail
