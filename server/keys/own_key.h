// The private half of a key: it proves who we are, and never leaves this computer.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <openssl/types.h>

#include "server/base/status.h"
#include "server/keys/public_key.h"

namespace handrail {

// The public half of `key`. False: it is none of P-256.
bool public_half(const EVP_PKEY* key, PublicKey& out) noexcept;

class OwnKey {
 public:
  // A new one, from the system's random source.
  static Result<OwnKey> generate();
  // From PKCS #8 in PEM. The error says what was expected.
  static Result<OwnKey> parse(std::string_view pem);

  std::string pem() const;
  const PublicKey& public_key() const noexcept { return public_; }
  EVP_PKEY* get() const noexcept { return key_.get(); }

 private:
  using Handle = std::shared_ptr<EVP_PKEY>;
  static Result<OwnKey> of(Handle key);

  Handle key_;
  PublicKey public_;
};

}  // namespace handrail
