#include "devices/rig/world/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace handrail {
namespace {

constexpr double kStiffKey = 1e4;  // a key without tool_compliance [N m/rad]

double twist_of(const Simulate& list) noexcept {
  const auto* tool = list.find<ToolComplianceSpec>();
  return tool != nullptr ? tool->twist : kStiffKey;
}

}  // namespace

bool World::is_needed(const Simulate& list) noexcept {
  return std::any_of(list.effects.begin(), list.effects.end(), [](const RigEffectSpec& e) {
    const RigEffectKind kind = kind_of(e);
    return is_touched(kind) || kind == RigEffectKind::kBacklash || kind == RigEffectKind::kGravity;
  });
}

World::World(const Simulate& list, const ArmGeometry& geometry, const JointVector& q_start) noexcept
    : geometry_(geometry),
      compliance_(list),
      backlash_(list.find<BacklashSpec>(), q_start),
      sag_(list.find<GravitySpec>()),
      screw_(list.find<ScrewThreadSpec>(), twist_of(list)) {
  const auto add = [this](auto surface) {
    if (surface_count_ < surfaces_.size()) surfaces_[surface_count_++] = surface;
  };
  for (const RigEffectSpec& effect : list.effects) {
    if (const auto* plane = std::get_if<PlaneSpec>(&effect)) add(Plane(*plane));
    if (const auto* box = std::get_if<BoxSpec>(&effect)) add(Box(*box));
    if (const auto* cylinder = std::get_if<CylinderSpec>(&effect)) add(Cylinder(*cylinder));
  }
  // A key's bending against tilt is about its twist's.
  if (const auto* socket = list.find<HexSocketSpec>()) socket_.emplace(*socket, twist_of(list));
  tip_ = forward(geometry_, q_start + sag_.bend(geometry_, q_start));
  p0_ = tip_.p;
}

void World::step(const JointVector& q_servo, double h) noexcept {
  const JointVector& q = backlash_.follow(q_servo);
  lead(forward(geometry_, q + sag_.bend(geometry_, q)), h);
}

void World::lead(const Pose& X, double h) noexcept {
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
  if (socket_) socket_->find(tip, -screw_.angle(), contacts);
  const Equilibrium there = solve_contacts(contacts, tip_.p, X.p, compliance_.at(X.q), h);
  p0_ = X.p;
  tip_ = {there.x, X.q};
  on_tip_.force = there.force;
  rounds_ = there.rounds;
  if (socket_) turn_screw();
}

void World::turn_screw() noexcept {
  constexpr double kHardlyInside = 1e-3;  // [m]
  socket_->settle(tip_);
  const double engaged = socket_->engaged();
  if (engaged > 0.0 || socket_->depth() < 0.0) slipped_ = false;
  double torque = 0.0;
  if (engaged > 0.0) {
    torque = screw_.turn(-socket_->key_turn(), socket_->spec().backlash);
    slipped_ = (engaged < kHardlyInside && std::abs(torque) >= screw_.start()) ||
               socket_->tilt() > HexSocket::kLost;
    if (slipped_) {
      torque = 0.0;
      socket_->lose();
    }
  }
  on_tip_.torque = torque * socket_->axis();
}

double World::depth() const noexcept {
  return socket_ ? socket_->depth() : -std::numeric_limits<double>::infinity();
}

std::optional<TipInside> World::inside() const noexcept {
  TipInside out;
  const auto look = [&](RigEffectKind what, double outside) {
    if (-outside > out.deep) out = {what, -outside};
  };
  for (std::size_t i = 0; i < surface_count_; ++i) {
    if (const auto* plane = std::get_if<Plane>(&surfaces_[i]))
      look(RigEffectKind::kPlane, plane->outside(tip_.p));
    if (const auto* box = std::get_if<Box>(&surfaces_[i]))
      look(RigEffectKind::kBox, box->outside(tip_.p));
    if (const auto* cylinder = std::get_if<Cylinder>(&surfaces_[i]))
      look(RigEffectKind::kCylinder, cylinder->outside(tip_.p));
  }
  if (socket_) look(RigEffectKind::kHexSocket, socket_->outside(tip_.p));
  return out.deep > 0.0 ? std::optional(out) : std::nullopt;
}

Wrench World::on_sensor() const noexcept {
  const Quat q_TS = tip_.q.conjugate();
  const Wrench weight = sag_.weight(tip_.q);
  const Quat turn = geometry_.turn_of_flange(Quat::Identity()).conjugate();
  return {turn * (q_TS * on_tip_.force + weight.force),
          turn * (q_TS * on_tip_.torque + weight.torque)};
}

}  // namespace handrail
