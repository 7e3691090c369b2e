// The encrypted link as a daemon serves it: keys, socket, session.
#pragma once

#include <memory>
#include <string>

#include "server/base/status.h"
#include "server/keys/key_folder.h"
#include "server/link/secure/key_watch.h"
#include "server/link/secure/peer_resolver.h"
#include "server/link/transport.h"

namespace handrail {

struct SecureLinkOptions {
  OwnEntry own;
  TrustList trusted;
  std::shared_ptr<KeyWatch> watch;  // asked every tick; null: keys never change
};

// Key and list of a folder, and news of them. The error says what to do.
Result<SecureLinkOptions> secure_options(const KeyFolder& folder);

// A slave's: listens at `address` (see UdpSocket::open) and `port`.
Result<TransportMaker> listening_link(SecureLinkOptions options, std::string address,
                                      std::uint16_t port);

// A master's: calls a slave, whose name is looked up again while it does not answer.
Result<TransportMaker> calling_link(SecureLinkOptions options, HostPort slave);

}  // namespace handrail
