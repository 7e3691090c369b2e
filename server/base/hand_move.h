// What one order to a simulated hand may ask for.
#pragma once

namespace handrail {

inline constexpr double kFarthestHandMove = 1.0;                   // [m]
inline constexpr double kWidestHandTurn = 3.14159265358979323846;  // [rad]
inline constexpr double kShortestHandMove = 0.01;                  // [s]
inline constexpr double kLongestHandMove = 600.0;                  // [s]

}  // namespace handrail
