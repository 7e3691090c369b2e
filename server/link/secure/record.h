// What can be seen of a DTLS record (RFC 6347, section 4.1) without a key.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace handrail {

inline constexpr std::size_t kRecordHeader = 13;

enum class RecordType : std::uint8_t { kAlert = 21, kHandshake = 22, kData = 23 };

inline constexpr std::size_t kSealing = 8 + 16;  // nonce and tag of AES-GCM (RFC 5288)

// Datagrams of a handshake are no longer: what IPv6 carries everywhere (1280) without its headers.
inline constexpr std::size_t kLongestHandshake = 1280 - 40 - 8;

// True when a datagram is a row of whole records of DTLS 1.2, or one of DTLS 1.0; those from epoch
// 1 on are no shorter than sealed ones. OpenSSL ends a session at a shorter one, which anybody can
// forge; it is to see none. Real-time safe, like all here.
inline bool is_records(std::span<const std::uint8_t> bytes) noexcept {
  const std::size_t all = bytes.size();
  const auto sound = [all](std::span<const std::uint8_t> b) {
    if (b.size() < kRecordHeader || b[0] < 20 || b[0] > 23 || b[1] != 0xfe) return false;
    const std::size_t size = kRecordHeader + (std::size_t{b[11]} << 8 | b[12]);
    return b[2] == 0xfd || (b[2] == 0xff && size == all);
  };
  do {
    if (!sound(bytes)) return false;
    const std::size_t size = kRecordHeader + (std::size_t{bytes[11]} << 8 | bytes[12]);
    const bool sealed = bytes[3] != 0 || bytes[4] != 0;
    if (size > bytes.size() || (sealed && size <= kRecordHeader + kSealing)) return false;
    bytes = bytes.subspan(size);
  } while (!bytes.empty());
  return true;
}

// Of the first record, like what follows; for records only. As it is sent before both ends have
// agreed on DTLS 1.2: a hello, or a cookie.
inline bool is_before_version(std::span<const std::uint8_t> bytes) noexcept {
  return bytes[2] == 0xff;
}

inline bool is_data(std::span<const std::uint8_t> bytes) noexcept {
  return bytes[0] == static_cast<std::uint8_t>(RecordType::kData);
}

// A data record and nothing else, as every datagram of the link is.
inline bool is_one_data(std::span<const std::uint8_t> bytes) noexcept {
  return is_data(bytes) &&
         bytes.size() == kRecordHeader + (std::size_t{bytes[11]} << 8 | bytes[12]);
}

// The random number by which one attempt of a client is told from its next, of a ClientHello that
// is not encrypted; none: it is something else.
inline std::optional<std::array<std::uint8_t, 32>> client_random(
    std::span<const std::uint8_t> bytes) noexcept {
  constexpr std::size_t kHello = kRecordHeader + 12 + 2;  // headers and the client's version
  constexpr std::uint8_t kClientHello = 1;
  const bool plain = bytes[3] == 0 && bytes[4] == 0;  // epoch 0
  if (!plain || bytes.size() < kHello + 32 ||
      bytes[0] != static_cast<std::uint8_t>(RecordType::kHandshake) ||
      bytes[kRecordHeader] != kClientHello) {
    return std::nullopt;
  }
  std::array<std::uint8_t, 32> out{};
  std::copy_n(bytes.begin() + kHello, out.size(), out.begin());
  return out;
}

}  // namespace handrail
