// Contact of the tip with stiff surfaces, and the equilibrium of several at once.
//
// The tip has no mass: each step it stands where springs and friction balance. With C the
// compliance of arm and tool, x0 where the tip would be with nothing to touch and f_i the contacts'
// forces on it, x = x0 + C sum f_i. That is solved for the end of the step, springs and dampers of
// the surfaces with it, so any stiffness is stable at any step. Left out: the tip's mass, and so
// ringing and the first peak of an impact, about v sqrt(m k).
#pragma once

#include <array>
#include <limits>

#include "server/base/spatial.h"
#include "server/model/simulate.h"

namespace handrail {

// A half space with spring, damper and Coulomb friction, and what it remembers. Frame S.
struct Contact {
  Vec3 n = Vec3::UnitZ();  // unit, out of the solid
  double offset = 0.0;     // the surface is where n . x = offset [m]
  SurfaceSpec law;
  // Not infinite: no half space, but something that holds the tip along n, either way, with at most
  // this force [N].
  double grip = std::numeric_limits<double>::infinity();

  Vec3 f = Vec3::Zero();       // on the tip, end of the last step [N]
  double dent = 0.0;           // how far the surface is pushed in [m]
  Vec3 anchor = Vec3::Zero();  // where friction holds on to

  bool touching() const noexcept { return f != Vec3::Zero(); }
  bool is_grip() const noexcept { return grip < std::numeric_limits<double>::infinity(); }
  // How far x is outside, below 0 inside [m].
  double gap(const Vec3& x) const noexcept { return n.dot(x) - offset; }
  // Nothing is touched here any more.
  void clear() noexcept {
    f.setZero();
    dent = 0.0;
  }
};

// The contacts that the tip may have in a step; not owned.
class ContactList {
 public:
  static constexpr int kMost = 16;

  void add(Contact& contact) noexcept {
    if (count_ < kMost) contacts_[static_cast<std::size_t>(count_++)] = &contact;
  }
  int size() const noexcept { return count_; }
  Contact& operator[](int i) const noexcept { return *contacts_[static_cast<std::size_t>(i)]; }

 private:
  std::array<Contact*, kMost> contacts_{};
  int count_ = 0;
};

struct Equilibrium {
  Vec3 x = Vec3::Zero();      // of the tip
  Vec3 force = Vec3::Zero();  // of all contacts on it [N]
  int rounds = 0;
};

// Where the tip stands after `h` > 0 seconds, from `x_last`, when it would be at `x0` by itself.
// Writes the contacts' forces and memory. Block Gauss-Seidel from the last forces, until none
// changes by more than 1 mN, at most kMostRounds. Real-time safe, finite for finite input.
inline constexpr int kMostRounds = 16;
Equilibrium solve_contacts(const ContactList& contacts, const Vec3& x_last, const Vec3& x0,
                           const Mat3& C, double h) noexcept;

}  // namespace handrail
