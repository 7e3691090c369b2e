// Quantiles where failures are ranks too, shared by statistics and box plots.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

namespace handrail {

// The point `share` of the way from a to b, 0 < share < 1, a <= b; an infinite b decides.
inline double between(double a, double b, double share) noexcept {
  if (a == b) return a;
  return std::isfinite(b) ? std::lerp(a, b, share) : b;
}

// Quantile q, 0 <= q <= 1, of ascending values, at least one, +infinity among the last allowed.
// Source: type 7 of Hyndman and Fan 1996.
inline double quantile_of_sorted(std::span<const double> sorted, double q) noexcept {
  const double rank = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const double share = rank - static_cast<double>(below);
  return share == 0.0 ? sorted[below] : between(sorted[below], sorted[below + 1], share);
}

}  // namespace handrail
