// How a drive through the linear-movement task is judged, the same with tools and without.
#pragma once

#include "server/model/linear_task.h"

namespace handrail {

// Length of a path by vertices: a vertex is added when the point is `spacing` or more from the last
// one, so that sampling noise does not add up; the length is the sum of the vertices' distances.
class PathLength {
 public:
  static constexpr double kSpacing = 0.5e-3;  // [m]
  void add(const Vec3& p) noexcept;
  double length() const noexcept { return length_; }  // [m]

 private:
  bool started_ = false;
  Vec3 vertex_ = Vec3::Zero();
  double length_ = 0.0;
};

// Distance of `p` from the segment between `a` and `b` [m].
double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) noexcept;

// Takes finite samples of the tip in S. The path runs over every sample; errors are the largest
// within phases, between begin() and end(). Position: distance to the task's segment AB or BC, and
// to B while turning. Orientation, on AB and BC only: the angle to the tip's orientation at the
// phase's start, to the orientation commanded then, and to the task's nominal one. Pure.
class LinearMeasure {
 public:
  explicit LinearMeasure(const LinearTask& task) noexcept : task_(task) {}

  // Starts a phase at the tip's present orientation `q_ST`, with `q_ref` commanded.
  void begin(LinearPhase phase, const Quat& q_ST, const Quat& q_ref) noexcept;
  // Ends it: samples that follow belong to the path only, until the next begin().
  void end() noexcept { active_ = false; }
  void add(const Pose& X_ST) noexcept;

  double path() const noexcept { return path_.length(); }                         // [m]
  double position_error() const noexcept;                                         // all phases [m]
  double position_error_on_lines() const noexcept { return on_lines_; }           // AB, BC [m]
  double orientation_error() const noexcept { return from_start_; }               // [rad]
  double orientation_error_to_reference() const noexcept { return from_ref_; }    // [rad]
  double orientation_error_to_nominal() const noexcept { return from_nominal_; }  // [rad]

 private:
  LinearTask task_;
  LinearPhase phase_ = LinearPhase::kToB;
  bool active_ = false;
  Quat q_start_ = Quat::Identity();
  Quat q_ref_ = Quat::Identity();
  PathLength path_;
  double on_lines_ = 0.0;
  double at_b_ = 0.0;
  double from_start_ = 0.0;
  double from_ref_ = 0.0;
  double from_nominal_ = 0.0;
};

}  // namespace handrail
