// IPv4 and IPv6 packets as bytes: who to whom, where the payload begins, and sums that are right.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/base/status.h"

namespace handrail::emulator {

inline constexpr std::uint8_t kIcmp = 1, kTcp = 6, kUdp = 17, kIcmp6 = 58;  // protocols, IANA

struct Address {
  std::array<std::uint8_t, 16> bytes{};  // IPv4: the first four
  std::size_t size = 4;                  // 4 or 16

  std::span<const std::uint8_t> span() const { return std::span(bytes).first(size); }
  bool operator==(const Address&) const = default;
};

// "10.77.0.1" or "fd77::1".
Result<Address> read_address(const std::string& text);
std::string text(const Address& address);

struct Endpoint {
  Address address;
  std::uint16_t port = 0;

  bool operator==(const Endpoint&) const = default;
};

// "10.77.0.1:5000" or "[fd77::1]:5000".
Result<Endpoint> read_endpoint(const std::string& text);

// Where things stand in a packet [bytes from its start].
struct Layout {
  std::size_t source = 0, destination = 0, address_size = 0;  // addresses
  std::uint8_t protocol = 0;   // of the transport; IPv6's extension headers count as unknown ones
  std::size_t transport = 0;   // its header
  bool has_transport = false;  // false: a later fragment
  bool fragment = false;       // the first one or a later one
  std::size_t body = 0;        // payload of a whole UDP or TCP packet; else the packet's size

  bool has_ports() const { return has_transport && (protocol == kUdp || protocol == kTcp); }
};

// nullopt: not IP, or cut, or longer than it says.
std::optional<Layout> layout_of(std::span<const std::uint8_t> packet);

// Ports are 0 where there are none.
Endpoint source_of(std::span<const std::uint8_t> packet, const Layout& layout);
Endpoint destination_of(std::span<const std::uint8_t> packet, const Layout& layout);

// Another source or destination, of the same kind of address; without ports the port is left. The
// checksums stay as right or wrong as they were (source: RFC 1624), that of a UDP packet without
// one stays 0.
void set_source(std::span<std::uint8_t> packet, const Layout& layout, const Endpoint& to);
void set_destination(std::span<std::uint8_t> packet, const Layout& layout, const Endpoint& to);

// Makes the checksum of a whole UDP or TCP packet right. A UDP packet without one stays so.
void repair(std::span<std::uint8_t> packet, const Layout& layout);

// Whether all checksums of a whole packet are right: a UDP packet over IPv4 may have none.
bool is_sound(std::span<const std::uint8_t> packet, const Layout& layout);

// A UDP packet with right checksums. Both addresses are of one kind.
std::vector<std::uint8_t> make_udp(const Endpoint& from, const Endpoint& to,
                                   std::span<const std::uint8_t> payload);

// Of several, unspecific or neighbours alone: no router passes such an address on.
bool is_local(const Address& address);

}  // namespace handrail::emulator
