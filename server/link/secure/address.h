// Where a datagram comes from or goes to.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace handrail {

// An IPv6 address, or an IPv4 one as ::ffff:a.b.c.d, and a port.
struct Address {
  std::array<std::uint8_t, 16> ip{};
  std::uint16_t port = 0;
  std::uint32_t scope = 0;  // the interface of a link-local address; else 0

  friend bool operator==(const Address&, const Address&) = default;
};

bool is_v4(const Address& address) noexcept;

// "192.0.2.7:47002" or "[2001:db8::7]:47002".
std::string address_text(const Address& address);

}  // namespace handrail
