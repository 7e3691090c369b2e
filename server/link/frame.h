// The 12 bytes around a payload: magic "HRLK", version, kind, payload length (u16) and CRC-32
// (u32), little-endian. The CRC covers the first eight bytes and the payload.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "server/link/reject.h"

namespace handrail {

enum class DatagramKind : std::uint8_t { kMaster = 1, kSlave = 2, kRefusal = 3 };

inline constexpr std::size_t kFrameBytes = 12;
inline constexpr std::size_t kVersionAt = 4;  // offset of the version

// Completes a frame whose payload already stands behind the first kFrameBytes of `datagram`.
// Real-time safe.
void seal_frame(DatagramKind kind, std::span<std::uint8_t> datagram) noexcept;

// Checks a whole datagram; `payload` is valid when kNone is returned. Real-time safe.
Reject open_frame(DatagramKind expected, std::span<const std::uint8_t> datagram,
                  std::span<const std::uint8_t>& payload) noexcept;

}  // namespace handrail
