#include "client/console/web_tls.h"

#include <openssl/err.h>
#include <openssl/ssl.h>

#include <array>
#include <string>

namespace handrail {

Result<std::shared_ptr<SSL_CTX>> web_tls(const OwnKey& key, const Certificate& certificate) {
  std::shared_ptr<SSL_CTX> out(SSL_CTX_new(TLS_server_method()), SSL_CTX_free);
  SSL_CTX* context = out.get();
  const bool set = context != nullptr &&
                   SSL_CTX_set_min_proto_version(context, TLS1_3_VERSION) == 1 &&
                   SSL_CTX_set_num_tickets(context, 0) == 1 &&
                   SSL_CTX_use_cert_and_key(context, certificate.get(), key.get(), nullptr, 1) == 1;
  if (set) {
    SSL_CTX_set_options(context, SSL_OP_NO_TICKET | SSL_OP_NO_RENEGOTIATION);
    SSL_CTX_set_session_cache_mode(context, SSL_SESS_CACHE_OFF);
    // Hundreds of strangers who say nothing hold no buffers.
    SSL_CTX_set_mode(context, SSL_MODE_RELEASE_BUFFERS);
    return out;
  }
  std::array<char, 256> text{};
  ERR_error_string_n(ERR_get_error(), text.data(), text.size());
  ERR_clear_error();
  return Status::error(std::string("encryption cannot be set up: ") + text.data());
}

}  // namespace handrail
