// Whom this side lets in: keys with names and roles, in a file of lines.
#pragma once

#include <optional>
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
  // What takes the key's place as soon as it has opened a session; until then both are let in.
  std::optional<PublicKey> next = {};

  // The one that is to be used, if there are two.
  const PublicKey& newest() const { return next ? *next : key; }
  friend bool operator==(const Trusted&, const Trusted&) = default;
};

// True when a key of one is a key of the other.
bool same_keys(const Trusted& a, const Trusted& b);

// As a line of the list and of a message: "desk master p256:...", with the next key behind it.
std::string line_text(const Trusted& entry);
// The other way. The error says what was expected.
Result<Trusted> parse_entry(std::string_view line);

// No name and no key twice. Comments, blank lines and the order of the lines it was read from stay.
class TrustList {
 public:
  static constexpr std::size_t kMost = 256;  // entries: a cell has a handful

  // A line an entry: name, roles, key and a next one if there is, apart by blanks; '#' begins a
  // comment. The error names the line. `place` stands before it, a file's path.
  static Result<TrustList> parse(std::string_view text, const std::string& place);

  // As parse reads it. What no add() or remove() has changed is byte for byte as it was read.
  std::string text() const;

  // null: not here. A key that is somebody's next is here.
  const Trusted* find(const PublicKey& key) const noexcept;
  const Trusted* find(std::string_view name) const noexcept;
  const std::vector<Trusted>& entries() const noexcept { return entries_; }

  // A name or a key that is there already, with another of the two, is an error. The same name and
  // key get these roles and this next key, or none. A name whose next key comes as its key has no
  // other from then on, and one whose key comes as its next has changed it already: the old one is
  // not let in again.
  Status add(const Trusted& entry);
  // Where `key` is somebody's next, it is the key from now on, and the old one is not here. The
  // entry as it was; none: `key` is nobody's next.
  std::optional<Trusted> retire_before(const PublicKey& key);
  // False: no such name. Its line goes, with a comment behind it.
  bool remove(std::string_view name);

  // The same entries in the same order.
  friend bool operator==(const TrustList& a, const TrustList& b) {
    return a.entries_ == b.entries_;
  }

 private:
  // As read or as to be written, without its end. Those with `entry` are entries_, in order.
  struct Line {
    std::string text;
    bool entry = false;
  };
  // The line of entries_[index].
  std::vector<Line>::iterator line_of(std::size_t index);
  void replace(std::size_t index, const Trusted& entry);
  std::size_t index_of(const Trusted* entry) const {
    return static_cast<std::size_t>(entry - entries_.data());
  }

  std::vector<Trusted> entries_;
  std::vector<Line> lines_;
};

}  // namespace handrail
