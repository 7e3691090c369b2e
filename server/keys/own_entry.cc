#include "server/keys/own_entry.h"

#include <sstream>

#include "server/base/operator_name.h"
#include "server/base/plain_text.h"

namespace handrail {

std::string own_text(const OwnEntry& own, const OwnKey& key) {
  std::string line = "handrail " + own.name + " " + roles_text(own.roles);
  for (const std::string& name : own.confirmed) line += " " + name;
  return line + "\n" + key.pem();
}

Result<OwnEntry> parse_own(const std::string& text) {
  auto key = OwnKey::parse(text);
  if (!key) return key.status();
  const std::string line = text.substr(0, text.find('\n'));
  std::istringstream header(line);
  std::string word, name, roles;
  header >> word >> name >> roles;
  OwnEntry out{*key, name, parse_roles(roles)};
  bool sound = word == "handrail" && is_operator_name(name) && !out.roles.empty();
  while (sound && header >> word) {
    sound = is_operator_name(word);
    out.confirmed.push_back(word);
  }
  if (sound) return out;
  return Status::error("the first line is '" + shown(line) + "': expected handrail NAME ROLES");
}

}  // namespace handrail
