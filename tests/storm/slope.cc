#include "tests/storm/slope.h"

#include <algorithm>
#include <cmath>

namespace handrail::storm {
namespace {

constexpr double kNormal95 = 1.96;  // two-sided, of the normal distribution

}  // namespace

Slope robust_slope(const std::vector<double>& t, const std::vector<double>& v) {
  std::vector<double> slopes;
  for (std::size_t i = 0; i < t.size(); ++i) {
    for (std::size_t j = i + 1; j < t.size(); ++j) {
      if (t[j] > t[i]) slopes.push_back((v[j] - v[i]) / (t[j] - t[i]));
    }
  }
  if (t.size() < 3 || slopes.empty()) return {};
  std::sort(slopes.begin(), slopes.end());
  const double n = static_cast<double>(t.size()), pairs = static_cast<double>(slopes.size());
  const double spread = kNormal95 * std::sqrt(n * (n - 1.0) * (2.0 * n + 5.0) / 18.0);
  const auto rank = [&](double at) {
    return slopes[static_cast<std::size_t>(std::clamp(at, 0.0, pairs - 1.0))];
  };
  return {rank(pairs / 2.0), rank((pairs - spread) / 2.0), rank((pairs + spread) / 2.0)};
}

}  // namespace handrail::storm
