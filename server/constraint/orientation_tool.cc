#include "server/constraint/orientation_tool.h"

#include <cmath>

#include "server/base/units.h"

namespace handrail {
namespace {

// Beyond this tilt the direction back to the axis turns faster than the hand: hold.
constexpr double kUndefinedFrom = 175.0 * kDeg;

struct Swing {
  double phi;  // (3.7) [rad]
  Vec3 u;      // (3.8), unit; zero where undefined
};

Swing swing_to(const Vec3& r, const Vec3& r_ref) {
  const Vec3 cross = r.cross(r_ref);
  const double s = cross.norm();
  return {std::atan2(s, r.dot(r_ref)), s > 1e-12 ? Vec3(cross / s) : Vec3(Vec3::Zero())};
}

}  // namespace

Quat OrientationTool::start(const Quat& q_SP) noexcept {
  proxy_ = tool_.kind == ToolKind::kNRotation ? tool_.q_ref : q_SP;
  // Near half a turn u has few digits left; a second swing takes away what the first one missed.
  for (int i = 0; tool_.kind == ToolKind::kFRotation && i < 2; ++i) {
    const Vec3 r = proxy_ * tool_.axis_T;
    const Swing swing = swing_to(r, tool_.normal_S);
    const Vec3 u = swing.u.isZero() && swing.phi > 1.0 ? r.unitOrthogonal() : swing.u;
    proxy_ = (rotation_exp(swing.phi * u) * proxy_).normalized();
  }
  undefined_ = rejoined_ = false;
  return advance(q_SP);
}

Quat OrientationTool::advance(const Quat& q_SH) noexcept {
  rejoined_ = false;
  switch (tool_.kind) {
    case ToolKind::kNRotation: proxy_ = tool_.q_ref; break;
    case ToolKind::kFRotation: {
      const Swing swing = swing_to(q_SH * tool_.axis_T, tool_.normal_S);
      if (swing.phi > kUndefinedFrom) {
        undefined_ = true;
        break;
      }
      rejoined_ = undefined_;
      undefined_ = false;
      proxy_ = (rotation_exp(swing.phi * swing.u) * q_SH).normalized();  // (3.9)
      break;
    }
    default: proxy_ = q_SH;
  }
  return proxy_;
}

double OrientationTool::deviation(const Quat& q) const noexcept {
  switch (tool_.kind) {
    case ToolKind::kNRotation: return angle_between(tool_.q_ref, q);
    case ToolKind::kFRotation: return swing_to(q * tool_.axis_T, tool_.normal_S).phi;
    default: return 0.0;
  }
}

}  // namespace handrail
