#include "server/keys/own_key.h"

#include <openssl/bio.h>
#include <openssl/core_names.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace handrail {
namespace {

using Bio = std::unique_ptr<BIO, decltype(&BIO_free)>;

// A file that is locked by a passphrase is not asked about: a daemon has nobody to ask.
int no_passphrase(char*, int, int, void*) { return -1; }

}  // namespace

bool public_half(const EVP_PKEY* key, PublicKey& out) noexcept {
  if (key == nullptr || EVP_PKEY_get_base_id(key) != EVP_PKEY_EC) return false;
  std::array<char, 32> group{};
  std::array<unsigned char, 65> point{};  // 4, x, y; or 2 or 3, x
  std::size_t size = 0;
  if (EVP_PKEY_get_group_name(key, group.data(), group.size(), nullptr) != 1 ||
      std::string_view(group.data()) != "prime256v1" ||
      EVP_PKEY_get_octet_string_param(key, OSSL_PKEY_PARAM_PUB_KEY, point.data(), point.size(),
                                      &size) != 1) {
    return false;
  }
  const bool whole = size == point.size() && point[0] == 4;
  if (!whole && size != PublicKey::kBytes) return false;
  std::copy_n(point.begin(), out.bytes.size(), out.bytes.begin());
  if (whole) out.bytes[0] = static_cast<std::uint8_t>(2 + (point.back() & 1));
  return true;
}

Result<OwnKey> OwnKey::generate() {
  Handle key(EVP_PKEY_Q_keygen(nullptr, nullptr, "EC", "P-256"), EVP_PKEY_free);
  return of(std::move(key));
}

Result<OwnKey> OwnKey::parse(std::string_view pem) {
  const Bio bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())), BIO_free);
  Handle key(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_passphrase, nullptr), EVP_PKEY_free);
  ERR_clear_error();
  return of(std::move(key));
}

Result<OwnKey> OwnKey::of(Handle key) {
  OwnKey out;
  const bool fits = public_half(key.get(), out.public_);
  ERR_clear_error();
  if (!fits)
    return Status::error(
        "no private key: expected one of the curve P-256 in PEM, without passphrase");
  out.key_ = std::move(key);
  return out;
}

std::string OwnKey::pem() const {
  const Bio bio(BIO_new(BIO_s_mem()), BIO_free);
  PEM_write_bio_PKCS8PrivateKey(bio.get(), key_.get(), nullptr, nullptr, 0, nullptr, nullptr);
  char* text = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &text);
  return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : std::string();
}

}  // namespace handrail
