// What a person is told of keys and sessions.
#pragma once

#include <string>

#include "server/keys/trust_list.h"
#include "server/link/secure/dtls_channel.h"

namespace handrail {

// Who one end calls for, and what it is itself.
struct LinkRoles {
  Role own;
  Role other;
};

// "cell 3f2a-91bc-07de-55a1, north ...": those with one of the roles; "nobody".
std::string those_trusted(const TrustList& trusted, Roles roles);

// "cell, key 3f2a-91bc-07de-55a1, at 192.0.2.7:47002".
std::string session_text(const TrustList& trusted, const PublicKey& key, const Address& at);

// Why there is no session, and what to do about it.
struct LinkProblem {
  std::string fact;  // empty: nothing is known
  std::string next;
  std::string text() const { return fact.empty() ? fact : fact + ": " + next; }
};

// Why what was called or has called at `at` is not let in, or does not let us in, and what to type
// where. `own`: our key, as it is called.
LinkProblem problem_of(DtlsChannel::Problem problem, const PeerKey& shown, const Address& at,
                       const TrustList& trusted, const Trusted& own, LinkRoles roles);

}  // namespace handrail
