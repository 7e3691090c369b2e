// Frames of the operator protocol: u32 length, little-endian, then that many bytes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace handrail {

inline constexpr std::size_t kFrameHeader = 4;
inline constexpr std::uint32_t kMaxFrame = 64 * 1024;

inline std::array<char, kFrameHeader> frame_header(std::uint32_t size) noexcept {
  return {static_cast<char>(size), static_cast<char>(size >> 8), static_cast<char>(size >> 16),
          static_cast<char>(size >> 24)};
}

// `header` holds at least kFrameHeader bytes.
inline std::uint32_t frame_size(const char* header) noexcept {
  const auto at = [&](int i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(header[i])) << (8 * i);
  };
  return at(0) | at(1) | at(2) | at(3);
}

// Header and payload; the payload is at most kMaxFrame bytes.
inline std::string framed(std::string_view payload) {
  const auto header = frame_header(static_cast<std::uint32_t>(payload.size()));
  std::string out(header.begin(), header.end());
  return out.append(payload);
}

}  // namespace handrail
