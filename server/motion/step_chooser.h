// The steps that the tip may take: each only together with a way to rest.
#pragma once

#include "server/motion/tip_motion.h"

namespace handrail {

// Where a step and its stop may lead, beside what the joints can do.
struct Ends {
  Vec3 p_goal = Vec3::Zero();
  double past = 0.0;   // so far past the goal a stop may end [m]
  double slow = 0.0;   // a tip that steps less and turns may waver about its place [m]
  bool stays = false;  // the target stands: neither a step nor its stop leads away from it
  Vec3 p_target = Vec3::Zero();
  double least = 0.0;  // the nearest that the tip was to it [m]
  double out = 0.0;    // > 0: the tip is on its way out already, to so far from it [m]

  // Whether the step from `from` to `next`, which `stop` is the stop after, may be taken within
  // `space`. Real-time safe.
  bool allow(const TipSpace& space, const MotionState& from, const TipMotion& next,
             const StopPlan& stop) const noexcept;

 private:
  bool keep_near(const Vec3& here, const Vec3& there, const Vec3& p_end) const noexcept;
};

// The motion after commanding `q`, whose tip is at X. Real-time safe.
TipMotion after(const PlanLimits& limits, const TipMotion& m, const JointVector& q,
                const Pose& X) noexcept;

// Tries steps for one cycle; what is taken becomes the plan in `state`. Real-time safe.
class StepChooser {
 public:
  // `tip`: where the arm is.
  StepChooser(const PlanLimits& limits, const TipSpace& space, const Ends& ends,
              const TipPlace& tip, MotionState& state) noexcept
      : limits_(limits), space_(space), ends_(ends), tip_(tip), state_(state) {}

  // Takes the step to q, which has the tip at X, or half or a quarter of what it is beyond the
  // plan's own next one, or it with every joint stopping by itself: at most four stops. `inverse`:
  // around where the arm is. False: none of them; else `next` is what was taken.
  bool take_most(const JointVector& q, const Pose& X, PlaceInverse& inverse,
                 TipMotion& next) noexcept;
  // What of the arm does not let the first of them be taken; kNone where it is only where their
  // stops end.
  const Verdict& refused() const noexcept { return refused_; }

 private:
  bool take(const JointVector& q, const Pose& X, Stopping how, TipMotion& next) noexcept;
  // A stop that no tool holds ends hardly beside the tip's way. Joints whose motions cancelled may
  // take the tip far when each stops: hardly further along than by braking evenly.
  bool ends_on_way(const TipMotion& m, Stopping how) const noexcept;

  const PlanLimits& limits_;
  const TipSpace& space_;
  const Ends& ends_;
  const TipPlace& tip_;
  MotionState& state_;
  StopPlan trial_;
  Verdict refused_;
};

}  // namespace handrail
