// Packets for the emulator's tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/emulator/addresses.h"
#include "tests/emulator/ip_packet.h"

namespace handrail::emulator {

using Bytes = std::vector<std::uint8_t>;

inline Endpoint at(const std::string& text) {
  const auto out = read_endpoint(text);
  EXPECT_TRUE(out.is_ok()) << out.message();
  return out ? *out : Endpoint{};
}

inline Endpoint near_end(bool is_6) { return at(is_6 ? "[fd77::1]:4000" : "10.77.0.1:4000"); }
inline Endpoint far_end(bool is_6) { return at(is_6 ? "[fd77::2]:5000" : "10.77.0.2:5000"); }

// A UDP packet that carries its number, four bytes of it, least first.
inline std::vector<std::uint8_t> numbered(std::uint32_t number, const Endpoint& from,
                                          const Endpoint& to, std::size_t size = 64) {
  std::vector<std::uint8_t> payload(size, 0x5a);
  for (std::size_t i = 0; i < 4; ++i) payload[i] = static_cast<std::uint8_t>(number >> (8 * i));
  return make_udp(from, to, payload);
}

// 0: it carries none.
inline std::uint32_t number_of(std::span<const std::uint8_t> packet) {
  const auto layout = layout_of(packet);
  if (!layout || packet.size() - layout->body < 4) return 0;
  std::uint32_t out = 0;
  for (std::size_t i = 4; i > 0; --i) out = out << 8 | packet[layout->body + i - 1];
  return out;
}

// From near to far, over IPv4, with a right checksum.
inline std::vector<std::uint8_t> tcp_segment(std::size_t size) {
  std::vector<std::uint8_t> out =
      make_udp(near_end(false), far_end(false), std::vector<std::uint8_t>(12 + size, 0));
  out[9] = kTcp;
  out[32] = 5 << 4;  // 20 bytes of header
  // The header's checksum says another protocol: 0x1106 is added to it.
  const int sum = (out[10] << 8 | out[11]) + kUdp - kTcp;
  out[10] = static_cast<std::uint8_t>(sum >> 8);
  out[11] = static_cast<std::uint8_t>(sum);
  if (const auto layout = layout_of(out)) repair(out, *layout);
  return out;
}

}  // namespace handrail::emulator
