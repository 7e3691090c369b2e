#include "devices/rig/world/contact.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

constexpr double kSettled = 1e-3;  // [N]

// A contact's equation for this step: W f = what its force has to undo.
struct Equation {
  Mat3 W, W_inverse;
  double sag = 0.0;  // what the damper keeps of the last dent [m]
  bool ready = false;
};

void prepare(const Contact& c, const Mat3& C, double h, Equation& e) noexcept {
  const double tangential = 1.0 / c.law.stiffness;
  const double normal = c.is_grip() ? tangential : 1.0 / (c.law.stiffness + c.law.damping / h);
  e.W = C + tangential * Mat3::Identity() + (normal - tangential) * c.n * c.n.transpose();
  e.W_inverse = e.W.inverse();
  e.sag = c.law.damping / h * normal * c.dent;
  e.ready = true;
}

// The force with which c holds the tip, were it at `x` without it.
Vec3 force_at(const Contact& c, const Equation& e, const Vec3& x) noexcept {
  if (c.is_grip()) {
    const double wanted = -c.n.dot(x - c.anchor) / c.n.dot(e.W * c.n);
    return std::clamp(wanted, -c.grip, c.grip) * c.n;
  }
  const double depth = -c.gap(x) - e.sag;
  const Vec3 off = x - c.anchor;
  Vec3 stuck = e.W_inverse * (depth * c.n - (off - c.n.dot(off) * c.n));
  const double pressure = c.n.dot(stuck);
  const Vec3 across = stuck - pressure * c.n;
  const double friction = across.norm();
  if (pressure > 0.0 && friction <= c.law.friction * pressure) return stuck;
  if (depth <= 0.0) return Vec3::Zero();
  // It slides, the way it is pulled.
  const double straight = c.n.dot(e.W * c.n);
  if (friction <= 0.0) return depth / straight * c.n;
  const Vec3 way = c.n + c.law.friction / friction * across;
  // Friction that would press the tip in for ever wedges it; the share keeps that finite.
  constexpr double kLeast = 0.1;
  return depth / std::max(c.n.dot(e.W * way), kLeast * straight) * way;
}

// Where friction takes hold: where the way from `x_last` to `x` meets the surface.
void begin(Contact& c, const Vec3& x_last, const Vec3& x) noexcept {
  const double before = c.gap(x_last), after = c.gap(x);
  const double share =
      before > 0.0 && after < before ? std::min(before / (before - after), 1.0) : 0.0;
  c.anchor = x_last + share * (x - x_last);
}

void remember(Contact& c, const Equation& e, const Vec3& x, double h) noexcept {
  if (c.touching()) {
    const double pressure = c.n.dot(c.f);
    const Vec3 across = c.is_grip() ? c.f : Vec3(c.f - pressure * c.n);
    const double most = c.is_grip() ? c.grip : c.law.friction * pressure;
    // Sliding takes the anchor along.
    if (across.norm() >= most * (1.0 - 1e-9)) c.anchor = x + across / c.law.stiffness;
    c.dent = c.is_grip() ? 0.0 : pressure / (c.law.stiffness + c.law.damping / h) + e.sag;
  } else if (c.dent > 0.0) {
    c.dent *= c.law.damping / (c.law.damping + c.law.stiffness * h);  // comes out by itself
  }
}

}  // namespace

Equilibrium solve_contacts(const ContactList& contacts, const Vec3& x_last, const Vec3& x0,
                           const Mat3& C, double h) noexcept {
  std::array<Equation, ContactList::kMost> equations;
  Equilibrium out;
  for (int i = 0; i < contacts.size(); ++i) out.force += contacts[i].f;
  double change = contacts.size() > 0 ? 2.0 * kSettled : 0.0;
  for (; change > kSettled && out.rounds < kMostRounds; ++out.rounds) {
    change = 0.0;
    for (int i = 0; i < contacts.size(); ++i) {
      Contact& c = contacts[i];
      const Vec3 x = x0 + C * (out.force - c.f);
      if (!c.is_grip() && !c.touching()) {
        if (c.gap(x) >= 0.0) continue;
        begin(c, x_last, x);
      }
      Equation& e = equations[static_cast<std::size_t>(i)];
      if (!e.ready) prepare(c, C, h, e);
      const Vec3 f = force_at(c, e, x);
      change = std::max(change, (f - c.f).cwiseAbs().maxCoeff());
      out.force += f - c.f;
      c.f = f;
    }
  }
  out.x = x0 + C * out.force;
  for (int i = 0; i < contacts.size(); ++i) {
    remember(contacts[i], equations[static_cast<std::size_t>(i)], out.x, h);
  }
  return out;
}

}  // namespace handrail
