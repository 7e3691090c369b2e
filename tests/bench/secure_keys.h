// Keys of a slave and a master that trust each other.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <utility>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/ip/udp.hpp>

#include "server/link/secure/secure_client.h"
#include "server/link/secure/secure_server.h"
#include "server/link/secure/udp_socket.h"

namespace handrail::bench {

struct SecureKeys {
  OwnKey slave_key = *OwnKey::generate(), master_key = *OwnKey::generate();
  std::unique_ptr<SecureContext> slave_context =
      context(slave_key, {"desk", Role::kMaster, master_key.public_key()},
              SecureContext::Side::kServer, Role::kMaster);
  std::unique_ptr<SecureContext> master_context =
      context(master_key, {"cell", Role::kSlave, slave_key.public_key()},
              SecureContext::Side::kClient, Role::kSlave);

  static std::unique_ptr<SecureContext> context(const OwnKey& key, const Trusted& other,
                                                SecureContext::Side side, Role wanted) {
    TrustList trusted;
    if (!trusted.add(other)) std::abort();
    return std::move(*SecureContext::make(key, trusted, side, wanted));
  }
};

inline Address loopback_address(std::uint16_t port) {
  return address_of(boost::asio::ip::udp::endpoint(boost::asio::ip::address_v4::loopback(), port));
}

}  // namespace handrail::bench
