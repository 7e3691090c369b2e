// Who a program or a person is to others: the public half of a key.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/base/status.h"

namespace handrail {

// A point of the curve P-256, compressed (SEC 1, section 2.3.3): 33 bytes. Ed25519 would be shorter
// and simpler; OpenSSL 3.0 does not do it in DTLS.
struct PublicKey {
  static constexpr std::size_t kBytes = 33;
  std::array<std::uint8_t, kBytes> bytes{};

  friend bool operator==(const PublicKey&, const PublicKey&) = default;
};

// "p256:" and 44 characters of base64.
std::string key_text(const PublicKey& key);

// The other way. The error says what was expected.
Result<PublicKey> parse_key(std::string_view text);

// To be read aloud and compared: "3f2a-91bc-07de-55a1", the first 64 bits of the key's SHA-256. Not
// for decisions: the whole key is compared.
std::string key_id(const PublicKey& key);

}  // namespace handrail
