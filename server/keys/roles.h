// What the owner of a key may do.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

namespace handrail {

enum class Role : std::uint8_t {
  kMaster,    // leads a slave's arm
  kSlave,     // is led
  kOperator,  // gives a master orders
  kObserver,  // reads a master's status
};
inline constexpr int kRoles = 4;

const char* role_text(Role role) noexcept;
std::optional<Role> parse_role(std::string_view text) noexcept;

// One bit for each role.
class Roles {
 public:
  constexpr Roles() = default;
  constexpr Roles(Role role) : bits_(bit(role)) {}  // NOLINT: implicit by design
  constexpr Roles(std::initializer_list<Role> roles) {
    for (const Role role : roles) add(role);
  }
  constexpr bool has(Role role) const noexcept { return (bits_ & bit(role)) != 0; }
  constexpr bool has_any(Roles of) const noexcept { return (bits_ & of.bits_) != 0; }
  constexpr void add(Role role) noexcept { bits_ = static_cast<std::uint8_t>(bits_ | bit(role)); }
  constexpr bool empty() const noexcept { return bits_ == 0; }
  friend bool operator==(Roles, Roles) = default;

 private:
  static constexpr std::uint8_t bit(Role role) {
    return static_cast<std::uint8_t>(1u << static_cast<unsigned>(role));
  }
  std::uint8_t bits_ = 0;
};

// True when owners of these have something to say to each other: a slave and its master, a master
// and who gives it orders or reads its status.
bool meet(Roles a, Roles b) noexcept;

// "master,operator".
std::string roles_text(Roles roles);
// The other way; empty: none, or one that does not exist.
Roles parse_roles(std::string_view text) noexcept;

}  // namespace handrail
