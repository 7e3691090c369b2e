// A tip without joints, to touch one thing of the world with.
#pragma once

#include "devices/rig/world/contact.h"
#include "devices/rig/world/tip_step.h"

namespace handrail::test {

constexpr double kStep = 1e-3;  // of the rig's world [s]

inline SurfaceSpec smooth(double stiffness = 1e6, double damping = 0.0) {
  return {stiffness, damping, 0.0};
}
inline SurfaceSpec rough(double friction, double stiffness = 1e6) {
  return {stiffness, 0.0, friction};
}

template <typename Surface>
class Probe {
 public:
  // Stands free at `x` on a spring of `compliance` [m/N], the same every way.
  Probe(const Surface& surface, const Vec3& x, double compliance = 1.0 / 60e3)
      : surface_(surface), C_(compliance * Mat3::Identity()), x_(x), x0_(x) {}

  void set_compliance(const Mat3& C) { C_ = C; }
  // One step to x0 of `h` seconds; the force of what is touched.
  const Vec3& to(const Vec3& x0, double h = kStep) {
    const TipStep tip{x_, x0, x_ + (x0 - x0_), Quat::Identity()};
    ContactList contacts;
    surface_.find(tip, contacts);
    const Equilibrium there = solve_contacts(contacts, x_, x0, C_, h);
    work_ -= there.force.dot(x0 - x0_);
    x_ = there.x;
    x0_ = x0;
    force_ = there.force;
    rounds_ = there.rounds;
    return force_;
  }
  // A straight way in steps of at most `step` metres.
  const Vec3& along(const Vec3& x0, double step = 1e-5) {
    const Vec3 from = x0_;
    const int count = static_cast<int>((x0 - from).norm() / step) + 1;
    for (int i = 1; i <= count; ++i) to(from + (x0 - from) * i / count);
    return force_;
  }
  void rest(int steps = 1000) {
    for (int i = 0; i < steps; ++i) to(x0_);
  }

  const Vec3& x() const { return x_; }
  const Vec3& force() const { return force_; }
  // What moving the tip has taken so far [J].
  double work() const { return work_; }
  int rounds() const { return rounds_; }

 private:
  Surface surface_;
  Mat3 C_;
  Vec3 x_, x0_;
  Vec3 force_ = Vec3::Zero();
  double work_ = 0.0;
  int rounds_ = 0;
};

}  // namespace handrail::test
