#include "tests/emulator/ip_packet.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>

namespace handrail::emulator {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kHeader4 = 20, kHeader6 = 40, kUdpHeader = 8, kTcpHeader = 20;  // [bytes]
constexpr std::uint8_t kFragment6 = 44;                                               // IANA
constexpr std::size_t kFragmentHeader = 8;                                            // [bytes]
constexpr std::size_t kSum4 = 10;  // of IPv4's checksum

std::uint16_t word(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

void put_word(std::span<std::uint8_t> bytes, std::size_t at, std::uint16_t value) {
  bytes[at] = static_cast<std::uint8_t>(value >> 8);
  bytes[at + 1] = static_cast<std::uint8_t>(value & 0xff);
}

// Ones' complement sum of 16-bit words, not yet inverted; an odd last byte counts as the upper one.
std::uint32_t sum_of(Bytes bytes, std::uint32_t start = 0) {
  std::uint64_t sum = start;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) sum += word(bytes, i);
  if (bytes.size() % 2 == 1) sum += static_cast<std::uint32_t>(bytes.back() << 8);
  while (sum >> 16 != 0) sum = (sum & 0xffff) + (sum >> 16);
  return static_cast<std::uint32_t>(sum);
}

// Where the transport's checksum stands in the packet; nullopt: it has none that we know.
std::optional<std::size_t> sum_place(const Layout& layout) {
  if (!layout.has_transport) return std::nullopt;
  switch (layout.protocol) {
    case kUdp: return layout.transport + 6;
    case kTcp: return layout.transport + 16;
    case kIcmp6: return layout.transport + 2;
    default: return std::nullopt;
  }
}

// Of a whole packet, over its checksum as it stands: 0xffff when that is right.
std::uint32_t transport_sum(Bytes packet, const Layout& layout) {
  const Bytes content = packet.subspan(layout.transport);
  std::uint32_t sum = sum_of(packet.subspan(layout.source, 2 * layout.address_size));
  sum += layout.protocol + static_cast<std::uint32_t>(content.size());
  return sum_of(content, sum);
}

std::uint16_t inverted(std::uint32_t sum) { return static_cast<std::uint16_t>(~sum & 0xffff); }

bool read_port(std::string_view digits, std::uint16_t& out) {
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), out);
  return error == std::errc() && end == digits.data() + digits.size();
}

std::optional<Layout> layout_4(Bytes packet) {
  if (packet.size() < kHeader4) return std::nullopt;
  Layout out;
  out.transport = 4u * (packet[0] & 15u);
  if (out.transport < kHeader4 || out.transport > packet.size()) return std::nullopt;
  if (word(packet, 2) != packet.size()) return std::nullopt;
  out.source = 12;
  out.destination = 16;
  out.address_size = 4;
  out.protocol = packet[9];
  const std::uint16_t fragment = word(packet, 6) & 0x3fff;  // more follow, and where it belongs
  out.fragment = fragment != 0;
  out.has_transport = (fragment & 0x1fff) == 0;
  return out;
}

std::optional<Layout> layout_6(Bytes packet) {
  if (packet.size() < kHeader6) return std::nullopt;
  if (word(packet, 4) + kHeader6 != packet.size()) return std::nullopt;
  Layout out;
  out.transport = kHeader6;
  out.source = 8;
  out.destination = 24;
  out.address_size = 16;
  out.protocol = packet[6];
  out.has_transport = true;
  if (out.protocol != kFragment6) return out;
  if (packet.size() < kHeader6 + kFragmentHeader) return std::nullopt;
  out.protocol = packet[kHeader6];
  out.transport += kFragmentHeader;
  out.fragment = true;
  out.has_transport = word(packet, kHeader6 + 2) >> 3 == 0;
  return out;
}

