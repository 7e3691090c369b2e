#include "server/keys/own_socket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>

namespace handrail {
namespace {

using boost::asio::ip::tcp;
using boost::asio::ip::udp;
using ::testing::HasSubstr;

TEST(OwnSocket, AnAcceptorListensAndASocketIsBoundWhereItIsSaid) {
  boost::asio::io_context io;
  tcp::acceptor acceptor(io);
  ASSERT_TRUE(open_own(acceptor, {"pairing", "", "127.0.0.1", 0}));
  tcp::socket caller(io);
  caller.connect(acceptor.local_endpoint());
  EXPECT_NO_THROW(acceptor.accept());
  udp::socket socket(io);
  ASSERT_TRUE(open_own(socket, {"link", "", "127.0.0.1", 0}));
  EXPECT_NE(socket.local_endpoint().port(), 0);
  EXPECT_TRUE(socket.non_blocking());
}

TEST(OwnSocket, AnyTakesCallersOfIpv4Too) {
  boost::asio::io_context io;
  tcp::acceptor acceptor(io);
  ASSERT_TRUE(open_own(acceptor, {"pairing", "", "any", 0}));
  tcp::socket caller(io);
  caller.connect({boost::asio::ip::address_v4::loopback(), acceptor.local_endpoint().port()});
  EXPECT_NO_THROW(acceptor.accept());
}

// What goes wrong says where, and what would be right; the socket can be opened again.
TEST(OwnSocket, APortThatIsTakenOrAnAddressOfAnotherComputerIsSaid) {
  boost::asio::io_context io;
  tcp::acceptor first(io), second(io);
  ASSERT_TRUE(open_own(first, {"operator", "", "127.0.0.1", 0}));
  const auto port = first.local_endpoint().port();
  const Status taken = open_own(second, {"operator", "set operator_port", "127.0.0.1", port});
  EXPECT_THAT(taken.message(),
              HasSubstr("operator port " + std::to_string(port) + " on 127.0.0.1 is in use"));
  EXPECT_THAT(taken.message(), HasSubstr("set operator_port"));
  EXPECT_THAT(open_own(second, {"operator", "", "192.0.2.7", 0}).message(),
              HasSubstr("operator port 0 on 192.0.2.7: this computer has no such address"));
  EXPECT_THAT(open_own(second, {"operator", "", "desk", 0}).message(),
              HasSubstr("operator address 'desk': expected any, or an address"));
  EXPECT_TRUE(open_own(second, {"operator", "", "127.0.0.1", 0}));
}

// The port of a program that has just ended, with a connection of its own left, is free.
TEST(OwnSocket, AConnectionThatHasEndedDoesNotKeepThePort) {
  boost::asio::io_context io;
  std::uint16_t port = 0;
  {
    tcp::acceptor acceptor(io);
    ASSERT_TRUE(open_own(acceptor, {"pairing", "", "127.0.0.1", 0}));
    port = acceptor.local_endpoint().port();
    tcp::socket caller(io);
    caller.connect(acceptor.local_endpoint());
    acceptor.accept().close();  // it ends first, so that its end stays in TIME-WAIT
  }
  tcp::acceptor again(io);
  const Status opened = open_own(again, {"pairing", "", "127.0.0.1", port});
  EXPECT_TRUE(opened) << opened.message();
}

}  // namespace
}  // namespace handrail
