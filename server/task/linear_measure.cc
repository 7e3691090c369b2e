#include "server/task/linear_measure.h"

#include <algorithm>

namespace handrail {

void PathLength::add(const Vec3& p) noexcept {
  const double step = started_ ? (p - vertex_).norm() : 0.0;
  if (started_ && step < kSpacing) return;
  length_ += step;
  vertex_ = p;
  started_ = true;
}

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) noexcept {
  const Vec3 ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (p - (a + t * ab)).norm();
}

void LinearMeasure::begin(LinearPhase phase, const Quat& q_ST, const Quat& q_ref) noexcept {
  phase_ = phase;
  active_ = true;
  q_start_ = q_ST;
  q_ref_ = q_ref;
}

void LinearMeasure::add(const Pose& X_ST) noexcept {
  path_.add(X_ST.p);
  if (!active_) return;
  if (phase_ == LinearPhase::kTurn) {
    at_b_ = std::max(at_b_, (X_ST.p - task_.p_SB).norm());
    return;
  }
  const bool first = phase_ == LinearPhase::kToB;
  const Vec3& from = first ? task_.p_SA : task_.p_SB;
  const Vec3& to = first ? task_.p_SB : task_.p_SC;
  const Quat q_nominal = first ? task_.q_first : task_.q_second();
  on_lines_ = std::max(on_lines_, distance_to_segment(X_ST.p, from, to));
  from_start_ = std::max(from_start_, angle_between(q_start_, X_ST.q));
  from_ref_ = std::max(from_ref_, angle_between(q_ref_, X_ST.q));
  from_nominal_ = std::max(from_nominal_, angle_between(q_nominal, X_ST.q));
}

double LinearMeasure::position_error() const noexcept { return std::max(on_lines_, at_b_); }

}  // namespace handrail
