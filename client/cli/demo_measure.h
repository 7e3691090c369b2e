// Measures of the demo's drive from A to B to C, on the tip as the slave reports it.
#pragma once

#include <cstdint>

#include "server/base/spatial.h"

namespace handrail {

// The task: straight from A to B, turn about B, straight on to C. Frame S [m].
struct DemoTask {
  Vec3 p_A = Vec3::Zero();
  Vec3 p_B = Vec3::Zero();
  Vec3 p_C = Vec3::Zero();
};

enum class DemoPhase : std::uint8_t { kToB, kTurn, kToC };

// Path length by vertices: a vertex is added when the tip is 0.5 mm or more from the last one, so
// that noise of the joints does not add up. Errors are the largest of their phases: position, the
// distance to the segment AB or BC and to B while turning; orientation, the angle to the tip's
// orientation at the phase's start, on AB and BC only.
class DemoMeasure {
 public:
  static constexpr double kVertex = 0.5e-3;  // [m]

  explicit DemoMeasure(const DemoTask& task) : task_(task) {}

  // Starts a phase at the tip's present orientation.
  void begin(DemoPhase phase, const Quat& q_ST);
  // One sample of the tip.
  void add(const Pose& X_ST);

  double path() const { return path_; }                            // [m]
  double position_error() const { return position_error_; }        // [m]
  double orientation_error() const { return orientation_error_; }  // [rad]

 private:
  DemoTask task_;
  DemoPhase phase_ = DemoPhase::kToB;
  Quat q_start_ = Quat::Identity();
  bool has_vertex_ = false;
  Vec3 vertex_ = Vec3::Zero();
  double path_ = 0.0;
  double position_error_ = 0.0;
  double orientation_error_ = 0.0;
};

// Distance of `p` from the segment between `a` and `b` [m].
double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b);

}  // namespace handrail
