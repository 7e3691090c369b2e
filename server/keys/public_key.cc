#include "server/keys/public_key.h"

#include <openssl/evp.h>
#include <openssl/sha.h>

#include <algorithm>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr std::string_view kPrefix = "p256:";
constexpr std::size_t kDigits = 44;  // of base64, for 33 bytes

}  // namespace

std::string key_text(const PublicKey& key) {
  std::array<unsigned char, kDigits + 1> digits{};
  EVP_EncodeBlock(digits.data(), key.bytes.data(), static_cast<int>(PublicKey::kBytes));
  return std::string(kPrefix) + reinterpret_cast<const char*>(digits.data());
}

Result<PublicKey> parse_key(std::string_view text) {
  const std::string expected =
      "expected p256: and 44 characters of base64, as `handrail keys "
      "show` prints it";
  const std::string said = shown(text);
  if (text.size() != kPrefix.size() + kDigits || !text.starts_with(kPrefix)) {
    return Status::error("'" + said + "' is no key: " + expected);
  }
  const std::string_view digits = text.substr(kPrefix.size());
  std::array<unsigned char, kDigits> out{};
  const int size = EVP_DecodeBlock(
      out.data(), reinterpret_cast<const unsigned char*>(digits.data()), static_cast<int>(kDigits));
  PublicKey key;
  std::copy_n(out.begin(), PublicKey::kBytes, key.bytes.begin());
  // 2 or 3 begins a compressed point. Of one key one text.
  const bool point = key.bytes[0] == 2 || key.bytes[0] == 3;
  if (size < 0 || !point || key_text(key) != text) {
    return Status::error("'" + said + "' is no key: " + expected);
  }
  return key;
}

std::string key_id(const PublicKey& key) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> hash{};
  SHA256(key.bytes.data(), key.bytes.size(), hash.data());
  static constexpr char kHex[] = "0123456789abcdef";
  std::string out;
  for (std::size_t i = 0; i < 8; ++i) {
    if (i != 0 && i % 2 == 0) out += '-';
    out += kHex[hash[i] >> 4];
    out += kHex[hash[i] & 15];
  }
  return out;
}

}  // namespace handrail