// The header of its transport: whether it is whole, and where its payload begins.
void look_inside(Bytes packet, Layout& layout) {
  layout.body = packet.size();
  if (!layout.has_transport) return;
  const std::size_t left = packet.size() - layout.transport;
  if (layout.protocol == kUdp) {
    layout.has_transport = left >= kUdpHeader;
    if (layout.has_transport && word(packet, layout.transport + 4) == left) {
      layout.body = layout.transport + kUdpHeader;
    }
  } else if (layout.protocol == kTcp) {
    layout.has_transport = left >= kTcpHeader;
    if (!layout.has_transport) return;
    const std::size_t header = 4u * (packet[layout.transport + 12] >> 4);
    if (header >= kTcpHeader && header <= left) layout.body = layout.transport + header;
  } else if (layout.protocol == kIcmp6) {
    layout.has_transport = left >= 4;
  }
  if (layout.fragment) layout.body = packet.size();
}

Endpoint endpoint(Bytes packet, const Layout& layout, std::size_t address, std::size_t port) {
  Endpoint out;
  out.address.size = layout.address_size;
  std::copy_n(packet.begin() + static_cast<std::ptrdiff_t>(address), layout.address_size,
              out.address.bytes.begin());
  if (layout.has_ports()) out.port = word(packet, layout.transport + port);
  return out;
}

// Puts words in the place of others, with the checksums that cover them.
class Patch {
 public:
  Patch(std::span<std::uint8_t> packet, const Layout& layout)
      : packet_(packet), place_(sum_place(layout)), layout_(layout) {
    // A UDP packet over IPv4 may have none.
    if (place_ && layout.protocol == kUdp && word(packet, *place_) == 0) place_.reset();
  }

  void address(std::size_t at, const Address& to) {
    for (std::size_t i = 0; i < to.size; i += 2) {
      const std::uint16_t value = word(to.bytes, i);
      if (layout_.address_size == 4) update(kSum4, word(packet_, at + i), value, false);
      put(at + i, value);
    }
  }
  void put(std::size_t at, std::uint16_t value) {
    if (place_) update(*place_, word(packet_, at), value, layout_.protocol == kUdp);
    put_word(packet_, at, value);
  }

 private:
  void update(std::size_t place, std::uint16_t old, std::uint16_t now, bool never_0) {
    std::uint32_t sum = inverted(word(packet_, place)) + std::uint32_t{inverted(old)} + now;
    while (sum >> 16 != 0) sum = (sum & 0xffff) + (sum >> 16);
    const std::uint16_t made = inverted(sum);
    put_word(packet_, place, never_0 && made == 0 ? 0xffff : made);
  }

  std::span<std::uint8_t> packet_;
  std::optional<std::size_t> place_;
  const Layout& layout_;
};

void set_endpoint(std::span<std::uint8_t> packet, const Layout& layout, std::size_t address,
                  std::size_t port, const Endpoint& to) {
  Patch patch(packet, layout);
  patch.address(address, to.address);
  if (layout.has_ports()) patch.put(layout.transport + port, to.port);
}

}  // namespace

Result<Address> read_address(const std::string& text) {
  Address out;
  if (::inet_pton(AF_INET, text.c_str(), out.bytes.data()) == 1) return out;
  out.size = 16;
  if (::inet_pton(AF_INET6, text.c_str(), out.bytes.data()) == 1) return out;
  return Status::error("'" + text + "': expected an address such as 10.77.0.1 or fd77::1");
}

std::string text(const Address& address) {
  std::array<char, INET6_ADDRSTRLEN> out{};
  ::inet_ntop(address.size == 4 ? AF_INET : AF_INET6, address.bytes.data(), out.data(), out.size());
  return out.data();
}

Result<Endpoint> read_endpoint(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  std::string host = text.substr(0, colon);
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (bracketed) host = host.substr(1, host.size() - 2);
  const Result<Address> address = read_address(host);
  Endpoint out;
  if (colon == std::string::npos || !address || bracketed != (address->size == 16) ||
      !read_port(std::string_view(text).substr(colon + 1), out.port)) {
    return Status::error("'" + text +
                         "': expected address and port, such as 10.77.0.1:5000 or [fd77::1]:5000");
  }
  out.address = *address;
  return out;
}

