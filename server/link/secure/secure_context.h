// What every encrypted session of a program shares: its key, whom it trusts, what it agrees to.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <openssl/types.h>

#include "server/base/status.h"
#include "server/keys/own_key.h"
#include "server/keys/trust_list.h"
#include "server/link/secure/address.h"

namespace handrail {

// What a channel's verification has found out about the other side.
struct PeerKey {
  bool shown = false;    // it has shown a key
  bool trusted = false;  // ... which is in the list, with the role that is asked for
  PublicKey key;
};

// What both sides of a session have shown.
struct SessionKeys {
  PublicKey ours, theirs;
};

// DTLS 1.2 (RFC 6347) for the link's datagrams, TLS 1.3 (RFC 8446) for operators' streams, with
// AEAD ciphers only. Both sides show a certificate; of it nothing but the public key is looked at,
// which has to be in the list with a role that is asked for: no names, dates or authorities.
// Sessions are never resumed or renegotiated. Must outlive its channels.
class SecureContext {
 public:
  enum class Side : std::uint8_t { kClient, kServer };
  enum class Over : std::uint8_t { kDatagrams, kStream };

  // Which of our keys a channel shows.
  enum class Own : std::uint8_t { kKey, kNext };

  // `wanted`: the roles of which the other side's key has to have one.
  static Result<std::unique_ptr<SecureContext>> make(const OwnKey& key, TrustList trusted,
                                                     Side side, Roles wanted,
                                                     Over over = Over::kDatagrams);
  ~SecureContext();
  SecureContext(const SecureContext&) = delete;
  SecureContext& operator=(const SecureContext&) = delete;

  // For handshakes from now on. A server shows `next` to who asks for it by name (proto/WIRE.md),
  // and `key` to everybody else. Without an effect where it fails.
  Status set_own(const OwnKey& key, const std::optional<OwnKey>& next);
  bool has_next() const noexcept { return next_.has_value(); }
  // The one that is to be used, if there are two.
  const PublicKey& newest_own() const noexcept {
    return next_ ? next_->key.public_key() : own_->key.public_key();
  }
  // For channels made from now on, and for those that are open: see trusts().
  void set_trusted(TrustList trusted);
  bool trusts(const PublicKey& key) const noexcept;
  const TrustList& trusted() const noexcept { return trusted_; }
  Side side() const noexcept { return side_; }
  Roles wanted() const noexcept { return wanted_; }
  SSL_CTX* get() const noexcept { return context_; }

  // A channel's place in an SSL: where its PeerKey and the address it speaks with are.
  struct Attached {
    PeerKey peer;
    PublicKey own;  // the key of ours that it shows
    Address address;
  };
  static void attach(SSL* ssl, Attached* what);
  // Has an SSL with an Attached show a key of ours, the present one where there is no next; a
  // client's also names whom it calls. False: OpenSSL has no memory.
  bool show(SSL* ssl, Own which) const noexcept;

 private:
  SecureContext(TrustList trusted, Side side, Roles wanted, Over over)
      : side_(side), wanted_(wanted), over_(over) {
    set_trusted(std::move(trusted));
  }
  // A key in the envelope that TLS wants.
  struct Shown {
    OwnKey key;
    std::shared_ptr<X509> certificate;
  };
  static Result<Shown> in_envelope(const OwnKey& key);
  Status open();
  // The protocol and what it encrypts with. False: OpenSSL has it not.
  bool set_protocol();
  Status open_cookies();
  // Proves that who asks can receive at the address it names: nothing is kept for who cannot.
  bool make_cookie(const Address& address, std::array<std::uint8_t, 16>& cookie) const noexcept;

  static int on_name(SSL* ssl, int* alert, void* context);
  static int verify(X509_STORE_CTX* store, void* context);
  static int cookie_of(SSL* ssl, unsigned char* cookie, unsigned int* size);
  static int is_cookie(SSL* ssl, const unsigned char* cookie, unsigned int size);

  TrustList trusted_;
  std::string names_;  // of those a client calls, as it says them
  std::optional<Shown> own_, next_;
  Side side_;
  Roles wanted_;
  Over over_;
  SSL_CTX* context_ = nullptr;
  EVP_MAC_CTX* mac_ = nullptr;
};

}  // namespace handrail
