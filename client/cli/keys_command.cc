#include "client/cli/keys_command.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>

#include "server/base/operator_name.h"
#include "server/keys/key_folder.h"

namespace handrail {
namespace {

KeyFolder folder() { return KeyFolder(default_key_folder()); }

ExitCode say_no(const Console& console, const std::string& text) {
  console.err << "handrail: " << text << '\n';
  return kExitRefused;
}

// This computer's name up to the first dot, of the letters that a name may have.
std::string computer_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "computer";
  std::string out(name.data());
  out.resize(std::min({out.find('.'), out.size(), std::size_t{32}}));
  std::erase_if(out, [](char c) { return !is_operator_name(std::string_view(&c, 1)); });
  return out.empty() ? "computer" : out;
}

std::string line_of(const Trusted& entry) {
  return entry.name + " " + roles_text(entry.roles) + " " + key_text(entry.key);
}

std::string json_of(const Trusted& entry) {
  // Names, roles and keys have no letter that JSON would want escaped.
  return R"({"name": ")" + entry.name + R"(", "roles": ")" + roles_text(entry.roles) +
         R"(", "id": ")" + key_id(entry.key) + R"(", "key": ")" + key_text(entry.key) + "\"}";
}

void show(const Console& console, const Trusted& own) {
  console.err << "key " << key_id(own.key)
              << "; on the computer that is to trust it, type this line:\n";
  console.out << "handrail keys trust " << line_of(own) << '\n';
}

// What a role is, where somebody asks for one that does not exist.
constexpr char kRolesText[] =
    "expected master, slave, operator, observer, or several apart by commas";

}  // namespace

ExitCode run_keys_new(const Options& o, const Console& console) {
  const Roles roles = parse_roles(*o.word);
  if (roles.empty()) return complain(console, "keys new: '" + *o.word + "': " + kRolesText);
  const auto made = folder().create(o.as.empty() ? computer_name() : o.as, roles);
  if (!made) return say_no(console, made.message());
  show(console, made->entry());
  return kExitDone;
}

ExitCode run_keys_show(const Options& o, const Console& console) {
  const auto own = folder().load();
  if (!own) return say_no(console, own.message());
  if (o.json) {
    console.out << json_of(own->entry()) << '\n';
  } else {
    show(console, own->entry());
  }
  return kExitDone;
}

ExitCode run_keys_trust(const Options& o, const Console& console) {
  if (const auto problem = operator_name_problem(*o.word); !problem.empty()) {
    return complain(console, "keys trust: " + problem);
  }
  const Roles roles = parse_roles(*o.roles);
  if (roles.empty()) return complain(console, "keys trust: '" + *o.roles + "': " + kRolesText);
  const auto key = parse_key(*o.key);
  if (!key) return complain(console, "keys trust: " + key.message());
  auto list = folder().trusted();
  if (!list) return say_no(console, list.message());
  const Trusted entry{*o.word, roles, *key};
  const auto own = folder().load();
  if (own && own->key.public_key() == *key) {
    return say_no(console, "that is this computer's own key: type the line on the other one");
  }
  if (const Status added = list->add(entry); !added) return say_no(console, added.message());
  const std::string what = entry.name + " as " + roles_text(roles) + ", key " + key_id(*key);
  if (const Status saved = folder().save(*list, "trusted " + what); !saved) {
    return say_no(console, saved.message());
  }
  console.out << "trusted: " << what << '\n';
  return kExitDone;
}

ExitCode run_keys_list(const Options& o, const Console& console) {
  const auto list = folder().trusted();
  if (!list) return say_no(console, list.message());
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
                << '\n';
  }
  return kExitDone;
}

ExitCode run_keys_remove(const Options& o, const Console& console) {
  auto list = folder().trusted();
  if (!list) return say_no(console, list.message());
  const Trusted* entry = list->find(*o.word);
  if (entry == nullptr) {
    return say_no(console, "there is no '" + *o.word + "' in " + folder().trusted_path() +
                               "; `handrail keys list` shows who is");
  }
  const std::string what = entry->name + ", key " + key_id(entry->key);
  list->remove(*o.word);
  if (const Status saved = folder().save(*list, "removed " + what); !saved) {
    return say_no(console, saved.message());
  }
  console.out << "removed: " << what << "; a session of it ends within a second\n";
  return kExitDone;
}

}  // namespace handrail
