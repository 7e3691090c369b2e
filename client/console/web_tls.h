// TLS as browsers on other computers speak it.
#pragma once

#include <memory>

#include <openssl/types.h>

#include "server/base/status.h"
#include "server/keys/certificate.h"

namespace handrail {

// TLS 1.3 (RFC 8446) with AEAD ciphers, this user's key in that certificate; who calls shows none.
// Sessions are never resumed.
Result<std::shared_ptr<SSL_CTX>> web_tls(const OwnKey& key, const Certificate& certificate);

}  // namespace handrail
