#include "server/link/frame.h"

#include <zlib.h>

#include <algorithm>
#include <array>

#include "server/link/codec.h"

namespace handrail {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic = {'H', 'R', 'L', 'K'};
constexpr std::size_t kCheckedHeader = 8;

std::uint32_t checksum(std::span<const std::uint8_t> datagram) {
  const auto header = crc32(0, datagram.data(), kCheckedHeader);
  const auto payload = datagram.subspan(kFrameBytes);
  return static_cast<std::uint32_t>(
      crc32(header, payload.data(), static_cast<uInt>(payload.size())));
}

}  // namespace

void seal_frame(DatagramKind kind, std::span<std::uint8_t> datagram) noexcept {
  const std::size_t length = datagram.size() - kFrameBytes;
  std::copy(kMagic.begin(), kMagic.end(), datagram.begin());
  datagram[kVersionAt] = kWireVersion;
  datagram[5] = static_cast<std::uint8_t>(kind);
  datagram[6] = static_cast<std::uint8_t>(length);
  datagram[7] = static_cast<std::uint8_t>(length >> 8);
  const std::uint32_t crc = checksum(datagram);
  for (std::size_t i = 0; i < 4; ++i) datagram[8 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
}

Reject open_frame(DatagramKind expected, std::span<const std::uint8_t> datagram,
                  std::span<const std::uint8_t>& payload) noexcept {
  if (datagram.size() < kFrameBytes || datagram.size() > kMaxDatagram) return Reject::kSize;
  if (!std::equal(kMagic.begin(), kMagic.end(), datagram.begin())) return Reject::kMagic;
  if (datagram[kVersionAt] != kWireVersion) return Reject::kVersion;
  if (datagram[5] != static_cast<std::uint8_t>(expected)) return Reject::kKind;
  const std::size_t length = datagram[6] + std::size_t{256} * datagram[7];
  if (length != datagram.size() - kFrameBytes) return Reject::kLength;
  std::uint32_t crc = 0;
  for (std::size_t i = 0; i < 4; ++i) crc |= std::uint32_t{datagram[8 + i]} << (8 * i);
  if (crc != checksum(datagram)) return Reject::kChecksum;
  payload = datagram.subspan(kFrameBytes);
  return Reject::kNone;
}

}  // namespace handrail