std::optional<Layout> layout_of(Bytes packet) {
  if (packet.empty()) return std::nullopt;
  std::optional<Layout> out;
  if (packet[0] >> 4 == 4) out = layout_4(packet);
  if (packet[0] >> 4 == 6) out = layout_6(packet);
  if (out) look_inside(packet, *out);
  return out;
}

Endpoint source_of(Bytes packet, const Layout& layout) {
  return endpoint(packet, layout, layout.source, 0);
}

Endpoint destination_of(Bytes packet, const Layout& layout) {
  return endpoint(packet, layout, layout.destination, 2);
}

void set_source(std::span<std::uint8_t> packet, const Layout& layout, const Endpoint& to) {
  set_endpoint(packet, layout, layout.source, 0, to);
}

void set_destination(std::span<std::uint8_t> packet, const Layout& layout, const Endpoint& to) {
  set_endpoint(packet, layout, layout.destination, 2, to);
}

void repair(std::span<std::uint8_t> packet, const Layout& layout) {
  const auto place = sum_place(layout);
  if (!place || layout.fragment) return;
  if (layout.protocol == kUdp && word(packet, *place) == 0) return;
  put_word(packet, *place, 0);
  const std::uint16_t sum = inverted(transport_sum(packet, layout));
  put_word(packet, *place, layout.protocol == kUdp && sum == 0 ? 0xffff : sum);
}

bool is_sound(Bytes packet, const Layout& layout) {
  if (layout.address_size == 4 && sum_of(packet.first(layout.transport)) != 0xffff) return false;
  const auto place = sum_place(layout);
  if (!place || layout.fragment) return true;
  if (layout.protocol == kUdp && word(packet, *place) == 0) return layout.address_size == 4;
  return transport_sum(packet, layout) == 0xffff;
}

std::vector<std::uint8_t> make_udp(const Endpoint& from, const Endpoint& to, Bytes payload) {
  const bool is_6 = from.address.size == 16;
  const std::size_t header = is_6 ? kHeader6 : kHeader4;
  std::vector<std::uint8_t> out(header + kUdpHeader + payload.size());
  const auto length = static_cast<std::uint16_t>(kUdpHeader + payload.size());
  constexpr std::uint8_t kHops = 64;  // as Linux sends
  if (is_6) {
    out[0] = 0x60;
    put_word(out, 4, length);
    out[6] = kUdp;
    out[7] = kHops;
  } else {
    out[0] = 0x45;
    put_word(out, 2, static_cast<std::uint16_t>(out.size()));
    put_word(out, 6, 0x4000);  // not to be cut into fragments
    out[8] = kHops;
    out[9] = kUdp;
  }
  put_word(out, header + 4, length);
  std::copy(payload.begin(), payload.end(),
            out.begin() + static_cast<std::ptrdiff_t>(header + kUdpHeader));
  const auto put_end = [&](const Endpoint& end, std::size_t address, std::size_t port) {
    std::copy_n(end.address.bytes.begin(), end.address.size,
                out.begin() + static_cast<std::ptrdiff_t>(address));
    put_word(out, header + port, end.port);
  };
  put_end(from, is_6 ? 8 : 12, 0);
  put_end(to, is_6 ? 24 : 16, 2);
  if (!is_6) put_word(out, kSum4, inverted(sum_of(Bytes(out).first(header))));
  // Any sum but 0, which would say that there is none.
  put_word(out, header + 6, 1);
  const auto layout = layout_of(out);
  if (layout) repair(out, *layout);
  return out;
}

bool is_local(const Address& address) {
  const auto& b = address.bytes;
  if (address.size == 4) {
    return b[0] == 0 || b[0] >= 224 || (b[0] == 169 && b[1] == 254);  // RFC 1122, 3927, 5771
  }
  const bool unspecific = std::all_of(b.begin(), b.end(), [](std::uint8_t x) { return x == 0; });
  return unspecific || b[0] == 0xff || (b[0] == 0xfe && (b[1] & 0xc0) == 0x80);  // RFC 4291
}

}  // namespace handrail::emulator
