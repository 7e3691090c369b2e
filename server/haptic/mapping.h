// Workspace mapping between hand and tip (dissertation 3.1, 3.2) in relative form.
#pragma once

#include "server/base/spatial.h"
#include "server/base/units.h"
#include "server/model/linear_task.h"

namespace handrail {

// An absolute mapping takes over where hand and arm agree to so much at the tip. Chosen: a hand at
// rest strays by 1 to 2 mm, the tip by twice that, and the smoother spreads 5 mm over 0.2 s.
inline constexpr double kAgree = 5e-3;              // [m]
inline constexpr double kAgreeTurned = 5.0 * kDeg;  // [rad]

// Scale k and rotation R_SM of (3.1).
struct MappingSettings {
  double scale = 2.0;  // k > 0
  // Columns: device right, up, toward the user = base -Y, +Z, -X.
  Mat3 R_SM = (Mat3() << 0, 0, -1, -1, 0, 0, 0, 1, 0).finished();
  // Absolute: (3.1) and (3.2) as printed, the frames aligned where the tip points straight down.
  bool absolute = false;
  Vec3 hand_centre = Vec3::Zero();  // c_M, frame M [m]
  Vec3 tip_centre = Vec3::Zero();   // c_S, frame S [m]
};

// The mapping latched at engagement. (3.2) holds only for frames that start aligned, so both poses
// are taken relative to where hand and tip stood:
//   p_U = k R (p_H - p_H0) + p_T0,   R_U = R (R_H R_H0^T) R^T R_T0.
// With the hand still, U is exactly the latched tip. Absolute, it is latched once for all, and no
// hand may lead that is elsewhere. Real-time safe.
class Engagement {
 public:
  Engagement() = default;
  Engagement(const MappingSettings& mapping, const Pose& X_MH0, const Pose& X_ST0) noexcept
      : scale_(mapping.scale), q_SM_(mapping.R_SM), hand_(X_MH0), tip_(X_ST0) {}

  // Wherever both are:  p_U = k R (p_H - c_M) + c_S,  R_U = R R_H R^T R_down.
  static Engagement absolute(const MappingSettings& mapping) noexcept {
    return {mapping,
            {mapping.hand_centre, Quat::Identity()},
            {mapping.tip_centre, LinearTask().q_first}};
  }

  // Where the hand asks the tip to be.
  Pose to_slave(const Pose& X_MH) const noexcept {
    const Quat turned_M = X_MH.q * hand_.q.conjugate();
    // The vector part rotates with the frame; written so, a still hand gives the identity exactly.
    Quat turned_S;
    turned_S.w() = turned_M.w();
    turned_S.vec() = q_SM_ * turned_M.vec();
    return {scale_ * (q_SM_ * (X_MH.p - hand_.p)) + tip_.p, (turned_S * tip_.q).normalized()};
  }

  // A displacement of the tip in S as the displacement of the hand that causes it, in M [m].
  Vec3 to_hand(const Vec3& d_S) const noexcept { return (q_SM_.conjugate() * d_S) / scale_; }

  // A rotation vector or torque direction from S to M.
  Vec3 turn_to_hand(const Vec3& v_S) const noexcept { return q_SM_.conjugate() * v_S; }

 private:
  double scale_ = 1.0;
  Quat q_SM_ = Quat::Identity();
  Pose hand_;
  Pose tip_;
};

}  // namespace handrail
