// Test walls whose nearest point is known in closed form, and a hand that runs along them.
#pragma once

#include <vector>

#include "server/model/walls.h"

namespace handrail {

// A way of the hand at constant depth inside a straight or a circular wall, there and back or
// round. Frame of the walls, SI; `way` is the distance the hand has gone.
struct WallCourse {
  bool circle = false;
  Vec2 centre = Vec2::Zero();  // of the circle, or where the wall's straight part begins
  Vec2 along = Vec2::UnitX();  // straight: unit
  Vec2 out = Vec2::UnitY();    // straight: unit, out of the wall
  double surface = 0.0;        // circle: radius of the wall
  double hand_radius = 0.0;    // circle: of the hand's way
  double length = 0.0;         // of one way or round

  Vec2 hand(double way) const;
  Vec2 foot(double way) const;              // the exact proxy
  Vec2 free_at(double way) const;           // in free space, straight out of the wall from the foot
  double off_surface(const Vec2& p) const;  // of a point near by, positive out of the wall
};

inline constexpr double kCourseDepth = 1e-3;      // of the hand in the wall [m]
inline constexpr double kCourseStep = 0.1e-3;     // of the hand a tick [m]
inline constexpr double kCourseStiffness = 5000;  // of the walls [N/m]

// A ring and three straight aisles of 3 to 4 mm, as shapes and painted with pixels of that edge: 8
// bits of exact coverage in linear light.
Walls course_shapes();
Walls course_painting(double pixel);

// Both walls of every aisle, away from its corners.
const std::vector<WallCourse>& wall_courses();

}  // namespace handrail
