#include "server/lab/figure/axis.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <utility>

namespace handrail::figure {
namespace {

constexpr double kMost = 1e280;     // steps of ranges this wide or narrow are still normal numbers
constexpr double kRounding = 1e-9;  // of a step: rounding that does not push a tick off the axis

int exponent_of(double v) { return static_cast<int>(std::floor(std::log10(v))); }

// m 10^k, with the last bit right: 3 10^-1 is 0.3.
double times_ten_to(double m, int k) {
  return k >= 0 ? m * std::pow(10.0, k) : m / std::pow(10.0, -k);
}

std::string with_decimals(double v, int decimals) {
  std::array<char, 400> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), v,
                                 std::chars_format::fixed, decimals);
  return {buffer.data(), end.ptr};
}

std::string ten_to(int k) {
  constexpr std::array<std::string_view, 10> kRaised = {"\u2070", "\u00b9", "\u00b2", "\u00b3",
                                                        "\u2074", "\u2075", "\u2076", "\u2077",
                                                        "\u2078", "\u2079"};
  std::string out = k < 0 ? "10\u207b" : "10";
  for (const char digit : std::to_string(std::abs(k))) {
    out += kRaised[static_cast<std::size_t>(digit - '0')];
  }
  return out;
}

// A multiple of 10^step_exponent; beside others of which the largest is `largest`.
std::string label_of(double v, int step_exponent, double largest) {
  if (v == 0.0) return "0";
  if (v < 0.0) return "\u2212" + label_of(-v, step_exponent, largest);
  if (largest < 1e6 && step_exponent >= -5) return with_decimals(v, std::max(0, -step_exponent));
  int exponent = exponent_of(v * (1.0 + kRounding));
  const double mantissa = exponent >= 0 ? v / std::pow(10.0, exponent) : times_ten_to(v, -exponent);
  const std::string digits = with_decimals(mantissa, std::clamp(exponent - step_exponent, 0, 15));
  if (digits == "1") return ten_to(exponent);
  return digits + "\u00d7" + ten_to(exponent);
}

std::vector<Tick> linear_ticks(Range range, int most) {
  const double half_span = range.high / 2.0 - range.low / 2.0;
  const double least = half_span / std::max(most - 1, 1) * 2.0;
  int exponent = exponent_of(least);
  double multiple = 1.0;
  for (const double m : {1.0, 2.0, 5.0, 10.0}) {
    multiple = m;
    if (times_ten_to(m, exponent) >= least * (1.0 - kRounding)) break;
  }
  if (multiple == 10.0) {
    multiple = 1.0;
    ++exponent;
  }
  const double step = times_ten_to(multiple, exponent);
  const double largest = std::max(std::abs(range.low), std::abs(range.high));
  std::vector<Tick> out;
  const double last = std::floor(range.high / step + kRounding);
  for (double i = std::ceil(range.low / step - kRounding); i <= last; ++i) {
    const double value = times_ten_to(i * multiple, exponent);
    out.push_back({value, label_of(value, exponent, largest)});
  }
  return out;
}

std::vector<Tick> log_ticks(Range range, int most) {
  const int first = static_cast<int>(std::floor(std::log10(range.low) + kRounding));
  const int last = static_cast<int>(std::floor(std::log10(range.high) + kRounding));
  const double low = range.low * (1.0 - kRounding), high = range.high * (1.0 + kRounding);
  const int decades = last - first + 1;
  const int stride = (decades + most - 1) / std::max(most, 1);
  const bool plain = first >= -4 && last <= 4;
  const bool room_between = 3 * decades <= most + 3;
  std::vector<Tick> out;
  int labelled = 0;
  for (int k = first; k <= last; ++k) {
    for (int m = 1; m <= (stride > 1 ? 1 : 9); ++m) {
      const double value = times_ten_to(m, k);
      if (value < low || value > high) continue;
      const bool named = m == 1 ? k % stride == 0 : (room_between && (m == 2 || m == 5));
      const std::string label = plain ? label_of(value, k, 0.0) : label_of(value, k, kMost);
      out.push_back({value, named ? label : ""});
      labelled += named ? 1 : 0;
    }
  }
  if (labelled >= 2 || decades > 3) return out;
  out = linear_ticks(range, most);
  std::erase_if(out, [](const Tick& tick) { return tick.value <= 0.0; });
  return out;
}

}  // namespace

Range showable(Scale scale, Range range) {
  const bool log = scale == Scale::kLog;
  if (std::isnan(range.low) || std::isnan(range.high)) return {log ? 1.0 : 0.0, log ? 10.0 : 1.0};
  if (range.low > range.high) std::swap(range.low, range.high);
  const double least = log ? 1.0 / kMost : -kMost;
  range.low = std::clamp(range.low, least, kMost);
  range.high = std::clamp(range.high, least, kMost);
  if (log) {
    if (range.high <= range.low * (1.0 + 1e-9)) return {range.low / 2.0, range.high * 2.0};
    return range;
  }
  const double largest = std::max(std::abs(range.low), std::abs(range.high));
  if (largest < 1.0 / kMost) return {-1.0, 1.0};
  if (range.high / 2.0 - range.low / 2.0 > largest * 1e-12) return range;
  return {range.low - 0.1 * largest, range.high + 0.1 * largest};
}

std::vector<Tick> ticks(Scale scale, Range range, int most) {
  return scale == Scale::kLog ? log_ticks(range, most) : linear_ticks(range, most);
}

std::vector<Tick> with_none(std::vector<Tick> ticks, double none) {
  std::erase_if(ticks, [&](const Tick& tick) { return tick.value < kAboveNone * none; });
  ticks.insert(ticks.begin(), {none, "0"});
  return ticks;
}

std::vector<Tick> category_ticks(const std::vector<std::string>& categories) {
  std::vector<Tick> out;
  for (const std::string& category : categories) {
    out.push_back({static_cast<double>(out.size() + 1), category});
  }
  return out;
}

AxisMap::AxisMap(Scale scale, Range range, double start, double end)
    : log_(scale == Scale::kLog),
      low_((log_ ? std::log10(range.low) : range.low) / 2.0),
      span_((log_ ? std::log10(range.high) : range.high) / 2.0 - low_),
      start_(start),
      end_(end) {}

double AxisMap::operator()(double value) const {
  if (!std::isfinite(value) || (log_ && value <= 0.0)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double share = ((log_ ? std::log10(value) : value) / 2.0 - low_) / span_;
  return start_ + std::clamp(share, -1e100, 1e100) * (end_ - start_);
}

double AxisMap::clamped(double value) const {
  if (std::isnan(value)) return value;
  if (value == std::numeric_limits<double>::infinity()) return end_;
  if (value < 0.0 && (log_ || std::isinf(value))) return start_;
  if (value == 0.0 && log_) return start_;
  return std::clamp((*this)(value), std::min(start_, end_), std::max(start_, end_));
}

}  // namespace handrail::figure
