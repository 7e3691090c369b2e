// Where a browser calls from.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/ip/tcp.hpp>
#include <utility>

namespace handrail {

// An address of IPv4 also where the port listens to both.
inline boost::asio::ip::address peer_address(const boost::asio::ip::tcp::endpoint& peer) {
  const boost::asio::ip::address out = peer.address();
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

}  // namespace handrail
