// A cylinder to touch from outside, or the inside of a tube.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "devices/rig/world/contact.h"
#include "devices/rig/world/faces.h"
#include "devices/rig/world/tip_step.h"
#include "server/model/simulate.h"

namespace handrail {

// Touched at its side or one end at a time. Its curved side is the tangent plane at the tip of each
// step. Real-time safe.
class Cylinder {
 public:
  explicit Cylinder(const CylinderSpec& spec) noexcept : spec_(spec) {
    contact_.law = spec.surface;
  }

  // Adds what the tip may touch in this step.
  void find(const TipStep& tip, ContactList& out) noexcept {
    if (spec_.hole) {
      find_inside(tip, out);
    } else {
      find_outside(tip, out);
    }
  }
  // How far `p_S` is outside of its nearest face, below 0 inside [m]. Of a tube there is no inside:
  // a tip beyond its wall never touches it.
  double outside(const Vec3& p_S) const noexcept {
    if (spec_.hole) return std::numeric_limits<double>::infinity();
    const FaceGaps<3> all = gaps(p_S);
    return *std::max_element(all.begin(), all.end());
  }

 private:
  enum Face : std::size_t { kSide, kTop, kBottom };

  double height(const Vec3& p_S) const noexcept { return spec_.axis.dot(p_S - spec_.at); }
  // From the axis to the point.
  Vec3 across(const Vec3& p_S) const noexcept {
    const Vec3 p = p_S - spec_.at;
    return p - spec_.axis.dot(p) * spec_.axis;
  }
  FaceGaps<3> gaps(const Vec3& p_S) const noexcept {
    const double z = height(p_S);
    return {across(p_S).norm() - spec_.radius, z - spec_.half_length, -z - spec_.half_length};
  }
  Vec3 direction(const Vec3& v) const noexcept {
    const double length = v.norm();
    return length > 1e-9 ? Vec3(v / length) : spec_.axis.unitOrthogonal();
  }

  void find_outside(const TipStep& tip, ContactList& out) noexcept {
    if (!contact_.touching()) face_.reset();
    const auto face = face_at<3>(gaps(tip.x_last), gaps(tip.y), face_);
    if (face != face_) contact_.clear();
    face_ = face;
    if (!face) return;
    contact_.n = *face == kSide  ? direction(across(tip.x_last))
                 : *face == kTop ? spec_.axis
                                 : Vec3(-spec_.axis);
    contact_.offset =
        contact_.n.dot(spec_.at) + (*face == kSide ? spec_.radius : spec_.half_length);
    out.add(contact_);
  }

  // Only a tip that came in through an end is inside.
  void find_inside(const TipStep& tip, ContactList& out) noexcept {
    const bool beside = std::abs(height(tip.y)) > spec_.half_length;
    if (beside || !(inside_ || across(tip.y).norm() <= spec_.radius)) {
      inside_ = false;
      contact_.clear();
      return;
    }
    inside_ = true;
    // A deep tip would swing from side to side if the wall were taken where it stood last: the
    // deeper it wants to go, the more that decides.
    const Vec3 from = across(tip.x_last), to = across(tip.x0);
    const double depth = to.norm();
    const double share = depth > spec_.radius ? 1.0 - spec_.radius / depth : 0.0;
    contact_.n = -direction((1.0 - share) * from + share * to);
    contact_.offset = contact_.n.dot(spec_.at) - spec_.radius;
    out.add(contact_);
  }

  CylinderSpec spec_;
  Contact contact_;
  std::optional<std::size_t> face_;
  bool inside_ = false;
};

}  // namespace handrail
