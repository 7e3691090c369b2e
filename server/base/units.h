// Conversions at the edges, where the field speaks millimetres and degrees.
#pragma once

#include <numbers>

namespace handrail {

inline constexpr double kMm = 1e-3;                       // [m] in a millimetre
inline constexpr double kDeg = std::numbers::pi / 180.0;  // [rad] in a degree
inline constexpr double kNewtonPerMm = 1e3;               // [N/m] in a newton per millimetre
inline constexpr double kStandardGravity = 9.80665;       // standard gravity [m/s^2]

}  // namespace handrail
