// Whom this side lets in: keys with names and roles, in a file of lines.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/base/status.h"
#include "server/keys/public_key.h"
#include "server/keys/roles.h"

namespace handrail {

struct Trusted {
  std::string name;  // as an operator's: 1 to 32 letters, digits, '.', '_' and '-'
  Roles roles;
  PublicKey key;

  friend bool operator==(const Trusted&, const Trusted&) = default;
};

// No name and no key twice.
class TrustList {
 public:
  static constexpr std::size_t kMost = 256;  // entries: a cell has a handful

  // A line an entry: name, roles, key, apart by blanks; '#' begins a comment. The error names the
  // line. `place` stands before it, a file's path.
  static Result<TrustList> parse(std::string_view text, const std::string& place);

  // As parse reads it.
  std::string text() const;

  // null: not here.
  const Trusted* find(const PublicKey& key) const noexcept;
  const Trusted* find(std::string_view name) const noexcept;
  const std::vector<Trusted>& entries() const noexcept { return entries_; }

  // A name or a key that is there already, with another of the two, is an error. The same name and
  // key get these roles.
  Status add(const Trusted& entry);
  // False: no such name.
  bool remove(std::string_view name);

  friend bool operator==(const TrustList&, const TrustList&) = default;

 private:
  std::vector<Trusted> entries_;
};

}  // namespace handrail
