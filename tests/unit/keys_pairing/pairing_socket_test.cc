#include "server/keys/pairing/pairing_socket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/buffer.hpp>
#include <thread>

#include "server/base/clock.h"
#include "tests/unit/keys_pairing/pairing_samples.h"

namespace handrail {
namespace {

namespace asio = boost::asio;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A listening end in a thread of its own.
class PairingSocketTest : public ::testing::Test {
 protected:
  void listen(Nanos time = 20 * kSecond, const std::string& host = "127.0.0.1") {
    ASSERT_TRUE(socket.listen({host, 0}));
    thread = std::thread([this, time] {
      result = socket.serve(
          [this](const std::string&) {
            return Pairing::make(Pairing::Side::kListens, code_of("4829137"), cell.own,
                                 cell.book());
          },
          time, [this](const std::string& what) { strangers.push_back(what); });
    });
  }
  Result<Trusted> call(const std::string& digits, const std::string& host = "127.0.0.1") {
    return PairingSocket().call({host, socket.port()}, [&](const std::string&) {
      return Pairing::make(Pairing::Side::kCalls, code_of(digits), desk.own, desk.book());
    });
  }
  asio::ip::tcp::socket connected() {
    asio::ip::tcp::socket out(io);
    out.connect({asio::ip::make_address("127.0.0.1"), socket.port()});
    return out;
  }
  void join() {
    if (thread.joinable()) thread.join();
  }
  void TearDown() override { join(); }

  asio::io_context io;
  PairingEnd cell{"cell", Role::kSlave}, desk{"desk", Role::kMaster};
  PairingSocket socket;
  std::thread thread;
  Result<Trusted> result = Status::error("");
  std::vector<std::string> strangers;
};

TEST_F(PairingSocketTest, PairsOverIpv4AndIpv6) {
  for (const char* host : {"127.0.0.1", "::1"}) {
    cell.kept.clear();
    desk.kept.clear();
    socket.~PairingSocket();
    new (&socket) PairingSocket();
    listen(20 * kSecond, host);
    const auto other = call("482-9137", host);
    join();
    ASSERT_TRUE(other) << other.message();
    ASSERT_TRUE(result) << result.message();
    EXPECT_EQ(*other, cell.own);
    EXPECT_EQ(*result, desk.own);
    EXPECT_THAT(cell.kept, ElementsAre(desk.own));
    EXPECT_THAT(desk.kept, ElementsAre(cell.own));
  }
}

TEST_F(PairingSocketTest, AnyIsBothOfThem) {
  listen(20 * kSecond, "any");
  EXPECT_TRUE(call("482-9137", "localhost"));
  join();
  EXPECT_TRUE(result) << result.message();
}

TEST_F(PairingSocketTest, OneWrongGuessEndsIt) {
  listen();
  const auto other = call("4829138");
  join();
  ASSERT_FALSE(other);
  ASSERT_FALSE(result);
  EXPECT_THAT(other.message(), HasSubstr("the code is wrong"));
  EXPECT_THAT(result.message(), HasSubstr("gave a wrong code"));
  EXPECT_THAT(cell.kept, IsEmpty());
  EXPECT_THAT(strangers, IsEmpty());
  // ... and there is no second one.
  EXPECT_FALSE(call("4829137"));
}

TEST_F(PairingSocketTest, StrangersThatDoNotGuessAreSaidAndTheNextIsHeard) {
  listen();
  connected().close();
  connected().send(asio::buffer(std::string("GET / HTTP/1.1\r\n\r\n")));
  const auto other = call("4829137");
  join();
  EXPECT_TRUE(other) << other.message();
  EXPECT_TRUE(result) << result.message();
  ASSERT_EQ(strangers.size(), 2u);
  EXPECT_THAT(strangers[0], HasSubstr("127.0.0.1:"));
  EXPECT_THAT(strangers[1], HasSubstr("does not pair"));
}

TEST_F(PairingSocketTest, ASilentStrangerHoldsTheCodeUpForFiveSeconds) {
  listen();
  const auto silent = connected();
  const Nanos start = monotonic_now();
  const auto other = call("4829137");
  join();
  EXPECT_TRUE(other) << other.message();
  EXPECT_GE(monotonic_now() - start, PairingSocket::kPatience - 100 * kMillisecond);
  ASSERT_EQ(strangers.size(), 1u);
  EXPECT_THAT(strangers[0], HasSubstr("did not go on within 5 s"));
}

TEST_F(PairingSocketTest, TimeIsOverWhenItIsOverAlsoWithACallerThere) {
  const Nanos start = monotonic_now();
  listen(kSecond);
  const auto silent = connected();
  join();
  ASSERT_FALSE(result);
  EXPECT_THAT(result.message(), HasSubstr("nobody has paired within 1 s"));
  EXPECT_LT(monotonic_now() - start, 4 * kSecond);
  EXPECT_THAT(call("4829137").message(), HasSubstr("nobody pairs at 127.0.0.1:"));
}

TEST_F(PairingSocketTest, SomebodyWhoKeepsThePortBusyEndsIt) {
  listen();
  for (int i = 0; i < PairingSocket::kMostStrangers; ++i) connected().close();
  join();
  ASSERT_FALSE(result);
  EXPECT_THAT(result.message(), HasSubstr("50 callers that did not pair"));
}

TEST_F(PairingSocketTest, APlaceThatCannotBeListenedAtIsNamed) {
  EXPECT_THAT(socket.listen({"cell.example.org", 0}).message(), HasSubstr("'cell.example.org'"));
  PairingSocket elsewhere;
  EXPECT_THAT(elsewhere.listen({"192.0.2.7", 0}).message(),
              HasSubstr("on 192.0.2.7: this computer has no such address"));
  PairingSocket one, two;
  ASSERT_TRUE(one.listen({"127.0.0.1", 0}));
  EXPECT_THAT(two.listen({"127.0.0.1", one.port()}).message(), HasSubstr("is in use"));
}

TEST_F(PairingSocketTest, AHostThatIsNotThereIsSaid) {
  PairingSocket caller;
  EXPECT_THAT(caller.call({"no-such-host.invalid", 1}, nullptr).message(),
              HasSubstr("'no-such-host.invalid' has no address"));
}

}  // namespace
}  // namespace handrail
