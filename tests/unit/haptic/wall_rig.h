// A step among walls whose proxy is in closed form.
#pragma once

#include <memory>
#include <vector>

#include "server/constraint/proxy_image.h"
#include "server/haptic/wall_step.h"

namespace handrail::test {

// The wall is all of x > 0; for y < 0 free space is an aisle of its own.
class HalfPlane final : public WallProxy {
 public:
  Vec2 start(const Vec2& hand) noexcept override {
    ++starts;
    return allowed(hand);
  }
  WallContact advance(const Vec2& hand) noexcept override {
    WallContact out;
    out.proxy = allowed(hand);
    out.touching = out.proxy != hand;
    if (out.touching) out.normal = Vec2(-1.0, 0.0);
    out.wall = 1;
    out.region = out.proxy.y() < 0.0 ? 2 : 0;
    return out;
  }
  void set_gone(std::uint64_t gone) noexcept override { gone_ = (gone & 2u) != 0; }
  std::size_t save(std::span<std::byte, kMostImage> out) const noexcept override {
    return put_in_image(out, gone_, starts);
  }
  bool restore(std::span<const std::byte> image) noexcept override {
    return take_from_image(image, gone_, starts);
  }
  std::size_t memory() const noexcept override { return sizeof(*this); }

  int starts = 0;

 private:
  Vec2 allowed(const Vec2& hand) const noexcept {
    return gone_ || hand.x() < 0.0 ? hand : Vec2(0.0, hand.y());
  }
  bool gone_ = false;
};

inline EffectSpec effect(EffectKind kind) {
  EffectSpec out;
  out.kind = kind;
  return out;
}

// All that a step can hold at once, with parameters on the hard side.
inline std::vector<EffectSpec> every_effect() {
  std::vector<EffectSpec> out;
  for (int i = 0; i < static_cast<int>(EffectKind::kCount); ++i) {
    EffectSpec e = effect(static_cast<EffectKind>(i));
    e.c = 500.0;
    e.peak = 4.0;
    e.radius = 4e-3;
    if (e.kind == EffectKind::kOneWay) e.stiffness = 2500.0;
    if (e.kind == EffectKind::kDetent) e.places = {Vec2(-0.02, 0.0), Vec2(-0.02, -0.03)};
    out.push_back(e);
  }
  return out;
}

struct WallRig {
  explicit WallRig(const std::vector<EffectSpec>& effects = {effect(EffectKind::kWall)}) {
    WallRegion wall;
    wall.kind = RegionKind::kWall;
    wall.damping = 0.0;
    WallRegion aisle;
    aisle.kind = RegionKind::kAisle;
    aisle.viscosity = 20.0;
    aisle.progressive = true;
    aisle.one_way = Vec2(0.0, 1.0);
    walls->regions = {WallRegion(), wall, aisle};
    walls->stages.resize(3);
    settings.walls = walls;
    settings.force.peak = 25.3;
    settings.force.continuous = 8.5;
    settings.force.step = 0.38;
    auto owned = std::make_unique<HalfPlane>();
    proxy = owned.get();
    state.proxy = std::move(owned);
    Plant plant;
    plant.most_force = settings.force.peak;
    state.effects = EffectStack(effects, plant);
    in.hand.valid = true;
  }

  void step() { wall_step(settings, in, 1e-3, state, out); }
  // The hand goes to `p` of M within a tick; the force there [N].
  Vec2 move(const Vec2& p) {
    const Vec2 before = in.hand.X_MH.p.head<2>();
    in.hand.X_MH.p = Vec3(p.x(), p.y(), 0.0);
    const Vec2 v = moved_ ? Vec2((p - before) / 1e-3) : Vec2(Vec2::Zero());
    in.hand.v_MH = v.allFinite() ? Vec3(v.x(), v.y(), 0.0) : Vec3(Vec3::Zero());
    moved_ = true;
    step();
    return out.f_H_M.force.head<2>();
  }

  std::shared_ptr<Walls> walls = std::make_shared<Walls>();
  WallSettings settings;
  HalfPlane* proxy = nullptr;
  WallInput in;
  WallState state;
  WallOutput out;

 private:
  bool moved_ = false;
};

}  // namespace handrail::test
