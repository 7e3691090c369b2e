#include "server/keys/pairing/pairing_code.h"

#include <openssl/rand.h>

#include <array>
#include <cstdint>
#include <cstring>

namespace handrail {

Result<PairingCode> PairingCode::make() {
  // Numbers above the last whole round would make some codes likelier.
  constexpr std::uint32_t kWhole = UINT32_MAX / kCodes * kCodes;
  std::uint32_t drawn = kWhole;
  while (drawn >= kWhole) {
    std::array<unsigned char, sizeof(drawn)> bytes{};
    if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
      return Status::error("no code: the system gives no random numbers");
    }
    std::memcpy(&drawn, bytes.data(), bytes.size());
  }
  std::string digits = std::to_string(drawn % kCodes);
  return PairingCode(std::string(kDigits - digits.size(), '0') + digits);
}

Result<PairingCode> PairingCode::parse(std::string_view text) {
  std::string digits;
  for (const char c : text) {
    if (c == ' ' || c == '-' || c == '\t' || c == '\r' || c == '\n') continue;
    if (c < '0' || c > '9' || digits.size() == kDigits) {
      digits.clear();
      break;
    }
    digits += c;
  }
  if (digits.size() == kDigits) return PairingCode(digits);
  return Status::error(
      "that is no code: expected 7 digits such as 482-9137, as the other side's "
      "`handrail keys pair` shows them");
}

}  // namespace handrail
