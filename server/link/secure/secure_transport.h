// The encrypted link as a daemon serves it: keys, socket, session.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "server/base/status.h"
#include "server/keys/key_folder.h"
#include "server/link/secure/peer_resolver.h"
#include "server/link/transport.h"

namespace handrail {

// The list of the trusted when it has changed on the disk; asked every tick, must not wait.
using TrustNews = std::function<std::optional<Result<TrustList>>(Nanos now)>;

struct SecureLinkOptions {
  OwnEntry own;
  TrustList trusted;
  TrustNews trust_news;
};

// Key and list of a folder, and news of the list. The error says what needs a key and what to do.
Result<SecureLinkOptions> secure_options(const KeyFolder& folder,
                                         const std::string& what = "the encrypted link");

// A slave's: listens at `address` (see UdpSocket::open) and `port`.
Result<TransportMaker> listening_link(SecureLinkOptions options, std::string address,
                                      std::uint16_t port);

// A master's: calls a slave, whose name is looked up again while it does not answer.
Result<TransportMaker> calling_link(SecureLinkOptions options, HostPort slave);

}  // namespace handrail
