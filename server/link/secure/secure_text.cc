#include "server/link/secure/secure_text.h"

namespace handrail {
namespace {

std::string line_to_type(const Trusted& entry) { return "handrail keys trust " + line_text(entry); }

LinkProblem untrusted(const PeerKey& shown, const std::string& at, const TrustList& trusted,
                      LinkRoles roles) {
  const std::string other = role_text(roles.other);
  if (!shown.shown) {
    return {"what is at " + at + " shows no key that Handrail knows",
            "look at the address and the port: a Handrail " + other + " is expected there"};
  }
  if (const Trusted* known = trusted.find(shown.key)) {
    return {known->name + " at " + at + " is trusted here as " + roles_text(known->roles) +
                ", not as " + other,
            "if that is meant, type here: " +
                line_to_type({known->name, roles.other, known->key, known->next})};
  }
  return {
      "what is at " + at + " shows key " + key_id(shown.key) + ", which is not trusted here (as " +
          other + ": " + those_trusted(trusted, roles.other) + ")",
      "a stranger; or if it is a key of yours, type here what `handrail keys show` prints there, "
      "such as: " +
          line_to_type({"NAME", roles.other, shown.key})};
}

}  // namespace

std::string those_trusted(const TrustList& trusted, Roles roles) {
  std::string out;
  for (const Trusted& entry : trusted.entries()) {
    if (!entry.roles.has_any(roles)) continue;
    if (!out.empty()) out.append(", ");
    out.append(entry.name).append(" ").append(key_id(entry.key));
  }
  return out.empty() ? "nobody" : out;
}

std::string session_text(const TrustList& trusted, const PublicKey& key, const Address& at) {
  const Trusted* who = trusted.find(key);
  std::string out = who == nullptr ? std::string("a stranger") : who->name;
  return out.append(", key ").append(key_id(key)).append(", at ").append(address_text(at));
}

LinkProblem problem_of(DtlsChannel::Problem problem, const PeerKey& shown, const Address& at,
                       const TrustList& trusted, const Trusted& own, LinkRoles roles) {
  using Problem = DtlsChannel::Problem;
  const std::string place = address_text(at);
  const std::string other = role_text(roles.other);
  switch (problem) {
    case Problem::kUntrusted: return untrusted(shown, place, trusted, roles);
    case Problem::kWeAre:
      return {"the " + other + " at " + place + " does not trust our key " + key_id(own.key) +
                  " as " + role_text(roles.own),
              "on that computer, type: " + line_to_type({own.name, roles.own, own.key, own.next})};
    case Problem::kNoAnswer:
      return {"no " + other + " answers at " + place,
              "start it there with `handrail-slave --link any`, and let UDP port " +
                  std::to_string(at.port) + " pass every firewall on the way"};
    case Problem::kNoAgreement:
      return {"what is at " + place + " does not agree on DTLS 1.2 with keys of P-256",
              "install the same Handrail on both computers"};
    case Problem::kNone: break;
  }
  return {};
}

}  // namespace handrail
