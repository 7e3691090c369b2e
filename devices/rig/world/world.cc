#include "devices/rig/world/world.h"

#include <algorithm>
#include <type_traits>

namespace handrail {

bool World::is_needed(const Simulate& list) noexcept {
  return std::any_of(list.effects.begin(), list.effects.end(),
                     [](const RigEffectSpec& e) { return is_touched(kind_of(e)); });
}

World::World(const Simulate& list, const ArmGeometry& geometry, const JointVector& q_start) noexcept
    : geometry_(geometry), compliance_(list) {
  const auto add = [this](auto surface) {
    if (surface_count_ < surfaces_.size()) surfaces_[surface_count_++] = surface;
  };
  for (const RigEffectSpec& effect : list.effects) {
    if (const auto* plane = std::get_if<PlaneSpec>(&effect)) add(Plane(*plane));
    if (const auto* box = std::get_if<BoxSpec>(&effect)) add(Box(*box));
    if (const auto* cylinder = std::get_if<CylinderSpec>(&effect)) add(Cylinder(*cylinder));
  }
  tip_ = forward(geometry_, q_start);
  p0_ = tip_.p;
}

void World::step(const JointVector& q_servo, double h) noexcept {
  const Pose X = forward(geometry_, q_servo);
  const TipStep tip{tip_.p, X.p, tip_.p + (X.p - p0_), X.q};
  ContactList contacts;
  for (std::size_t i = 0; i < surface_count_; ++i) {
    std::visit(
        [&](auto& surface) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(surface)>, std::monostate>) {
            surface.find(tip, contacts);
          }
        },
        surfaces_[i]);
  }
  const Equilibrium there = solve_contacts(contacts, tip_.p, X.p, compliance_.at(X.q), h);
  p0_ = X.p;
  tip_ = {there.x, X.q};
  on_tip_.force = there.force;
  rounds_ = there.rounds;
}

Wrench World::on_sensor() const noexcept {
  const Quat q_TS = tip_.q.conjugate();
  return {q_TS * on_tip_.force, q_TS * on_tip_.torque};
}

}  // namespace handrail
