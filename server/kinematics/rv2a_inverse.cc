// Closed-form inverse of the RV-2A. Every angle is the argument of a product of plane vectors (or
// of a quaternion) that is never normalised, so that no arc cosine loses digits near the end of its
// range and no pose divides by zero.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/kinematics/arc_tangent.h"
#include "server/kinematics/arm_plane.h"
#include "server/kinematics/rv2a.h"

namespace handrail {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSingular = 1e-9;      // [rad], and [m] from the J1 axis
constexpr double kReachSlack = 1e-12;   // rounding allowed on squared distances [m^2]
constexpr double kWristZone = 0.1;      // |J5| below which both wrist branches are near [rad]
constexpr double kShoulderZone = 0.02;  // distance from the J1 axis, likewise [m]

// Length times (cosine, sine) of an angle.
struct Arrow {
  double c = 1.0;
  double s = 0.0;
};

Arrow operator*(const Arrow& a, const Arrow& b) {  // adds the angles
  return {a.c * b.c - a.s * b.s, a.c * b.s + a.s * b.c};
}
double angle(const Arrow& a) { return arc_tangent(a.s, a.c); }

// Choices below are written so that they compile to masks: the branches of random poses mispredict.

// Half the angle of `a`, whose length is given; the result's length is positive and otherwise free.
Arrow half(const Arrow& a, double length) {
  const double longer = length + std::abs(a.c);
  const double front = a.c >= 0.0 ? 1.0 : 0.0, back = 1.0 - front;
  return {front * longer + back * std::abs(a.s), front * a.s + back * std::copysign(longer, a.s)};
}

double wrapped(double a) {
  return a + ((a <= -kPi ? 2.0 * kPi : 0.0) - (a > kPi ? 2.0 * kPi : 0.0));
}
double opposite(double a) { return a + (kPi - (a > 0.0 ? 2.0 * kPi : 0.0)); }
double nearest(double a, double seed) { return a + 2.0 * kPi * nearest_turns(seed - a); }
bool over_quarter_turn(double a, double b) {
  const double d = a - b;
  return std::abs(d - 2.0 * kPi * nearest_turns(d)) > 0.5 * kPi;
}

// Wrist centre in S, with the height above the shoulder axis.
struct WristCentre {
  double x, y, height, radius;
};

WristCentre wrist_centre(const ArmGeometry& arm, const Pose& X_SA) {
  const double w = X_SA.q.w(), x = X_SA.q.x(), y = X_SA.q.y(), z = X_SA.q.z();
  const double k = arm.d6 / (w * w + x * x + y * y + z * z);
  WristCentre c;
  c.x = X_SA.p.x() - 2.0 * k * (x * z + w * y);
  c.y = X_SA.p.y() - 2.0 * k * (y * z - w * x);
  c.height = X_SA.p.z() - k * (w * w + z * z - x * x - y * y) - arm.d1;
  c.radius = std::sqrt(c.x * c.x + c.y * c.y);
  return c;
}

// Triangle of shoulder, elbow and wrist centre: sides a2 and l (elbow to wrist centre).
struct Triangle {
  Arrow wrist;             // shoulder to wrist centre, angle from the vertical [m]
  double distance2 = 0.0;  // its squared length
  double l2 = 0.0;         // l^2
  double cosine = 0.0;     // a2 l cos(elbow angle) [m^2]
  double sine = 0.0;       // a2 l |sin(elbow angle)| [m^2]
};

// False when the wrist centre is too far from the shoulder, too near, or not a number.
bool solve_triangle(const ArmGeometry& arm, double radius, double height, Triangle& t) {
  t.wrist = {height, radius - arm.a1};
  t.distance2 = t.wrist.c * t.wrist.c + t.wrist.s * t.wrist.s;
  t.l2 = arm.a3 * arm.a3 + arm.d4 * arm.d4;
  const double sides2 = arm.a2 * arm.a2 + t.l2;
  const double twice_product = 2.0 * arm.a2 * std::sqrt(t.l2);
  const double to_outer = sides2 + twice_product - t.distance2;
  const double to_inner = t.distance2 - (sides2 - twice_product);
  if (!(to_outer >= -kReachSlack && to_inner >= -kReachSlack)) return false;
  t.cosine = 0.5 * (t.distance2 - sides2);
  t.sine = 0.5 * std::sqrt(std::max(0.0, to_outer * to_inner));
  return true;
}

struct Elbow {
  double q2 = 0.0;
  double q3 = 0.0;
  Arrow half_23;  // (J2 + J3) / 2
};

Elbow solve_elbow(const ArmGeometry& arm, const Triangle& t, bool down) {
  const double sine = down ? -t.sine : t.sine;
  const Arrow elbow_to_q3{arm.d4, arm.a3};
  const Arrow upper_arm = t.wrist * Arrow{arm.a2 * arm.a2 + t.cosine, -sine};
  const Arrow forearm = t.wrist * Arrow{t.l2 + t.cosine, sine};
  Elbow e;
  e.q2 = angle(upper_arm);
  e.q3 = angle(Arrow{t.cosine, sine} * elbow_to_q3);
  e.half_23 = half(forearm * elbow_to_q3, t.distance2 * t.l2);
  return e;
}

// Orientation left for the wrist, Rz(J4) Ry(J5) Rz(J6), as a quaternion of free length.
struct WristRotation {
  double w, x, y, z;
};

WristRotation after_base(const Quat& q, const Arrow& half_1) {
  const auto [c, s] = half_1;
  return {c * q.w() + s * q.z(), c * q.x() + s * q.y(), c * q.y() - s * q.x(),
          c * q.z() - s * q.w()};
}

WristRotation after_forearm(const WristRotation& r, const Arrow& half_23) {
  const auto [c, s] = half_23;
  return {c * r.w + s * r.y, c * r.x - s * r.z, c * r.y - s * r.w, c * r.z + s * r.x};
}

struct Wrist {
  double q4, q5, q6;      // q5 >= 0: not flipped
  bool singular = false;  // J4 is free; it was taken from the seed, with the sign of q5
};

Wrist solve_wrist(const WristRotation& r, const JointVector& seed) {
  const double sine2 = r.x * r.x + r.y * r.y;    // sin^2(J5 / 2), times the length squared
  const double cosine2 = r.w * r.w + r.z * r.z;  // cos^2(J5 / 2), likewise
  const double length2 = sine2 + cosine2;
  const double product = 4.0 * sine2 * cosine2;
  const double q5 = arc_tangent(std::sqrt(product), cosine2 - sine2);
  if (product < kSingular * kSingular * length2 * length2) {
    const double q6 = cosine2 > sine2 ? 2.0 * arc_tangent(r.z, r.w) - seed[3]
                                      : 2.0 * arc_tangent(r.x, r.y) + seed[3];
    const double seed_5 = seed[4] - 2.0 * kPi * nearest_turns(seed[4]);
    return {seed[3], std::copysign(q5, seed_5), q6, true};
  }
  const double half_sum = arc_tangent(r.z, r.w);
  const double half_difference = arc_tangent(r.x, r.y);
  return {half_sum - half_difference, q5, half_sum + half_difference, false};
}

void solve_all(const ArmGeometry& arm, const Pose& X_SA, const JointVector& seed,
               InverseSolutions& out) {
  out.count = 0;
  const auto emit = [&out](double q1, const Elbow& e, const Wrist& w, const Branch& branch) {
    const auto i = static_cast<std::size_t>(out.count++);
    out.q[i] << wrapped(q1), wrapped(e.q2), wrapped(e.q3), w.q4, w.q5, w.q6;
    out.branch[i] = branch;
  };
  const WristCentre centre = wrist_centre(arm, X_SA);
  const bool on_axis = centre.radius < kSingular;
  const bool seed_back = on_axis && arm_plane(arm, seed).radius < 0.0;
  const double q1 = on_axis ? wrapped(nearest(seed[0], 0.0)) : arc_tangent(centre.y, centre.x);
  const Arrow half_1 = on_axis ? Arrow{std::cos(0.5 * q1), std::sin(0.5 * q1)}
                               : half({centre.x, centre.y}, centre.radius);

  for (const bool back : {false, true}) {
    if (on_axis && back != seed_back) continue;
    Triangle triangle;
    if (!solve_triangle(arm, back ? -centre.radius : centre.radius, centre.height, triangle)) {
      continue;
    }
    const bool turned = back && !on_axis;
    const WristRotation from_base =
        after_base(X_SA.q, turned ? Arrow{-half_1.s, half_1.c} : half_1);
    const double shoulder = turned ? opposite(q1) : q1;
    for (const bool down : {false, true}) {
      if (down && triangle.sine == 0.0) continue;
      const Elbow elbow = solve_elbow(arm, triangle, down);
      Wrist wrist = solve_wrist(after_forearm(from_base, elbow.half_23), seed);
      wrist.q4 = wrist.singular ? wrapped(nearest(wrist.q4, 0.0)) : wrapped(wrist.q4);
      wrist.q6 = wrist.singular ? wrapped(nearest(wrist.q6, 0.0)) : wrapped(wrist.q6);
      emit(shoulder, elbow, wrist, {back, down, wrist.q5 < 0.0});
      if (wrist.singular) continue;
      wrist = {opposite(wrist.q4), -wrist.q5, opposite(wrist.q6), false};
      emit(shoulder, elbow, wrist, {back, down, true});
    }
  }
}

InverseStatus solve_near(const ArmGeometry& arm, const Pose& X_SA, const JointVector& seed,
                         JointVector& q) {
  const ArmPlane plane = arm_plane(arm, seed);
  const WristCentre centre = wrist_centre(arm, X_SA);

  bool back = plane.radius < 0.0;
  double q1 = seed[0];
  Arrow half_1;
  if (centre.radius < kSingular) {
    half_1 = {std::cos(0.5 * q1), std::sin(0.5 * q1)};
  } else {
    half_1 = half({centre.x, centre.y}, centre.radius);
    q1 = arc_tangent(centre.y, centre.x);
    const bool far_side = over_quarter_turn(q1, seed[0]);
    const bool near_axis = centre.radius < kShoulderZone && std::abs(plane.radius) < kShoulderZone;
    if (near_axis || std::abs(plane.radius) < kSingular) back = far_side;
    if (back) {
      q1 = opposite(q1);
      half_1 = {-half_1.s, half_1.c};
    }
  }

  Triangle triangle;
  if (!solve_triangle(arm, back ? -centre.radius : centre.radius, centre.height, triangle)) {
    return InverseStatus::kUnreachable;
  }
  const Elbow elbow = solve_elbow(arm, triangle, plane.elbow_sine < 0.0);

  Wrist wrist = solve_wrist(after_forearm(after_base(X_SA.q, half_1), elbow.half_23), seed);
  if (!wrist.singular) {
    const double seed_5 = seed[4] - 2.0 * kPi * nearest_turns(seed[4]);
    const bool near_straight = wrist.q5 < kWristZone && std::abs(seed_5) < kWristZone;
    bool flipped = seed_5 < 0.0;
    if (near_straight || std::abs(seed_5) < kSingular) {
      flipped = over_quarter_turn(wrist.q4, seed[3]);
    }
    if (flipped) wrist = {opposite(wrist.q4), -wrist.q5, opposite(wrist.q6), false};
  }
  q << nearest(q1, seed[0]), nearest(elbow.q2, seed[1]), nearest(elbow.q3, seed[2]),
      nearest(wrist.q4, seed[3]), nearest(wrist.q5, seed[4]), nearest(wrist.q6, seed[5]);
  return InverseStatus::kOk;
}

}  // namespace

bool near_singular(const ArmGeometry& arm, const JointVector& q) noexcept {
  const SingularityMargin margin = singularity_margin(arm, q);
  return margin.wrist < kWristZone || margin.shoulder < kShoulderZone;
}

void inverse_all(const ArmGeometry& arm, const Pose& X_ST, const JointVector& seed,
                 InverseSolutions& out) noexcept {
  solve_all(arm, arm.X_AT ? X_ST * inverse(*arm.X_AT) : X_ST, seed, out);
}

InverseStatus inverse_near(const ArmGeometry& arm, const Pose& X_ST, const JointVector& seed,
                           JointVector& q) noexcept {
  if (arm.X_AT) return solve_near(arm, X_ST * inverse(*arm.X_AT), seed, q);
  return solve_near(arm, X_ST, seed, q);
}

}  // namespace handrail
