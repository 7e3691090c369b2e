#include "server/keys/roles.h"

#include <array>
#include <cstddef>

namespace handrail {
namespace {

constexpr std::array<const char*, kRoles> kNames = {"master", "slave", "operator", "observer"};

}  // namespace

const char* role_text(Role role) noexcept { return kNames[static_cast<std::size_t>(role)]; }

std::optional<Role> parse_role(std::string_view text) noexcept {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (text == kNames[i]) return static_cast<Role>(i);
  }
  return std::nullopt;
}

bool meet(Roles a, Roles b) noexcept {
  const Roles masters_other = {Role::kSlave, Role::kOperator, Role::kObserver};
  return (a.has(Role::kMaster) && b.has_any(masters_other)) ||
         (b.has(Role::kMaster) && a.has_any(masters_other));
}

std::string roles_text(Roles roles) {
  std::string out;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (!roles.has(static_cast<Role>(i))) continue;
    if (!out.empty()) out += ',';
    out += kNames[i];
  }
  return out;
}

Roles parse_roles(std::string_view text) noexcept {
  Roles out;
  for (;;) {
    const std::size_t comma = text.find(',');
    const auto role = parse_role(text.substr(0, comma));
    if (!role) return {};
    out.add(*role);
    if (comma == std::string_view::npos) return out;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace handrail
