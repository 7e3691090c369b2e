// A box to touch from outside.
#pragma once

#include <algorithm>
#include <optional>

#include "devices/rig/world/contact.h"
#include "devices/rig/world/faces.h"
#include "devices/rig/world/tip_step.h"
#include "server/model/simulate.h"

namespace handrail {

// Touched at one face at a time: the tip is a point. Real-time safe.
class Box {
 public:
  explicit Box(const BoxSpec& spec) noexcept : spec_(spec) { contact_.law = spec.surface; }

  // Adds what the tip may touch in this step.
  void find(const TipStep& tip, ContactList& out) noexcept {
    if (!contact_.touching()) face_.reset();
    const auto face = face_at<6>(gaps(tip.x_last), gaps(tip.y), face_);
    if (face != face_) contact_.clear();
    face_ = face;
    if (!face) return;
    const auto axis = static_cast<int>(*face / 2);
    const double side = *face % 2 == 0 ? 1.0 : -1.0;
    contact_.n = side * (spec_.X_SB.q * Vec3::Unit(axis));
    contact_.offset = contact_.n.dot(spec_.X_SB.p) + spec_.half[axis];
    out.add(contact_);
  }
  // How far `p_S` is outside of its nearest face, below 0 inside [m].
  double outside(const Vec3& p_S) const noexcept {
    const FaceGaps<6> all = gaps(p_S);
    return *std::max_element(all.begin(), all.end());
  }

 private:
  FaceGaps<6> gaps(const Vec3& p_S) const noexcept {
    const Vec3 p = spec_.X_SB.q.conjugate() * (p_S - spec_.X_SB.p);
    FaceGaps<6> out{};
    for (int i = 0; i < 3; ++i) {
      out[static_cast<std::size_t>(2 * i)] = p[i] - spec_.half[i];
      out[static_cast<std::size_t>(2 * i + 1)] = -p[i] - spec_.half[i];
    }
    return out;
  }

  BoxSpec spec_;
  Contact contact_;
  std::optional<std::size_t> face_;
};

}  // namespace handrail
