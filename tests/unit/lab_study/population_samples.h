// Populations for tests, as text.
#pragma once

#include <string>

#include "server/lab/study/population_io.h"

namespace handrail {

// One parameter's block on one line.
inline std::string parameter_text(const std::string& name, const std::string& rest) {
  return "parameter { name: '" + name + "' " + rest + " }\n";
}

inline constexpr char kPlainRange[] = "median: 0.5 spread: 0.2 low: 0.25 high: 1 source: 's'";

// A whole file, the parameter on line 2 + i being number i of the table: all within kPlainRange,
// but one that has `rest`.
inline std::string population_text(const std::string& other = "", const std::string& rest = "") {
  std::string out = "name: 'p'\n";
  for (const ParameterInfo& info : operator_parameter_table()) {
    const bool plain = other != info.name;
    const bool slow = info.least >= 1.0;
    const std::string usual =
        slow ? "median: 50 spread: 0.2 low: 25 high: 75 source: 's'" : std::string(kPlainRange);
    out += parameter_text(info.name, plain ? usual : rest);
  }
  return out;
}

}  // namespace handrail
