#include "server/link/secure/record_opener.h"

#include <openssl/core_names.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/kdf.h>
#include <openssl/params.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "server/link/secure/record.h"

namespace handrail {
namespace {

constexpr std::size_t kExplicitNonce = 8, kTag = 16, kRandom = 32;
constexpr std::size_t kLongestKey = 32;  // AES-256
constexpr std::size_t kSalt = 4;

// Two keys and two salts, the client's first (RFC 5246, 6.3; no MAC keys with AEAD).
using KeyBlock = std::array<std::uint8_t, 2 * kLongestKey + 2 * kSalt>;

// The first `size` bytes of the session's key block: PRF(master secret, "key expansion", server's
// random and client's).
bool expand(const SSL* ssl, const EVP_MD* digest, KeyBlock& block, std::size_t size) noexcept {
  std::array<std::uint8_t, SSL_MAX_MASTER_KEY_LENGTH> secret{};
  const std::size_t secret_size =
      SSL_SESSION_get_master_key(SSL_get_session(ssl), secret.data(), secret.size());
  constexpr std::string_view kLabel = "key expansion";
  std::array<std::uint8_t, kLabel.size() + 2 * kRandom> seed{};
  std::uint8_t* const randoms = std::copy(kLabel.begin(), kLabel.end(), seed.begin());
  (void)SSL_get_server_random(ssl, randoms, kRandom);
  (void)SSL_get_client_random(ssl, randoms + kRandom, kRandom);
  std::array<char, 16> name{};
  OPENSSL_strlcpy(name.data(), EVP_MD_get0_name(digest), name.size());
  const std::array<OSSL_PARAM, 4> parameters = {
      OSSL_PARAM_construct_utf8_string(OSSL_KDF_PARAM_DIGEST, name.data(), 0),
      OSSL_PARAM_construct_octet_string(OSSL_KDF_PARAM_SECRET, secret.data(), secret_size),
      OSSL_PARAM_construct_octet_string(OSSL_KDF_PARAM_SEED, seed.data(), seed.size()),
      OSSL_PARAM_construct_end()};
  EVP_KDF* const prf = EVP_KDF_fetch(nullptr, "TLS1-PRF", nullptr);
  EVP_KDF_CTX* const context = EVP_KDF_CTX_new(prf);
  const bool made = context != nullptr && secret_size != 0 &&
                    EVP_KDF_derive(context, block.data(), size, parameters.data()) == 1;
  EVP_KDF_CTX_free(context);
  EVP_KDF_free(prf);
  OPENSSL_cleanse(secret.data(), secret.size());
  return made;
}

// Epoch and number, which rise together.
std::uint64_t number_of(std::span<const std::uint8_t> record) noexcept {
  std::uint64_t out = 0;
  for (const std::uint8_t byte : record.subspan(3, 8)) out = out << 8 | byte;
  return out;
}

}  // namespace

void RecordOpener::Free::operator()(EVP_CIPHER_CTX* context) const noexcept {
  EVP_CIPHER_CTX_free(context);
}

bool RecordOpener::begin(const SSL* ssl) noexcept {
  const SSL_CIPHER* const suite = SSL_get_current_cipher(ssl);
  const EVP_CIPHER* const cipher = EVP_get_cipherbynid(SSL_CIPHER_get_cipher_nid(suite));
  const EVP_MD* const digest = SSL_CIPHER_get_handshake_digest(suite);
  if (cipher == nullptr || digest == nullptr) return false;
  const auto key_size = static_cast<std::size_t>(EVP_CIPHER_get_key_length(cipher));
  if (EVP_CIPHER_get_mode(cipher) != EVP_CIPH_GCM_MODE || key_size > kLongestKey) return false;
  KeyBlock block{};
  const bool from_client = SSL_is_server(ssl) == 1;  // what we open
  const std::uint8_t* const key = block.data() + (from_client ? 0 : key_size);
  const std::uint8_t* const salt = block.data() + 2 * key_size + (from_client ? 0 : kSalt);
  cipher_.reset(EVP_CIPHER_CTX_new());
  const bool keyed = cipher_ != nullptr && expand(ssl, digest, block, 2 * (key_size + kSalt)) &&
                     EVP_DecryptInit_ex(cipher_.get(), cipher, nullptr, key, nullptr) == 1;
  std::copy_n(salt, kSalt, salt_.begin());
  OPENSSL_cleanse(block.data(), block.size());
  return keyed;
}

std::size_t RecordOpener::open(std::span<const std::uint8_t> record,
                               std::span<std::uint8_t> plain) noexcept {
  const std::uint64_t number = number_of(record);
  if (record.size() <= kRecordHeader + kSealing || !is_new(number)) return 0;
  const std::size_t size = record.size() - kRecordHeader - kSealing;
  if (size > plain.size() || !decrypt(record, plain.first(size))) return 0;
  mark(number);
  return size;
}

bool RecordOpener::is_new(std::uint64_t number) const noexcept {
  if (number > newest_) return true;
  const std::uint64_t back = newest_ - number;
  return back < seen_.size() && !seen_.test(back);
}

void RecordOpener::mark(std::uint64_t number) noexcept {
  if (number > newest_) {
    const std::uint64_t step = number - newest_;
    step < seen_.size() ? seen_ <<= step : seen_.reset();
    newest_ = number;
  }
  seen_.set(newest_ - number);
}

bool RecordOpener::decrypt(std::span<const std::uint8_t> record,
                           std::span<std::uint8_t> plain) noexcept {
  const auto sealed = record.subspan(kRecordHeader);
  std::array<std::uint8_t, kSalt + kExplicitNonce> nonce{};
  std::copy_n(sealed.begin(), kExplicitNonce, std::copy(salt_.begin(), salt_.end(), nonce.begin()));
  // What is authenticated beside it: number, type, version, and the length without the sealing.
  std::array<std::uint8_t, kRecordHeader> header{};
  std::copy_n(record.begin() + 3, 8, header.begin());
  std::copy_n(record.begin(), 3, header.begin() + 8);
  header[11] = static_cast<std::uint8_t>(plain.size() >> 8);
  header[12] = static_cast<std::uint8_t>(plain.size() & 0xff);
  std::array<std::uint8_t, kTag> tag{};
  std::copy(sealed.end() - kTag, sealed.end(), tag.begin());
  EVP_CIPHER_CTX* const cipher = cipher_.get();
  int count = 0;
  return EVP_DecryptInit_ex(cipher, nullptr, nullptr, nullptr, nonce.data()) == 1 &&
         EVP_DecryptUpdate(cipher, nullptr, &count, header.data(), kRecordHeader) == 1 &&
         EVP_DecryptUpdate(cipher, plain.data(), &count, sealed.data() + kExplicitNonce,
                           static_cast<int>(plain.size())) == 1 &&
         EVP_CIPHER_CTX_ctrl(cipher, EVP_CTRL_AEAD_SET_TAG, kTag, tag.data()) == 1 &&
         EVP_DecryptFinal_ex(cipher, tag.data(), &count) == 1;
}

}  // namespace handrail
