#include "server/lab/figure/box.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/lab/figure/quantile.h"

namespace handrail::figure {

BoxStats box_stats(const std::vector<double>& values) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kFailed = std::numeric_limits<double>::infinity();
  BoxStats box;
  box.count = values.size();
  box.q1 = box.median = box.q3 = box.low = box.high = kNaN;
  if (values.empty()) return box;
  std::vector<double> sorted;
  for (const double v : values) sorted.push_back(std::isfinite(v) ? v : kFailed);
  std::sort(sorted.begin(), sorted.end());
  box.q1 = quantile_of_sorted(sorted, 0.25);
  box.median = quantile_of_sorted(sorted, 0.5);
  box.q3 = quantile_of_sorted(sorted, 0.75);
  const bool has_box = std::isfinite(box.q1);
  const double reach = has_box ? 1.5 * (box.q3 - box.q1) : 0.0;
  if (has_box) {
    box.low = box.q1;
    box.high = box.q3;
  }
  for (const double v : sorted) {
    if (v == kFailed) {
      ++box.failures;
    } else if (!has_box || v < box.q1 - reach || v > box.q3 + reach) {
      box.outliers.push_back(v);
    } else {
      box.low = std::min(box.low, v);
      box.high = std::max(box.high, v);
    }
  }
  return box;
}

}  // namespace handrail::figure
