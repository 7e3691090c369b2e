// Where a browser calls from, and whether it means it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <utility>

namespace handrail {

// An address of IPv4 also where the port listens to both.
inline boost::asio::ip::address peer_address(const boost::asio::ip::tcp::endpoint& peer) {
  boost::asio::ip::address out = peer.address();
  if (!out.is_v6() || !out.to_v6().is_v4_mapped()) return out;
  return boost::asio::ip::make_address_v4(boost::asio::ip::v4_mapped, out.to_v6());
}

// For people.
inline std::string peer_text(const boost::asio::ip::tcp::endpoint& peer) {
  return peer_address(peer).to_string() + ":" + std::to_string(peer.port());
}

// Where one of this address may have all the others too: of IPv6 the first 64 bits.
inline std::string network_of(const boost::asio::ip::tcp::endpoint& peer) {
  const boost::asio::ip::address address = peer_address(peer);
  if (address.is_v4()) return address.to_string();
  auto bytes = address.to_v6().to_bytes();
  std::fill(bytes.begin() + 8, bytes.end(), std::uint8_t{0});
  return boost::asio::ip::address_v6(bytes).to_string();
}

enum class Greeting : std::uint8_t { kNone, kPart, kWhole };

// Whether a ClientHello waits to be read (RFC 8446, 4.1.2 and 5.1), which is sent whole by whoever
// means it. Reads nothing and does not wait. kNone: what is there is another thing, or nobody.
inline Greeting greeting_of(boost::asio::ip::tcp::socket& socket) {
  std::array<std::uint8_t, 6> start{};
  boost::system::error_code error;
  if (!socket.non_blocking()) socket.non_blocking(true, error);
  const std::size_t size =
      socket.receive(boost::asio::buffer(start), boost::asio::ip::tcp::socket::message_peek, error);
  if (error == boost::asio::error::would_block) return Greeting::kPart;
  if (error || start[0] != 0x16 || (size > 1 && start[1] != 3)) return Greeting::kNone;
  if (size < start.size()) return Greeting::kPart;
  const std::size_t whole = 5u + static_cast<std::size_t>(start[3] << 8 | start[4]);
  return start[5] != 1                     ? Greeting::kNone
         : socket.available(error) < whole ? Greeting::kPart
                                           : Greeting::kWhole;
}

}  // namespace handrail
