// What `handrail doctor` says.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace handrail {

enum class Level : std::uint8_t {
  kOk,
  kNote,     // works; worth knowing
  kProblem,  // keeps the arm from being driven, or from being driven safely
};

struct Finding {
  std::string check;  // "keys.partner"
  Level level = Level::kOk;
  std::string fact;  // what was found, beside what was expected
  std::string next;  // what to do; empty: nothing
};
using Findings = std::vector<Finding>;

}  // namespace handrail
