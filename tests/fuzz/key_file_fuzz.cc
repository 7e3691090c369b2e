// Files of keys as somebody may have left them: a key of ours, the list of the trusted and what is
// done with it, a code, a host. The first byte says which.
#include "server/keys/host_port.h"
#include "server/keys/own_entry.h"
#include "server/keys/pairing/pairing_code.h"
#include "tests/fuzz/expect_error.h"
#include "tests/fuzz/fixed_random.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail {
namespace {

using fuzz::require;

// Lines that are no entries, in order.
std::vector<std::string> other_lines(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    if (line.substr(0, line.find('#')).find_first_not_of(" \t\r") == std::string::npos) {
      out.push_back(line);
    }
    at = end + 1;
  }
  return out;
}

void try_own_key(const std::string& text) {
  const auto own = parse_own(text);
  if (!own) {
    require(is_plain_text(own.message()) && own.message().size() < 400,
            "an error is plain and short");
    return;
  }
  const auto again = parse_own(own_text(*own, own->key));
  require(again && again->entry() == own->entry() && again->confirmed == own->confirmed,
          "what was read is written so that it reads the same");
}

PublicKey key_of(std::uint8_t which) {
  PublicKey out;
  out.bytes[0] = 2;
  out.bytes[1] = which % 8;
  return out;
}

void check_list(const TrustList& list, const std::vector<std::string>& others) {
  require(other_lines(list.text()) == others, "comments and blank lines stay as they are");
  const auto again = TrustList::parse(list.text(), "trusted");
  require(again && *again == list && again->text() == list.text(),
          "a list reads as it was written");
  for (const Trusted& entry : list.entries()) {
    require(list.find(entry.name) == &entry && list.find(entry.key) == &entry &&
                list.find(entry.newest()) == &entry,
            "no name and no key is there twice");
  }
}

void try_list(fuzz::Input in) {
  const auto acts = in.take_bytes(in.take<std::uint8_t>() % 64);
  const std::string text(fuzz::text_of(in.take_bytes(100000)));
  auto list = TrustList::parse(text, "/keys/trusted");
  if (!list) return fuzz::require_error_at("/keys/trusted:", list.message());
  const auto others = other_lines(list->text());
  check_list(*list, others);
  for (fuzz::Input act(acts); !act.empty();) {
    const auto what = act.take<std::uint8_t>();
    Trusted entry{std::string(1, static_cast<char>('a' + act.take<std::uint8_t>() % 4)),
                  static_cast<Role>(what / 4 % 4), key_of(act.take<std::uint8_t>())};
    if (const PublicKey next = key_of(act.take<std::uint8_t>()); next != entry.key && what >= 128) {
      entry.next = next;
    }
    const TrustList before = *list;
    if (what % 4 == 0) {
      require(list->remove(entry.name) == (before.find(entry.name) != nullptr),
              "who is there goes");
      require(list->find(entry.name) == nullptr, "and is gone");
    } else if (what % 4 == 1) {
      if (list->retire_before(entry.key)) {
        require(list->find(entry.key)->key == entry.key && !list->find(entry.key)->next,
                "a next key takes the place of the key");
      } else {
        require(*list == before, "a key that is nobody's next changes nothing");
      }
    } else if (list->add(entry)) {
      // One that has changed its key to this line's next has done so: its old key stays away.
      const Trusted* was = before.find(entry.name);
      const bool changed = was != nullptr && entry.key != was->key && entry.key != was->next;
      require(!changed || entry.next == was->key, "a key comes in place of its own old one");
      if (changed) entry = {entry.name, entry.roles, was->key, was->next};
      require(*list->find(entry.name) == entry, "what is added is there");
    } else {
      require(*list == before, "what is refused changes nothing");
    }
    check_list(*list, others);
  }
}

void try_words(const std::string& text) {
  if (const auto code = PairingCode::parse(text)) {
    require(PairingCode::parse(code->text())->digits() == code->digits(), "a code reads as shown");
  }
  const auto entry = parse_entry(text);
  require(entry ? parse_entry(line_text(*entry)) && *parse_entry(line_text(*entry)) == *entry
                : is_plain_text(entry.message()),
          "an entry reads as it is written, an error is plain");
  const auto host = parse_host(text, 47002);
  require(host ? host->port != 0 && !host->host.empty() : is_plain_text(host.message()),
          "a host has a port, an error is plain");
}

}  // namespace

HANDRAIL_FUZZ(key_file) {
  fuzz::fix_random();
  fuzz::Input in(bytes);
  switch (in.take<std::uint8_t>() % 3) {
    case 0: return try_own_key(std::string(fuzz::text_of(in.take_bytes(100000))));
    case 1: return try_list(in);
    default: return try_words(std::string(fuzz::text_of(in.take_bytes(100000))));
  }
}

}  // namespace handrail
