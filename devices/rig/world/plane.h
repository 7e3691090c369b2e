// A half space to touch.
#pragma once

#include "devices/rig/world/contact.h"
#include "devices/rig/world/tip_step.h"
#include "server/model/simulate.h"

namespace handrail {

// Real-time safe.
class Plane {
 public:
  explicit Plane(const PlaneSpec& spec) noexcept {
    contact_.n = spec.normal;
    contact_.offset = spec.normal.dot(spec.at);
    contact_.law = spec.surface;
  }
  // Adds what the tip may touch in this step.
  void find(const TipStep&, ContactList& out) noexcept { out.add(contact_); }
  // How far `p_S` is outside, below 0 inside [m].
  double outside(const Vec3& p_S) const noexcept { return contact_.gap(p_S); }

 private:
  Contact contact_;
};

}  // namespace handrail
