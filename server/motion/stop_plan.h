// A way to rest for the whole arm, on the tool and within every limit, found
// before it is needed.
#pragma once

#include <array>

#include "server/base/spatial.h"
#include "server/kinematics/tip_place.h"
#include "server/model/tip_space.h"
#include "server/motion/guard.h"
#include "server/motion/motion_constants.h"

namespace handrail {

// Joint commands, one a cycle, of which the last two are the same. 64 cycles
// hold v/a + 2.5 a/j of the arm's own limits; with slower ones the arm moves so
// slowly that they suffice.
struct StopPlan {
  static constexpr int kCapacity = 64;
  std::array<JointVector, kCapacity> q;
  int size = 0;
  int next = 0;
  Vec3 p_end = Vec3::Zero();  // where the tip comes to rest, frame S [m]

  bool done() const noexcept { return next >= size; }
};

using Vector6 = Eigen::Matrix<double, 6, 1>;

// Where the commands stand: nothing here is measured.
struct TipMotion {
  GuardState joints;
  Pose X_ST;         // tip at joints.q
  Twist tip_step;    // what it moved in the last cycle, frame S [m], [rad]
  Twist tip_change;  // how that grew
};

// The guard's limits, and the share of them that is planned with.
struct PlanLimits {
  explicit PlanLimits(const GuardLimits& of) noexcept;
  GuardLimits guard;
  std::array<AxisLimits, kJoints> axis;
  JointVector speed, acceleration, jerk;  // of `axis`
  JointVector from_end;  // of a joint's range, where the guard surely lets it come to rest [rad]
  JointBounds planned;   // by these limits
  JointBounds sent;      // what may be sent: within the guard's own
};

// Whether `wanted` is within the planned share of speed, acceleration and jerk, and the guard lets
// it pass. Real-time safe.
Verdict plan_allows(const PlanLimits& limits, const GuardState& state,
                    const JointVector& wanted) noexcept;

// `wanted` becomes the newest command. Real-time safe.
void advance(const PlanLimits& limits, GuardState& state, const JointVector& wanted) noexcept;

// The smallest turns of the joints that take the tip somewhere, in units of what each joint can do.
class PlaceInverse {
 public:
  // Around the first tip that is to be brought somewhere.
  explicit PlaceInverse(const PlanLimits& limits) noexcept : limits_(limits) {}
  // Turns the joints on from `q` until `tip` is at `p` [m], to below a nanometre; from then on
  // around there if that is far. False: it does not come there. Real-time safe.
  bool bring_to(const Vec3& p, TipPlace& tip, JointVector& q) noexcept;

 private:
  void turn_around(const TipPlace& tip) noexcept;

  const PlanLimits& limits_;
  bool known_ = false;
  Eigen::Matrix<double, kJoints, 3> R_;  // [rad/m]
};

// How the joints stop.
enum class Stopping {
  kAsOne,  // all together: the tip keeps its way
  kEach,   // each by its own law: as fast as it can
};

// Rolls out a stop from `from`, the arm at `tip`; on `space` throughout, and no longer than
// v/a + 2.5 a/j of the slowest-stopping joint, a/j two cycles at least. Where no tool holds the tip
// it keeps its way but for what is of third order. Every command of it was asked of the guard.
// False with the reason in `why` when there is none. Real-time safe.
bool plan_stop(const PlanLimits& limits, const TipSpace& space, const TipMotion& from,
               const TipPlace& tip, Stopping how, StopPlan& plan, Verdict& why) noexcept;

}  // namespace handrail
