// Figures of a report in one line, as to_json() writes it.
#pragma once

#include <cstdlib>
#include <string>

namespace handrail::emulator {

// The number that follows `name` in `text`; -1: there is none.
inline double figure(const std::string& text, const std::string& name) {
  const std::size_t start = text.find(name);
  return start == std::string::npos ? -1.0 : std::atof(text.c_str() + start + name.size());
}

// The part of a report for one direction: "to_far" or "to_near".
inline std::string way(const std::string& report, const std::string& direction) {
  const std::size_t start = report.find("\"" + direction + "\":{");
  return start == std::string::npos ? "" : report.substr(start, report.find('}', start) - start);
}
inline double count(const std::string& report, const std::string& direction,
                    const std::string& name) {
  return figure(way(report, direction), "\"" + name + "\":");
}

}  // namespace handrail::emulator
