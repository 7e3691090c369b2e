#include "server/link/secure/secure_context.h"

#include <openssl/core_names.h>
#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/rand.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <algorithm>
#include <string>
#include <utility>

#include "server/keys/certificate.h"

namespace handrail {
namespace {

// The shortest record that these can make is known beforehand, see is_records().
constexpr char kDtlsCiphers[] = "ECDHE-ECDSA-AES128-GCM-SHA256:ECDHE-ECDSA-AES256-GCM-SHA384";
constexpr char kTlsCiphers[] = "TLS_AES_128_GCM_SHA256:TLS_AES_256_GCM_SHA384";
// Ours has some 300 bytes. More than this is not kept for a stranger.
constexpr long kLargestCertificate = 2048;

int attached_index() {
  static const int index = SSL_get_ex_new_index(0, nullptr, nullptr, nullptr, nullptr);
  return index;
}

// Asio has the context's other place for its own.
int context_index() {
  static const int index = SSL_CTX_get_ex_new_index(0, nullptr, nullptr, nullptr, nullptr);
  return index;
}

const SecureContext* context_of(const SSL* ssl) {
  return static_cast<const SecureContext*>(
      SSL_CTX_get_ex_data(SSL_get_SSL_CTX(ssl), context_index()));
}

SecureContext::Attached* attached(const SSL* ssl) {
  return static_cast<SecureContext::Attached*>(SSL_get_ex_data(ssl, attached_index()));
}

// A key's id as a label of a name: "3f2a91bc07de55a1".
std::string server_label(const PublicKey& key) {
  std::string out = key_id(key);
  std::erase(out, '-');
  return out;
}

Status openssl_error(const char* what) {
  std::array<char, 256> text{};
  ERR_error_string_n(ERR_get_error(), text.data(), text.size());
  ERR_clear_error();
  return Status::error(std::string("encryption: ") + what + ": " + text.data());
}

}  // namespace

Result<std::unique_ptr<SecureContext>> SecureContext::make(const OwnKey& key, TrustList trusted,
                                                           Side side, Roles wanted, Over over) {
  std::unique_ptr<SecureContext> out(new SecureContext(std::move(trusted), side, wanted, over));
  if (const Status set = out->set_own(key, std::nullopt); !set) return set;
  if (const Status opened = out->open(); !opened) return opened;
  return out;
}

SecureContext::~SecureContext() {
  EVP_MAC_CTX_free(mac_);
  SSL_CTX_free(context_);
}

Result<SecureContext::Shown> SecureContext::in_envelope(const OwnKey& key) {
  const Certificate certificate = certificate_of(key);
  if (certificate == nullptr) return openssl_error("no certificate can be made");
  return Shown{key, certificate};
}

Status SecureContext::set_own(const OwnKey& key, const std::optional<OwnKey>& next) {
  auto own = in_envelope(key);
  if (!own) return own.status();
  std::optional<Shown> after;
  if (next) {
    auto made = in_envelope(*next);
    if (!made) return made.status();
    after = std::move(*made);
  }
  own_ = std::move(*own);
  next_ = std::move(after);
  return Status::ok();
}

void SecureContext::set_trusted(TrustList trusted) {
  trusted_ = std::move(trusted);
  names_.clear();
  for (const Trusted& entry : trusted_.entries()) {
    if (!entry.roles.has_any(wanted_)) continue;
    const std::string name = server_label(entry.newest());
    if (names_.size() + 1 + name.size() > TLSEXT_MAXLEN_host_name) break;
    if (!names_.empty()) names_ += '.';
    names_ += name;
  }
}

bool SecureContext::show(SSL* ssl, Own which) const noexcept {
  const Shown& shown = which == Own::kNext && next_ ? *next_ : *own_;
  attached(ssl)->own = shown.key.public_key();
  // A name that is too long or has no memory is left out: the server then shows its present key.
  if (side_ == Side::kClient && !names_.empty()) SSL_set_tlsext_host_name(ssl, names_.c_str());
  return SSL_use_cert_and_key(ssl, shown.certificate.get(), shown.key.get(), nullptr, 1) == 1;
}

// Of a server's handshake, whether the client has sent names or not.
int SecureContext::on_name(SSL* ssl, int*, void* context) {
  const auto* self = static_cast<const SecureContext*>(context);
  const char* said = SSL_get_servername(ssl, TLSEXT_NAMETYPE_host_name);
  const std::string_view names = said == nullptr ? "" : said;
  Own which = Own::kKey;
  if (self->next_) {
    const std::string ours = server_label(self->next_->key.public_key());
    if (names.find(ours) != std::string_view::npos) which = Own::kNext;
  }
  return self->show(ssl, which) ? SSL_TLSEXT_ERR_NOACK : SSL_TLSEXT_ERR_ALERT_FATAL;
}

Status SecureContext::open() {
  const bool calls = side_ == Side::kClient;
  if (over_ == Over::kDatagrams) {
    context_ = SSL_CTX_new(calls ? DTLS_client_method() : DTLS_server_method());
  } else {
    context_ = SSL_CTX_new(calls ? TLS_client_method() : TLS_server_method());
  }
  if (context_ == nullptr) return openssl_error("cannot begin");
  const bool set = set_protocol() && SSL_CTX_set1_groups_list(context_, "P-256") == 1 &&
                   SSL_CTX_set1_sigalgs_list(context_, "ECDSA+SHA256") == 1;
  if (!set) return openssl_error("cannot be set up");
  SSL_CTX_set_options(context_, SSL_OP_NO_QUERY_MTU | SSL_OP_NO_TICKET | SSL_OP_NO_RENEGOTIATION |
                                    SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_max_cert_list(context_, kLargestCertificate);
  SSL_CTX_set_session_cache_mode(context_, SSL_SESS_CACHE_OFF);
  SSL_CTX_set_verify(context_, SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, nullptr);
  SSL_CTX_set_cert_verify_callback(context_, verify, this);
  SSL_CTX_set_cookie_generate_cb(context_, cookie_of);
  SSL_CTX_set_cookie_verify_cb(context_, is_cookie);
  if (side_ == Side::kServer) {  // a client's is called too
    SSL_CTX_set_tlsext_servername_callback(context_, on_name);
    SSL_CTX_set_tlsext_servername_arg(context_, this);
  }
  SSL_CTX_set_ex_data(context_, context_index(), this);
  return over_ == Over::kDatagrams ? open_cookies() : Status::ok();
}

bool SecureContext::set_protocol() {
  const int version = over_ == Over::kDatagrams ? DTLS1_2_VERSION : TLS1_3_VERSION;
  if (SSL_CTX_set_min_proto_version(context_, version) != 1) return false;
  if (SSL_CTX_set_max_proto_version(context_, version) != 1) return false;
  if (over_ == Over::kDatagrams) return SSL_CTX_set_cipher_list(context_, kDtlsCiphers) == 1;
  return SSL_CTX_set_ciphersuites(context_, kTlsCiphers) == 1 &&
         SSL_CTX_set_num_tickets(context_, 0) == 1;
}

Status SecureContext::open_cookies() {
  std::array<std::uint8_t, 32> secret{};
  EVP_MAC* mac = EVP_MAC_fetch(nullptr, "HMAC", nullptr);
  mac_ = EVP_MAC_CTX_new(mac);
  EVP_MAC_free(mac);
  std::string digest = "SHA256";
  const std::array<OSSL_PARAM, 2> parameters = {
      OSSL_PARAM_construct_utf8_string(OSSL_MAC_PARAM_DIGEST, digest.data(), 0),
      OSSL_PARAM_construct_end()};
  const bool keyed = RAND_bytes(secret.data(), static_cast<int>(secret.size())) == 1 &&
                     EVP_MAC_init(mac_, secret.data(), secret.size(), parameters.data()) == 1;
  OPENSSL_cleanse(secret.data(), secret.size());
  return keyed ? Status::ok() : openssl_error("no random numbers");
}

bool SecureContext::trusts(const PublicKey& key) const noexcept {
  const Trusted* entry = trusted_.find(key);
  return entry != nullptr && entry->roles.has_any(wanted_);
}

void SecureContext::attach(SSL* ssl, Attached* what) {
  SSL_set_ex_data(ssl, attached_index(), what);
}

bool SecureContext::make_cookie(const Address& address,
                                std::array<std::uint8_t, 16>& cookie) const noexcept {
  std::array<std::uint8_t, 32> whole{};
  std::size_t size = 0;
  const std::array<std::uint8_t, 2> port = {static_cast<std::uint8_t>(address.port >> 8),
                                            static_cast<std::uint8_t>(address.port & 0xff)};
  const bool made = EVP_MAC_init(mac_, nullptr, 0, nullptr) == 1 &&
                    EVP_MAC_update(mac_, address.ip.data(), address.ip.size()) == 1 &&
                    EVP_MAC_update(mac_, port.data(), port.size()) == 1 &&
                    EVP_MAC_final(mac_, whole.data(), &size, whole.size()) == 1;
  std::copy_n(whole.begin(), cookie.size(), cookie.begin());
  return made;
}

int SecureContext::verify(X509_STORE_CTX* store, void* context) {
  const auto* self = static_cast<const SecureContext*>(context);
  const auto* ssl = static_cast<const SSL*>(
      X509_STORE_CTX_get_ex_data(store, SSL_get_ex_data_X509_STORE_CTX_idx()));
  PeerKey& peer = attached(ssl)->peer;
  const X509* certificate = X509_STORE_CTX_get0_cert(store);
  const EVP_PKEY* key = certificate == nullptr ? nullptr : X509_get0_pubkey(certificate);
  peer.shown = public_half(key, peer.key);
  peer.trusted = peer.shown && self->trusts(peer.key);
  if (!peer.trusted) X509_STORE_CTX_set_error(store, X509_V_ERR_CERT_REJECTED);
  return peer.trusted ? 1 : 0;
}

int SecureContext::cookie_of(SSL* ssl, unsigned char* cookie, unsigned int* size) {
  const SecureContext* self = context_of(ssl);
  std::array<std::uint8_t, 16> out{};
  if (!self->make_cookie(attached(ssl)->address, out)) return 0;
  std::copy(out.begin(), out.end(), cookie);
  *size = static_cast<unsigned int>(out.size());
  return 1;
}

int SecureContext::is_cookie(SSL* ssl, const unsigned char* cookie, unsigned int size) {
  const SecureContext* self = context_of(ssl);
  std::array<std::uint8_t, 16> expected{};
  return size == expected.size() && self->make_cookie(attached(ssl)->address, expected) &&
         CRYPTO_memcmp(cookie, expected.data(), expected.size()) == 0;
}

}  // namespace handrail
