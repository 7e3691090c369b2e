// The plane of a two-axis device: X and Y of frame M (spatial.h), metres.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace handrail {

using Vec2 = Eigen::Vector2d;

// A frame in the plane: a point v of it is at p + R(angle) v.
struct Pose2 {
  Vec2 p = Vec2::Zero();  // [m]
  double angle = 0.0;     // counter-clockwise [rad]

  Vec2 to_world(const Vec2& v) const { return p + turned(v, angle); }
  Vec2 to_local(const Vec2& w) const { return turned(w - p, -angle); }
  static Vec2 turned(const Vec2& v, double by) {
    const double c = std::cos(by);
    const double s = std::sin(by);
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
  }
};

}  // namespace handrail
