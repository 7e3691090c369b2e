// Where the tip is while the joints turn a little at a time: without a sine or cosine a step.
#pragma once

#include <cmath>

#include "server/kinematics/arm_plane.h"
#include "server/kinematics/jacobian.h"

namespace handrail {

// The tip's place and how it moves with the joints, from sines and cosines that are turned along.
class TipPlace {
 public:
  TipPlace(const ArmGeometry& arm, const JointVector& q) noexcept
      : arm_(&arm), one_(q[0]), two_(q[1]), both_(q[1] + q[2]), four_(q[3]), five_(q[4]) {
    if (arm.X_AT) six_ = Angle(q[5]);
  }

  // Turns the joints on by `step`, each by less than kMostTurn: below rounding then. Real-time
  // safe.
  static constexpr double kMostTurn = 0.2;  // [rad]
  void turn(const JointVector& step) noexcept {
    one_.turn(step[0]);
    two_.turn(step[1]);
    both_.turn(step[1] + step[2]);
    four_.turn(step[3]);
    five_.turn(step[4]);
    if (arm_->X_AT) six_.turn(step[5]);
  }

  // The tip, frame S [m]. Real-time safe.
  Vec3 p() const noexcept {
    const ArmPlane plane = arm_plane(*arm_, two_.s, two_.c, both_.s, both_.c);
    // The tip's axis ahead in the arm's plane, beside it and up.
    const double out = five_.s * four_.c;
    const double ahead = plane.radius + arm_->d6 * (five_.c * both_.s + out * both_.c);
    const double aside = arm_->d6 * five_.s * four_.s;
    Vec3 p(one_.c * ahead - one_.s * aside, one_.s * ahead + one_.c * aside,
           plane.height + arm_->d6 * (five_.c * both_.c - out * both_.s));
    if (!arm_->X_AT) return p;
    return p + offset({one_.c * both_.s, one_.s * both_.s, both_.c},
                      {one_.c * both_.c, one_.s * both_.c, -both_.s}, {-one_.s, one_.c, 0.0});
  }

  // How it moves with the joints. Real-time safe.
  TipJacobian jacobian() const noexcept {
    const ArmPlane plane = arm_plane(*arm_, two_.s, two_.c, both_.s, both_.c);
    const Vec3 ahead(one_.c, one_.s, 0.0), aside(-one_.s, one_.c, 0.0);
    const Vec3 forearm(one_.c * both_.s, one_.s * both_.s, both_.c);
    const Vec3 across(one_.c * both_.c, one_.s * both_.c, -both_.s);
    const Vec3 wrist_axis = four_.c * aside - four_.s * across;
    const Vec3 tip_axis = five_.c * forearm + five_.s * (four_.c * across + four_.s * aside);
    Vec3 tip = arm_->d6 * tip_axis;
    if (arm_->X_AT) tip += offset(forearm, across, aside);
    const Vec3 from_shoulder =
        (plane.radius - arm_->a1) * ahead + (plane.height - arm_->d1) * Vec3::UnitZ() + tip;
    const Vec3 from_elbow = arm_->d4 * forearm - arm_->a3 * across + tip;
    const Vec3 from_base = from_shoulder + arm_->a1 * ahead;
    TipJacobian J;
    J.angular << Vec3::UnitZ(), aside, aside, forearm, wrist_axis, tip_axis;
    J.linear << Vec3(-from_base.y(), from_base.x(), 0.0), aside.cross(from_shoulder),
        aside.cross(from_elbow), forearm.cross(tip), wrist_axis.cross(tip), Vec3::Zero();
    if (arm_->X_AT) J.linear.col(5) = tip_axis.cross(tip);
    return J;
  }

 private:
  struct Angle {
    explicit Angle(double angle) noexcept : s(std::sin(angle)), c(std::cos(angle)) {}
    constexpr Angle(double cosine, double sine) noexcept : s(sine), c(cosine) {}
    void turn(double x) noexcept {
      // Each power of the series beside the one before it.
      constexpr double k3 = 1.0 / 6.0, k5 = 1.0 / 20.0, k7 = 1.0 / 42.0, k9 = 1.0 / 72.0;
      constexpr double k4 = 1.0 / 12.0, k6 = 1.0 / 30.0, k8 = 1.0 / 56.0, k10 = 1.0 / 90.0;
      const double y = x * x;
      const double sine = x * (1.0 - k3 * y * (1.0 - k5 * y * (1.0 - k7 * y * (1.0 - k9 * y))));
      const double less =
          0.5 * y * (1.0 - k4 * y * (1.0 - k6 * y * (1.0 - k8 * y * (1.0 - k10 * y))));
      const double turned = s + (c * sine - s * less);
      c -= s * sine + c * less;
      s = turned;
    }
    double s, c;
  };

  // The tip from the point A, of axes as in jacobian() [m]: those of frame A turn with J4, J5 and
  // J6.
  Vec3 offset(const Vec3& forearm, const Vec3& across, const Vec3& aside) const noexcept {
    const Vec3& p_AT = arm_->X_AT->p;
    const Vec3 x_4 = four_.c * across + four_.s * aside, y_4 = four_.c * aside - four_.s * across;
    const Vec3 x_5 = five_.c * x_4 - five_.s * forearm, z_5 = five_.c * forearm + five_.s * x_4;
    return p_AT.x() * (six_.c * x_5 + six_.s * y_4) + p_AT.y() * (six_.c * y_4 - six_.s * x_5) +
           p_AT.z() * z_5;
  }

  const ArmGeometry* arm_;
  Angle one_, two_, both_, four_, five_;
  Angle six_{1.0, 0.0};  // of a tip beside the axis only
};

}  // namespace handrail
