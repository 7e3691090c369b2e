#include "server/link/secure/udp_socket.h"

#include <gtest/gtest.h>

#include <boost/asio.hpp>

#include <array>
#include <vector>

#include "server/link/secure/peer_resolver.h"

namespace handrail {
namespace {

Address local(std::uint16_t port) {
  return {{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 127, 0, 0, 1}, port, 0};
}

std::optional<DatagramSocket::Arrival> wait_for(UdpSocket& socket, std::span<std::uint8_t> out) {
  for (int i = 0; i < 100'000; ++i) {
    if (auto arrival = socket.receive(out)) return arrival;
  }
  return std::nullopt;
}

TEST(UdpSocket, CarriesADatagramBetweenAnyAndAnAddressAndSaysWhereFrom) {
  boost::asio::io_context io;
  UdpSocket a(io), b(io);
  ASSERT_TRUE(a.open("any", 0));
  ASSERT_TRUE(b.open("127.0.0.1", 0));
  const std::array<std::uint8_t, 3> bytes = {1, 2, 3};
  std::array<std::uint8_t, 8> got{};
  ASSERT_TRUE(a.send(bytes, local(b.port())));
  const auto there = wait_for(b, got);
  ASSERT_TRUE(there);
  EXPECT_EQ(there->size, 3u);
  EXPECT_EQ(there->from, local(a.port()));
  ASSERT_TRUE(b.send(bytes, there->from));
  const auto back = wait_for(a, got);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->from, local(b.port()));
  EXPECT_EQ(address_text(back->from), "127.0.0.1:" + std::to_string(b.port()));
}

TEST(UdpSocket, APortThatNobodyListensAtDoesNotHideWhatWaits) {
  boost::asio::io_context io;
  UdpSocket a(io), b(io);
  ASSERT_TRUE(a.open("127.0.0.1", 0));
  ASSERT_TRUE(b.open("127.0.0.1", 0));
  std::uint16_t dead = 0;
  {
    UdpSocket gone(io);
    ASSERT_TRUE(gone.open("127.0.0.1", 0));
    dead = gone.port();
  }
  const std::array<std::uint8_t, 1> bytes = {7};
  (void)a.send(bytes, local(dead));
  ASSERT_TRUE(b.send(bytes, local(a.port())) || b.send(bytes, local(a.port())));
  std::array<std::uint8_t, 8> got{};
  EXPECT_TRUE(wait_for(a, got));
}

TEST(UdpSocket, WhatCannotBeHadNamesPlaceAndExpectation) {
  boost::asio::io_context io;
  UdpSocket a(io), b(io);
  ASSERT_TRUE(a.open("127.0.0.1", 0));
  const auto says = [&](const std::string& address, std::uint16_t port, const char* what) {
    const Status opened = b.open(address, port);
    EXPECT_FALSE(opened);
    EXPECT_NE(opened.message().find(what), std::string::npos) << opened.message();
  };
  says("127.0.0.1", a.port(), "is in use");
  says("192.0.2.7", 0, "this computer has no such address");
  says("robot", 0, "expected any, or an address");
  says("", 0, "expected any, or an address");
}

TEST(AddressText, IsWhatIsTypedToReachIt) {
  EXPECT_EQ(address_text(local(1)), "127.0.0.1:1");
  Address v6;
  v6.ip = {0x20, 0x01, 0x0d, 0xb8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7};
  v6.port = 47002;
  EXPECT_EQ(address_text(v6), "[2001:db8::7]:47002");
  v6.scope = 3;
  EXPECT_EQ(address_text(v6), "[2001:db8::7%3]:47002");
}

TEST(PeerResolver, FindsAddressesAndSaysWhenThereAreNone) {
  boost::asio::io_context io;
  PeerResolver resolver(io);
  std::vector<Address> found;
  ASSERT_TRUE(resolver.ask({"127.0.0.1", 47002}, [&](auto result) { found = *result; }));
  EXPECT_FALSE(resolver.ask({"127.0.0.1", 47002}, [](auto) {}));
  io.run();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0], local(47002));
  std::string problem;
  io.restart();
  ASSERT_TRUE(resolver.ask({"no-such-host.invalid", 47002},
                           [&](auto result) { problem = result.message(); }));
  io.run();
  EXPECT_NE(problem.find("'no-such-host.invalid' has no address"), std::string::npos) << problem;
}

}  // namespace
}  // namespace handrail
