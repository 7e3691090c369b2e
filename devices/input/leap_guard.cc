#include "devices/input/leap_guard.h"

#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

namespace handrail {

std::optional<Leap> LeapGuard::next(const Vec3& p_M, Nanos from, Nanos to) noexcept {
  const Vec3 way = p_M - last_;
  const Nanos time = to - read_from_ + age_;
  last_ = p_M;
  read_from_ = from;
  if (!std::exchange(known_, true)) return std::nullopt;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(way[i]) - count_[i] > kFastest * to_seconds(time)) return Leap{i, way[i], time};
  }
  return std::nullopt;
}

DeviceTrouble leap_text(const char* what, const Leap& leap) noexcept {
  DeviceTrouble out{};
  std::snprintf(out.data(), out.size(),
                "%s %.1f mm, in %.2f ms: %.0f m/s, and at most %.0f are a hand's; look at its "
                "cable",
                what, 1e3 * leap.way, 1e3 * to_seconds(leap.time),
                std::abs(leap.way) / to_seconds(leap.time), LeapGuard::kFastest);
  return out;
}

DeviceTrouble and_then(const DeviceTrouble& trouble, std::string_view next) noexcept {
  if (next.empty()) return trouble;
  DeviceTrouble out = trouble;
  std::size_t end = text_of(trouble).size();
  for (const std::string_view part : {std::string_view("; "), next}) {
    for (const char c : part) {
      if (end + 1 < out.size()) out[end++] = c;
    }
  }
  return out;
}

}  // namespace handrail
