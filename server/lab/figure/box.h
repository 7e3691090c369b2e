// What a box-and-whisker plot shows of a sample.
#pragma once

#include <cstddef>
#include <vector>

namespace handrail::figure {

// Failed trials, +infinity or anything else not finite, are the worst ranks: quartiles may be
// infinite. Whiskers end at the farthest finite value within 1.5 of the box's height from it, and
// at the box where there is none; finite values beyond are outliers. Without values, quartiles and
// whiskers are NaN; when even q1 is infinite all finite values are outliers. Source: Tukey 1977,
// quartiles as in quantile.h.
struct BoxStats {
  double q1 = 0.0, median = 0.0, q3 = 0.0;
  double low = 0.0, high = 0.0;  // ends of the whiskers
  std::vector<double> outliers;  // ascending
  std::size_t count = 0;
  std::size_t failures = 0;
};
BoxStats box_stats(const std::vector<double>& values);

}  // namespace handrail::figure
