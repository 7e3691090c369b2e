// A key of ours, and what it is called.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/keys/own_key.h"
#include "server/keys/trust_list.h"

namespace handrail {

// A key of ours, and what we are to be called by those who trust it.
struct OwnEntry {
  OwnKey key;
  std::string name;
  Roles roles;
  // What is to take the key's place, and who has opened a session with it so far, by name.
  std::optional<OwnKey> next = {};
  std::vector<std::string> confirmed = {};

  Trusted entry() const {
    return {name, roles, key.public_key(),
            next ? std::optional<PublicKey>(next->public_key()) : std::nullopt};
  }
  // True when a key of `other` is one of ours.
  bool is_ours(const Trusted& other) const { return same_keys(entry(), other); }
};

// What the file of a key holds: a line "handrail NAME ROLES", with the names of those who have
// confirmed it, and `key`.
std::string own_text(const OwnEntry& own, const OwnKey& key);
// The other way. The error says what was expected.
Result<OwnEntry> parse_own(const std::string& text);

}  // namespace handrail
