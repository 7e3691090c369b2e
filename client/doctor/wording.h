// Small things that several judges say alike.
#pragma once

#include <array>
#include <cstdio>
#include <string>

#include "client/doctor/facts.h"
#include "client/doctor/finding.h"

namespace handrail {

template <typename... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 320> text{};
  const int n = std::snprintf(text.data(), text.size(), format, values...);
  const int most = static_cast<int>(text.size()) - 1;
  return std::string(text.data(), static_cast<std::size_t>(n < 0 ? 0 : n < most ? n : most));
}

// "3 s", "12 min", "5 h", "3 days": the largest unit of which there are two.
inline std::string span_text(double seconds) {
  if (seconds < 120.0) return formatted("%.0f s", seconds);
  if (seconds < 7200.0) return formatted("%.0f min", seconds / 60.0);
  if (seconds < 172800.0) return formatted("%.0f h", seconds / 3600.0);
  return formatted("%.0f days", seconds / 86400.0);
}

// What the judges read of the master: defaults where there is none.
inline const pb::Status& status_of(const DoctorFacts& facts) {
  return facts.master.status ? *facts.master.status : pb::Status::default_instance();
}

// A slave of our wire version was heard within 200 ms, after which a link is lost (WIRE.md).
inline bool slave_is_heard(const pb::Status& status) {
  return status.slave_program().has_version() && status.packet_age_ms() >= 0.0 &&
         status.packet_age_ms() <= 200.0;
}

}  // namespace handrail
