#include "client/cli/demo_measure.h"

#include <algorithm>

namespace handrail {

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (p - (a + t * ab)).norm();
}

void DemoMeasure::begin(DemoPhase phase, const Quat& q_ST) {
  phase_ = phase;
  q_start_ = q_ST;
}

void DemoMeasure::add(const Pose& X_ST) {
  if (!has_vertex_ || (X_ST.p - vertex_).norm() >= kVertex) {
    if (has_vertex_) path_ += (X_ST.p - vertex_).norm();
    vertex_ = X_ST.p;
    has_vertex_ = true;
  }
  double off = 0.0;
  switch (phase_) {
    case DemoPhase::kToB:
      off = distance_to_segment(X_ST.p, task_.p_A, task_.p_B);
      break;
    case DemoPhase::kTurn:
      off = (X_ST.p - task_.p_B).norm();
      break;
    case DemoPhase::kToC:
      off = distance_to_segment(X_ST.p, task_.p_B, task_.p_C);
      break;
  }
  position_error_ = std::max(position_error_, off);
  if (phase_ != DemoPhase::kTurn) {
    orientation_error_ = std::max(orientation_error_, angle_between(q_start_, X_ST.q));
  }
}

}  // namespace handrail
