// Axes of figures: ranges, ticks that people like to read, and where a value stands.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace handrail::figure {

enum class Scale { kLinear, kLog };

struct Axis {
  std::string label = {};  // with the unit, such as "path [mm]"
  Scale scale = Scale::kLinear;
  std::optional<double> low = {};  // end of the axis; unset: from the data, with a margin
  std::optional<double> high = {};
  std::optional<double> none = {};  // logarithmic: the place that stands for 0, below all values
  std::vector<std::string> categories = {};  // when given, category k from 0 stands at k + 1
};

// Times Axis::none: values begin above that.
inline constexpr double kAboveNone = 1.7;

struct Range {
  double low = 0.0, high = 0.0;
};

struct Tick {
  double value = 0.0;
  std::string label;  // empty: a minor tick
};

// A range that can be shown: finite, low < high, and above 0 when logarithmic. Ends are swapped
// when in the wrong order, kept within 1e280, and moved apart when they are (nearly) the same.
Range showable(Scale scale, Range range);

// Ticks within a showable range, ascending, with labels that tell them apart. Linear: steps of 1,
// 2 or 5 times a power of ten, at most `most` of them (two or more). Logarithmic: powers of ten,
// with 2 and 5 between when there is room and minor ticks at the other multiples; within one decade
// as linear.
std::vector<Tick> ticks(Scale scale, Range range, int most);

// The same with a tick for 0 at `none`, and no others near it.
std::vector<Tick> with_none(std::vector<Tick> ticks, double none);

// One tick for each category.
std::vector<Tick> category_ticks(const std::vector<std::string>& categories);

// From a showable range of values to pixels between `start` (at low) and `end` (at high).
class AxisMap {
 public:
  AxisMap(Scale scale, Range range, double start, double end);
  // NaN for what has no place: not finite, or not above 0 when logarithmic.
  double operator()(double value) const;
  // Past the end for infinite values; else as above. Within the axis.
  double clamped(double value) const;

 private:
  bool log_;
  double low_, span_;  // in halves, so that the widest range does not overflow
  double start_, end_;
};

}  // namespace handrail::figure
