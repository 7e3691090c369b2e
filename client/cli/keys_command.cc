#include "client/cli/keys_command.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>

#include "server/base/operator_name.h"
#include "server/base/plain_text.h"
#include "server/keys/key_folder.h"

namespace handrail {
namespace {

std::string json_of(const Trusted& entry) {
  // Names, roles and keys have no letter that JSON would want escaped.
  std::string out = R"({"name": ")" + entry.name + R"(", "roles": ")" + roles_text(entry.roles) +
                    R"(", "id": ")" + key_id(entry.key) + R"(", "key": ")" + key_text(entry.key);
  if (entry.next) {
    out += R"(", "next_id": ")" + key_id(*entry.next) + R"(", "next": ")" + key_text(*entry.next);
  }
  return out + "\"}";
}

void show(const Console& console, const OwnEntry& own) {
  console.err << "key " << key_id(own.key.public_key());
  if (own.next) {
    const auto list = own_keys().trusted();
    const auto waits = list ? KeyFolder::waits_for(own, *list) : std::vector<std::string>();
    console.err << ", the next " << key_id(own.next->public_key()) << " (confirmed by "
                << (own.confirmed.empty() ? "nobody" : joined(own.confirmed, ", "))
                << "; waits for " << (waits.empty() ? "nobody" : joined(waits, ", ")) << ")";
  }
  console.err << "; on the computer that is to trust it, type this line:\n";
  console.out << "handrail keys trust " << line_text(own.entry()) << '\n';
}

}  // namespace

KeyFolder own_keys() { return KeyFolder(default_key_folder()); }

ExitCode refuse_keys(const Console& console, const std::string& text) {
  console.err << "handrail: " << text << '\n';
  return kExitRefused;
}

std::string computer_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "computer";
  std::string out(name.data());
  out.resize(std::min({out.find('.'), out.size(), std::size_t{32}}));
  std::erase_if(out, [](char c) { return !is_operator_name(std::string_view(&c, 1)); });
  return out.empty() ? "computer" : out;
}

ExitCode run_keys_new(const Options& o, const Console& console) {
  const Roles roles = parse_roles(*o.word);
  if (roles.empty()) return complain(console, "keys new: '" + *o.word + "': " + kRolesExpected);
  if (own_keys().has_key()) {
    // The next key is called as the present one: who trusts it knows both by one name.
    const auto own = own_keys().load();
    if (!own) return refuse_keys(console, own.message());
    if (own->roles != roles || (!o.as.empty() && o.as != own->name)) {
      return refuse_keys(console, "there is a key already, of " + own->name + " as " +
                                      roles_text(own->roles) +
                                      ": a next one has the same name and roles; for others "
                                      "remove " +
                                      own_keys().key_path() + " first, as for a lost key");
    }
    const auto made = own_keys().create_next();
    if (!made) return refuse_keys(console, made.message());
    show(console, *made);
    return kExitDone;
  }
  const auto made = own_keys().create(o.as.empty() ? computer_name() : o.as, roles);
  if (!made) return refuse_keys(console, made.message());
  show(console, *made);
  return kExitDone;
}

ExitCode run_keys_retire(const Options&, const Console& console) {
  const auto done = own_keys().retire();
  if (!done) return refuse_keys(console, done.message());
  console.out << *done << '\n';
  return kExitDone;
}

ExitCode run_keys_show(const Options& o, const Console& console) {
  const auto own = own_keys().load();
  if (!own) return refuse_keys(console, own.message());
  if (o.json) {
    console.out << json_of(own->entry()) << '\n';
  } else {
    show(console, *own);
  }
  return kExitDone;
}

ExitCode run_keys_trust(const Options& o, const Console& console) {
  if (const auto problem = operator_name_problem(*o.word); !problem.empty()) {
    return complain(console, "keys trust: " + problem);
  }
  const Roles roles = parse_roles(*o.roles);
  if (roles.empty()) return complain(console, "keys trust: '" + *o.roles + "': " + kRolesExpected);
  const auto key = parse_key(*o.key);
  if (!key) return complain(console, "keys trust: " + key.message());
  Trusted entry{*o.word, roles, *key};
  if (o.next) {
    const auto next = parse_key(*o.next);
    if (!next) return complain(console, "keys trust: " + next.message());
    if (*next == *key) return complain(console, "keys trust: the next key is the key itself");
    entry.next = *next;
  }
  const auto done = own_keys().trust(entry);
  if (!done) return refuse_keys(console, done.message());
  console.out << *done << '\n';
  return kExitDone;
}

ExitCode run_keys_list(const Options& o, const Console& console) {
  const auto list = own_keys().trusted();
  if (!list) return refuse_keys(console, list.message());
  if (o.json) {
    console.out << "[";
    const char* before = "";
    for (const Trusted& entry : list->entries()) {
      console.out << std::exchange(before, ",\n ") << json_of(entry);
    }
    console.out << "]\n";
    return kExitDone;
  }
  if (list->entries().empty()) {
    console.err
        << "nobody is trusted: `handrail keys show` on another computer prints the line that "
           "makes it so\n";
  }
  for (const Trusted& entry : list->entries()) {
    console.out << entry.name << "  " << roles_text(entry.roles) << "  " << key_id(entry.key)
                << (entry.next
                        ? ", the next " + key_id(*entry.next) + " waits for its first session"
                        : std::string())
                << '\n';
  }
  return kExitDone;
}

ExitCode run_keys_remove(const Options& o, const Console& console) {
  const auto done = own_keys().distrust(*o.word);
  if (!done) return refuse_keys(console, done.message());
  console.out << *done << "; a session of it ends within a second\n";
  return kExitDone;
}

}  // namespace handrail
