// What an operator may be called.
#pragma once

#include <string>
#include <string_view>

namespace handrail {

// True for 1 to 32 letters, digits, '.', '_' and '-'.
bool is_operator_name(std::string_view who) noexcept;

// "anna@3f2a-91bc-07de-55a1": who has proven by a key to be called so. No name that can be said.
std::string proven_name(std::string_view name, std::string_view key_id);

// Why nobody may be called `who`; empty when they may.
std::string operator_name_problem(std::string_view who);

}  // namespace handrail
