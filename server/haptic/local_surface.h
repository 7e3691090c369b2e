// The surface that the slave's tip touches, rendered at the hand without the link's delay.
#pragma once

#include <optional>

#include "server/base/spatial.h"
#include "server/model/reason.h"
#include "server/model/surface.h"

namespace handrail {

// One tick.
struct LocalSurfaceInput {
  std::optional<Surface> told;  // by the slave, newest; anything may stand in it
  Vec3 p_SU = Vec3::Zero();     // where the hand asks the tip to be, unsmoothed [m]
  Vec3 p_ST = Vec3::Zero();     // the tip, as the slave told it [m]
  Vec3 f_E_S = Vec3::Zero();    // the force on it; meaningful when has_force [N]
  bool has_force = false;
  double scale = 1.0;             // of the mapping, > 0
  double most_stiffness = 800.0;  // at the hand, >= 0; 0: the spring stays [N/m]
};

// What of it the hand feels.
struct LocalSurfaceForce {
  Vec3 n_S = Vec3::UnitZ();    // out of the surface
  double push = 0.0;           // on the hand along it, >= 0 [N]
  double stiffness = 0.0;      // at the hand, rising and falling with the model [N/m]
  double share = 0.0;          // of the spring along n_S whose place it takes, 0 to 1
  Reason why = Reason::kNone;  // why it fades, if it does
};

// A model of the surface that is told, and its spring at the hand.
//
// The spring's stiffness is the surface's in the hand's motion, scale^2 of it, so that hand and tip
// do the same work, and at most what the device holds. It is felt from where the hand asks the tip
// to be: unsmoothed, for the smoother's lag is a delay within the spring, which no device holds.
//
// The model follows what is told in steps that a hand does not feel as a blow: the plane, where the
// hand is, at most kPlaneRate, its normal kNormalRate about that place, its stiffness from none to
// the most in kFade. It fades in kFade when the slave tells of none; when what is told is no
// surface, is turned by over a right angle or lies over kJump off (kSurfaceElsewhere); and when the
// tip has been kBehind behind it for kUnfelt and felt nothing (kSurfaceNotFelt), after which it
// stays away until another one is told. Then it begins again from no stiffness. Real-time safe.
class LocalSurface {
 public:
  static constexpr double kPlaneRate = 0.02;  // times 0.8 N/mm: 8 N/s of the arbiter's 50 [m/s]
  static constexpr double kNormalRate = 0.5;  // 10 mm beside the hand a quarter of that [rad/s]
  static constexpr double kFade = 0.1;        // 0.8 N/mm, 5 mm deep: 40 N/s, within the same [s]
  static constexpr double kJump = 0.02;       // a second of kPlaneRate is too long to be wrong [m]
  static constexpr double kUnfelt = 2.0;      // twice the longest round trip that is aimed at [s]
  static constexpr double kBehind = 2e-3;     // beside the slave's own millimetre [m]
  static constexpr double kFelt = 2.0;        // more is felt: the bumper's dead band [N]
  static constexpr double kFeltShare = 0.3;   // so is this much of what a soft one would push
  static constexpr double kNear = 0.01;       // from so far out the spring along n_S gives way [m]

  // `dt` > 0 [s]. `in.p_SU` is finite.
  LocalSurfaceForce step(const LocalSurfaceInput& in, double dt) noexcept;
  // The hand does not lead: nothing is known.
  void forget() noexcept { *this = LocalSurface(); }

  bool known() const noexcept { return known_; }
  const Surface& model() const noexcept { return model_; }  // while known

 private:
  void hear(const LocalSurfaceInput& in, double dt) noexcept;
  void follow(const Surface& told, const Vec3& p, double dt) noexcept;
  bool unfelt(const LocalSurfaceInput& in, double dt) noexcept;
  void fade(Reason why) noexcept { fading_ = true, why_ = why; }

  Surface model_;
  bool known_ = false;
  bool fading_ = false;
  Reason why_ = Reason::kNone;
  double stiffness_ = 0.0;          // at the hand [N/m]
  double behind_for_ = 0.0;         // the tip, without a force [s]
  std::optional<Surface> refused_;  // what was not felt where it should be
};

}  // namespace handrail
