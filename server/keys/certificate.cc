#include "server/keys/certificate.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/sha.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <array>
#include <memory>

namespace handrail {
namespace {

using Bio = std::unique_ptr<BIO, decltype(&BIO_free)>;

bool add_extension(X509* to, int what, const std::string& value) {
  using Extension = std::unique_ptr<X509_EXTENSION, decltype(&X509_EXTENSION_free)>;
  const Extension made(X509V3_EXT_conf_nid(nullptr, nullptr, what, value.c_str()),
                       X509_EXTENSION_free);
  return made != nullptr && X509_add_ext(to, made.get(), -1) == 1;
}

bool add_number(X509* to) {
  std::array<unsigned char, 8> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) return false;
  std::uint64_t number = 0;
  for (const unsigned char byte : bytes) number = number << 8 | byte;
  // Positive, as RFC 5280, 4.1.2.2, wants it.
  return ASN1_INTEGER_set_uint64(X509_get_serialNumber(to), number >> 1 | 1) == 1;
}

bool add_names(X509* to, const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) {
    const std::unique_ptr<ASN1_OCTET_STRING, decltype(&ASN1_OCTET_STRING_free)> address(
        a2i_IPADDRESS(name.c_str()), ASN1_OCTET_STRING_free);
    const bool none = address == nullptr;
    // Another letter would make the list one of other things.
    const bool plain =
        name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789.-") == std::string::npos;
    if (name.empty() || (none && !plain)) return false;
    if (!list.empty()) list += ',';
    list.append(none ? "DNS:" : "IP:").append(name);
  }
  return add_number(to) && add_extension(to, NID_subject_alt_name, list) &&
         add_extension(to, NID_ext_key_usage, "serverAuth");
}

std::array<unsigned char, SHA256_DIGEST_LENGTH> hash_of(const Certificate& certificate) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> out{};
  unsigned size = 0;
  X509_digest(certificate.get(), EVP_sha256(), out.data(), &size);
  return out;
}

}  // namespace

Certificate certificate_of(const OwnKey& key, const std::vector<std::string>& names) {
  Certificate out(X509_new(), X509_free);
  X509_NAME* name = X509_get_subject_name(out.get());
  std::string called = "handrail";
  if (!names.empty()) called.append(" ").append(key_id(key.public_key()));
  const auto* text = reinterpret_cast<const unsigned char*>(called.c_str());
  const bool made = X509_set_version(out.get(), X509_VERSION_3) == 1 &&
                    ASN1_INTEGER_set(X509_get_serialNumber(out.get()), 1) == 1 &&
                    ASN1_TIME_set_string(X509_getm_notBefore(out.get()), "19700101000000Z") == 1 &&
                    ASN1_TIME_set_string(X509_getm_notAfter(out.get()), "99991231235959Z") == 1 &&
                    X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC, text, -1, -1, 0) == 1 &&
                    X509_set_issuer_name(out.get(), name) == 1 &&
                    X509_set_pubkey(out.get(), key.get()) == 1 &&
                    (names.empty() || add_names(out.get(), names)) &&
                    X509_sign(out.get(), key.get(), EVP_sha256()) > 0;
  ERR_clear_error();
  return made ? out : nullptr;
}

std::string certificate_pem(const Certificate& certificate) {
  const Bio bio(BIO_new(BIO_s_mem()), BIO_free);
  PEM_write_bio_X509(bio.get(), certificate.get());
  char* text = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &text);
  return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : std::string();
}

Certificate parse_certificate(std::string_view pem) {
  const Bio bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())), BIO_free);
  Certificate out(PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr), X509_free);
  ERR_clear_error();
  return out;
}

bool holds_key(const Certificate& certificate, const PublicKey& key) {
  PublicKey held;
  return public_half(X509_get0_pubkey(certificate.get()), held) && held == key;
}

std::string fingerprint(const Certificate& certificate) {
  std::string out;
  for (const unsigned char byte : hash_of(certificate)) {
    if (!out.empty()) out += ':';
    for (const unsigned digit : {byte / 16u, byte % 16u}) out += "0123456789ABCDEF"[digit];
  }
  return out;
}

std::string fingerprint_start(const Certificate& certificate) {
  const auto hash = hash_of(certificate);
  std::string out;
  for (std::size_t i = 0; i < 8; ++i) {
    if (i != 0 && i % 2 == 0) out += '-';
    for (const unsigned digit : {hash[i] / 16u, hash[i] % 16u}) out += "0123456789abcdef"[digit];
  }
  return out;
}

}  // namespace handrail
