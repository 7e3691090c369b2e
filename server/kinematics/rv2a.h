// Kinematics of the Mitsubishi RV-2A: six axes, ortho-parallel arm, spherical wrist.
//
// Joint angles are the controller's J1..J6 in radians; ranges and speeds are in rv2a_limits.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "server/base/joints.h"
#include "server/base/spatial.h"
#include "server/model/rv2a_limits.h"

namespace handrail {

// Lengths of the chain [m].
struct ArmGeometry {
  double d1 = 0.350;  // base to shoulder height
  double a1 = 0.100;  // shoulder offset forward
  double a2 = 0.250;  // upper arm
  double a3 = 0.130;  // elbow offset above the forearm axis
  double d4 = 0.250;  // forearm, elbow to wrist centre
  double d6 =
      0.301;  // wrist centre to the point A on the flange's axis: 0.085 flange, 0.301 hex-key point
  // The tip, from frame A: at that point, turned as the flange. None: the tip is A.
  std::optional<Pose> X_AT;

  // Wrist centre to the tip of an arm turned as `q_ST`, frame S [m].
  Vec3 wrist_to_tip(const Quat& q_ST) const noexcept;
  // How the flange is turned then.
  Quat turn_of_flange(const Quat& q_ST) const noexcept {
    return X_AT ? q_ST * X_AT->q.conjugate() : q_ST;
  }
  // The tip's distance from the wrist centre, and from the last joint's axis [m].
  double tip_radius() const noexcept;
  double tip_aside() const noexcept;
};

inline constexpr double kFlangeLength = 0.085;  // wrist centre to flange [m]
inline constexpr double kHexKeyLength = 0.301;  // wrist centre to the hex key's ball centre [m]

// Tip pose X_ST. Real-time safe.
Pose forward(const ArmGeometry& arm, const JointVector& q) noexcept;

// Which of the arm's up to eight configurations a joint vector is in.
struct Branch {
  bool shoulder_back = false;  // wrist centre behind the J1 axis as J1 sees it
  bool elbow_down = false;     // the other solution of the elbow triangle
  bool wrist_flipped = false;  // J5 < 0
  friend bool operator==(const Branch&, const Branch&) = default;
};
Branch branch_of(const ArmGeometry& arm, const JointVector& q) noexcept;

// All closed-form solutions: `count` valid entries, angles in (-pi, pi], joint ranges not applied.
struct InverseSolutions {
  int count = 0;
  std::array<JointVector, 8> q;
  std::array<Branch, 8> branch;
};

// Solves X_ST for every branch. count = 0: out of reach. Within 1e-9 rad of a singular pose the
// free joint takes the seed's value and only the seed's side of that singularity is listed.
// Real-time safe, bounded work.
void inverse_all(const ArmGeometry& arm, const Pose& X_ST, const JointVector& seed,
                 InverseSolutions& out) noexcept;

enum class InverseStatus : std::uint8_t {
  kOk,
  kUnreachable,  // no solution on the seed's branch
};

// Solves X_ST on the branch of `seed`, each joint shifted by whole turns to lie nearest the seed,
// so that small motions of X_ST give small motions of q; at an exact wrist singularity the seed's
// J4 is kept, at a shoulder singularity the seed's J1. Where both wrist branches are near (|J5| <
// 0.1 rad before and after) or both shoulders are (wrist centre within 20 mm of the J1 axis), the
// one that turns J4 or J1 by at most a quarter turn is taken, so that a path straight through the
// singularity goes through. `q` is written only when the result is kOk. Joint ranges are not
// applied: the caller limits. Real-time safe.
InverseStatus inverse_near(const ArmGeometry& arm, const Pose& X_ST, const JointVector& seed,
                           JointVector& q) noexcept;

// Distances from the arm's singular configurations, 0 at the singularity.
struct SingularityMargin {
  double wrist = 0.0;     // |sin J5|
  double shoulder = 0.0;  // distance of the wrist centre from the J1 axis [m]
  double elbow = 0.0;     // |sin| of the elbow angle, 0 when stretched or folded
};
SingularityMargin singularity_margin(const ArmGeometry& arm, const JointVector& q) noexcept;

// Whether both wrists or both shoulders are near, as inverse_near means it. Real-time safe.
bool near_singular(const ArmGeometry& arm, const JointVector& q) noexcept;

}  // namespace handrail
