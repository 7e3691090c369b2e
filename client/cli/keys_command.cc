#include "client/cli/keys_command.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>

#include "server/base/operator_name.h"
#include "server/keys/key_folder.h"

namespace handrail {
namespace {

std::string json_of(const Trusted& entry) {
  // Names, roles and keys have no letter that JSON would want escaped.
  return R"({"name": ")" + entry.name + R"(", "roles": ")" + roles_text(entry.roles) +
         R"(", "id": ")" + key_id(entry.key) + R"(", "key": ")" + key_text(entry.key) + "\"}";
}

void show(const Console& console, const Trusted& own) {
  console.err << "key " << key_id(own.key)
              << "; on the computer that is to trust it, type this line:\n";
  console.out << "handrail keys trust " << line_text(own) << '\n';
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
  const auto made = own_keys().create(o.as.empty() ? computer_name() : o.as, roles);
  if (!made) return refuse_keys(console, made.message());
  show(console, made->entry());
  return kExitDone;
}

ExitCode run_keys_show(const Options& o, const Console& console) {
  const auto own = own_keys().load();
  if (!own) return refuse_keys(console, own.message());
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
  if (roles.empty()) return complain(console, "keys trust: '" + *o.roles + "': " + kRolesExpected);
  const auto key = parse_key(*o.key);
  if (!key) return complain(console, "keys trust: " + key.message());
  const auto done = own_keys().trust({*o.word, roles, *key});
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
