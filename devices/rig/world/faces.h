// Which face of a convex body a moving point is at.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace handrail {

// How far a point is outside each of N faces, below 0 inside [m].
template <std::size_t N>
using FaceGaps = std::array<double, N>;

// The face a point touches on its way from `last` to `now`, straight but for rounding: the face it
// was at already, `held`, as long as it is behind all others; else the last one it crosses if that
// brings it inside all; for one that was inside before, the nearest. None: it stays outside.
template <std::size_t N>
std::optional<std::size_t> face_at(const FaceGaps<N>& last, const FaceGaps<N>& now,
                                   std::optional<std::size_t> held) noexcept {
  double latest = -1.0;
  std::size_t entered = 0, nearest = 0;
  for (std::size_t i = 0; i < N; ++i) {
    if (now[i] > 0.0 && held != i) return std::nullopt;
    if (last[i] > last[nearest]) nearest = i;
    const double crossed = last[i] > 0.0 ? last[i] / (last[i] - now[i]) : -1.0;
    if (crossed > latest) {
      latest = crossed;
      entered = i;
    }
  }
  if (held) return held;
  return latest >= 0.0 ? entered : nearest;
}

}  // namespace handrail
