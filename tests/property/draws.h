// What the properties draw, at full size: rapidcheck's default starts with the low ends of all
// ranges.
#pragma once

#include <rapidcheck.h>

#include "server/base/plane.h"
#include "server/base/spatial.h"

namespace handrail::test {

// 0 to n - 1.
inline int below(int n) { return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(0, n)); }

inline double between(double low, double high) {
  constexpr int kSteps = 1'000'000;
  return low + (high - low) * below(kSteps + 1) / kSteps;
}

// In a cube, in a square, of twice `size`.
inline Vec3 within(double size) {
  return {between(-size, size), between(-size, size), between(-size, size)};
}
inline Vec2 within_square(double size) { return {between(-size, size), between(-size, size)}; }

}  // namespace handrail::test
