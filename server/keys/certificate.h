// The envelope that TLS wants a public key in.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <openssl/types.h>

#include "server/keys/own_key.h"

namespace handrail {

using Certificate = std::shared_ptr<X509>;

// Signed with the key itself. Its dates are all of time, so that no clock matters. Without `names`
// as the programs show it to each other, who look at nothing in it but the key; for browsers with
// the names and addresses at which they find us, and a number of its own: some refuse two with the
// same one. Another one each time. Null: OpenSSL has no memory, or a name is none.
Certificate certificate_of(const OwnKey& key, const std::vector<std::string>& names = {});

std::string certificate_pem(const Certificate& certificate);
// Null: none is there.
Certificate parse_certificate(std::string_view pem);
// True when it holds this key.
bool holds_key(const Certificate& certificate, const PublicKey& key);

// SHA-256 of the whole certificate as browsers show it: "3F:2A:91:...", 32 bytes. Its first eight
// in the form of key_id(): "3f2a-91bc-07de-55a1".
std::string fingerprint(const Certificate& certificate);
std::string fingerprint_start(const Certificate& certificate);

}  // namespace handrail
