// Spatial types and the frame glossary every other header relies on.
//
// Frames (Drake's monogram notation: X_AB is the pose of frame B measured in frame A; p_AB its
// origin, q_AB its rotation; v_AB a velocity; f_B_A a force on B expressed in A):
//
//   M  master: base of the haptic device. X right, Y up, Z toward the user.
//   H  hand: the stylus tip of the haptic device. X_MH is what the device reports.
//   S  slave: base of the robot arm. Origin on the mounting face at the J1 axis, X forward, Z up.
//   A  axis: the point at the tool's length on the flange's axis, turned as the flange.
//   T  tip: the tool's control point; A itself, unless the scene mounts the tool aside or turned
//   (X_AT).
//      X_ST is what the arm's kinematics give.
//   U  user command: where the hand asks the tip to be, in S, before the bumper.
//   B  bumped command: U after the virtual bumper, in S.
//   E  environment: f_E_S is the force the environment exerts on the tip, expressed in S.
//
// SI units everywhere: metres, radians, seconds, newtons. Millimetres and degrees appear only at
// the edges (devices, CLI, configuration), in names that end in _mm or _deg.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace handrail {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

// Rigid pose X_AB: a point p_B becomes q * p_B + p in A. `q` is a unit quaternion.
struct Pose {
  Vec3 p = Vec3::Zero();      // [m]
  Quat q = Quat::Identity();  // unit
};

// Six-axis displacement or velocity, expressed in the base frame: translation of the body's origin
// and rotation vector about that origin. [m or m/s], [rad or rad/s].
struct Twist {
  Vec3 linear = Vec3::Zero();
  Vec3 angular = Vec3::Zero();
};

inline Twist operator+(const Twist& a, const Twist& b) noexcept {
  return {a.linear + b.linear, a.angular + b.angular};
}
inline Twist operator-(const Twist& a, const Twist& b) noexcept {
  return {a.linear - b.linear, a.angular - b.angular};
}
inline Twist operator*(double s, const Twist& t) noexcept { return {s * t.linear, s * t.angular}; }

// Force [N] and torque [N m] on a body, both at its origin and in the frame the variable names.
struct Wrench {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
};

inline Pose operator*(const Pose& a, const Pose& b) { return {a.q * b.p + a.p, a.q * b.q}; }
inline Pose inverse(const Pose& x) {
  const Quat q = x.q.conjugate();
  return {-(q * x.p), q};
}

// Rotation by |v| radians about v. Exact at v = 0. Real-time safe.
inline Quat rotation_exp(const Vec3& v) {
  const double angle = v.norm();
  // sin(a/2)/a, whose series keeps full precision where the quotient would lose it.
  const double k = angle < 1e-6 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  return Quat(std::cos(0.5 * angle), k * v.x(), k * v.y(), k * v.z());
}

// Rotation vector of a unit quaternion, the shorter way round: |result| <= pi. q and -q give the
// same answer; at exactly pi the axis keeps the sign of the vector part. Real-time safe.
inline Vec3 rotation_log(const Quat& q) {
  const double s = q.vec().norm();
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  if (s < 1e-9) return 2.0 * sign * q.vec();
  return (2.0 * sign * std::atan2(s, std::abs(q.w())) / s) * q.vec();
}

// The smallest turn that takes the direction of `from` to that of `to`, both longer than 0. Of
// opposite ones the half turn about what is nearest to X, or to Y for directions along X. Eigen's
// FromTwoVectors does the same by a singular value decomposition, which each unit that names it
// compiles for seconds. Real-time safe.
inline Quat smallest_turn(const Vec3& from, const Vec3& to) {
  const Vec3 a = from.normalized(), b = to.normalized(), across = a.cross(b);
  // 1 + a b and a x b are cos and sin of half the angle, both times twice that cosine. Less of them
  // than this is rounding, and the axis not known to 1e-6.
  if (a.dot(b) < 0.0 && across.norm() < 1e-10) {
    const Vec3 axis = std::abs(a.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY();
    const Vec3 square = (axis - axis.dot(a) * a).normalized();
    return Quat(0.0, square.x(), square.y(), square.z());
  }
  // Written so, the first loses nothing where the two are nearly opposite.
  return Quat(0.5 * (a + b).squaredNorm(), across.x(), across.y(), across.z()).normalized();
}

// From `from` to `to`, the shorter way round.
inline Twist between(const Pose& from, const Pose& to) {
  return {to.p - from.p, rotation_log(to.q * from.q.conjugate())};
}

// Angle between two orientations [rad], 0 to pi.
inline double angle_between(const Quat& a, const Quat& b) {
  return rotation_log(a.conjugate() * b).norm();
}

inline bool is_finite(const Vec3& v) { return v.allFinite(); }
inline bool is_finite(const Quat& q) { return q.coeffs().allFinite(); }
inline bool is_finite(const Pose& x) { return is_finite(x.p) && is_finite(x.q); }
inline bool is_finite(const Wrench& w) { return is_finite(w.force) && is_finite(w.torque); }
inline bool is_unit(const Quat& q, double tolerance = 1e-6) {
  return std::abs(q.squaredNorm() - 1.0) < tolerance;
}

// No device and no arm reaches so far from its base: beyond is no place, and is neither sent nor
// taken [m]. Real-time safe, as are the next two.
inline constexpr double kFarthest = 10.0;
inline bool is_place(const Vec3& p) { return is_finite(p) && p.norm() < kFarthest; }
inline bool is_place(const Pose& x) { return is_place(x.p) && is_finite(x.q) && is_unit(x.q); }

}  // namespace handrail
