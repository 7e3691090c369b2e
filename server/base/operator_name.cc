#include "server/base/operator_name.h"

#include <algorithm>

#include "server/base/plain_text.h"

namespace handrail {

bool is_operator_name(std::string_view who) noexcept {
  return !who.empty() && who.size() <= 32 && std::all_of(who.begin(), who.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
  });
}

std::string proven_name(std::string_view name, std::string_view key_id) {
  std::string out(name);
  return out.append("@").append(key_id);
}

std::string operator_name_problem(std::string_view who) {
  if (is_operator_name(who)) return {};
  std::string text = "'";
  return text.append(shown(who, 40))
      .append("' is no name: expected 1 to 32 letters, digits, '.', '_', '-'");
}

}  // namespace handrail
