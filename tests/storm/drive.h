// Where the hand leads the tip in a storm, and the orders that bring it there.
#pragma once

#include <string>

#include "proto/operator.pb.h"
#include "server/base/random.h"
#include "server/base/spatial.h"

namespace handrail::storm {

// The scene of those who drive so, in text format: a fast hand with little smoothing. And the
// device of a master whose hand trembles and drifts by nothing, and so comes to rest.
std::string scene_text();
extern const char* const kSteadyDevice;

constexpr double kScale = 4.0;  // of the scene: the device then spans the region from any start

// A box of places, each with all turns up to an angle about the middle's orientation, in S. The
// way between two of its poses stays in it, since box and ball of turns are convex; the rig's arm
// reaches all of it with 5 degrees to spare in every joint, and stands in it at first.
class DriveRegion {
 public:
  static constexpr double kTurn = 0.25;                              // [rad]
  static Vec3 half() noexcept { return Vec3(0.040, 0.060, 0.040); }  // of the box [m]

  DriveRegion() noexcept;
  // `place`: share of the box's half sides, each -1 to 1; `turn`: share of the turn, about its own
  // direction, shortened to 1.
  Pose at(const Vec3& place, const Vec3& turn) const noexcept;
  Pose middle() const noexcept { return middle_; }
  Pose any(Random& random) const noexcept;

 private:
  Pose middle_;
};

// A pose of a status; the identity while there is none.
Pose pose_of(const pb::PoseMm& in);

// The order, in text format, by which the command goes from where it is in `status` to `goal`
// within `seconds`, as far as the device reaches.
std::string order_to(const Pose& goal, const pb::Status& status, double seconds);
// By which the hand goes to the middle of its device.
std::string order_home(const pb::Status& status, double seconds);

}  // namespace handrail::storm
