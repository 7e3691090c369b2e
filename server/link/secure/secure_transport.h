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

// Key and list of a folder, and news of them. The error says what needs a key and what to do.
Result<SecureLinkOptions> secure_options(const KeyFolder& folder,
                                         const std::string& what = "the encrypted link");

// A session has begun: where it settles a key that changes, the folder is told.
void settle_keys(const SecureLinkOptions& options, const SessionKeys& begun);

// What is done with news of the keys on the disk.
struct KeyChange {
  ServedTransport::Say say;
  std::function<Status(const OwnEntry& own)> take_own;
  std::function<void(const TrustList& trusted)> take_trusted;
};
// Follows them: asked every tick, never waits. What cannot be read is said, and changes nothing.
void follow_keys(SecureLinkOptions& options, Nanos now, const KeyChange& change);

// A slave's: listens at `address` (see UdpSocket::open) and `port`.
Result<TransportMaker> listening_link(SecureLinkOptions options, std::string address,
                                      std::uint16_t port);

// A master's: calls a slave, whose name is looked up again while it does not answer.
Result<TransportMaker> calling_link(SecureLinkOptions options, HostPort slave);

}  // namespace handrail
