// How fast something grows, though it jumps now and then.
#pragma once

#include <vector>

namespace handrail::storm {

struct Slope {
  double value = 0.0;            // a unit of time
  double low = 0.0, high = 0.0;  // of its 95 % interval
};

// The median of the slopes between every two samples (Theil and Sen), with Sen's interval. It takes
// samples for independent: a single step makes it too narrow. Fewer than three samples have no
// slope. Takes memory for every pair of samples.
Slope robust_slope(const std::vector<double>& times, const std::vector<double>& values);

}  // namespace handrail::storm
