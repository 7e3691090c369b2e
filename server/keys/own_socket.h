// A port of this computer: where a program is to be reached.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>

#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/socket_base.hpp>
#include <boost/system/error_code.hpp>

#include "server/base/status.h"

namespace handrail {

// For what, and where a person sets which.
struct OwnPort {
  std::string purpose;     // as in "link port 47002"
  std::string setting;     // as in "set link_port"
  std::string address;     // "any" (all there are), or a number of IPv4 or IPv6
  std::uint16_t port = 0;  // 0: any that is free
  std::string holder = "a program like this one";  // who likely has it, where it is in use
};

// `v6`: of which kind "any" is. The error says what was expected.
Result<boost::asio::ip::address> own_ip(const std::string& text, bool v6);

// What kept a port from being opened, and what to do.
Status own_port_error(const OwnPort& own, const boost::system::error_code& error);

// Opens `socket`, a datagram socket or an acceptor of Asio's, at `own`, and so that it never waits;
// "any" is IPv6 and IPv4 in one. Closed after an error.
template <typename Socket>
Status open_own(Socket& socket, const OwnPort& own) {
  using Protocol = typename Socket::protocol_type;
  constexpr bool kListens = std::is_same_v<Protocol, boost::asio::ip::tcp>;
  boost::system::error_code error;
  for (const bool v6 : {true, false}) {
    const auto ip = own_ip(own.address, v6);
    if (!ip) return Status::error(own.purpose + " address " + ip.message());
    const typename Protocol::endpoint at(*ip, own.port);
    socket.open(at.protocol(), error);
    // A kernel without IPv6 has IPv4.
    if (error && v6 && own.address == "any") continue;
    if (!error && ip->is_v6()) {
      socket.set_option(boost::asio::ip::v6_only(own.address != "any"), error);
    }
    // A connection that has just ended does not keep its port from the next program.
    if (!error && kListens) socket.set_option(boost::asio::socket_base::reuse_address(true), error);
    if (!error) socket.non_blocking(true, error);
    if (!error) socket.bind(at, error);
    if constexpr (kListens) {
      if (!error) socket.listen(boost::asio::socket_base::max_listen_connections, error);
    }
    break;
  }
  if (!error) return Status::ok();
  boost::system::error_code ignored;
  socket.close(ignored);
  return own_port_error(own, error);
}

}  // namespace handrail
