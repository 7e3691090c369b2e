// Regions and inputs for tests of effects.
#pragma once

#include <cmath>

#include "server/effects/effect_input.h"

namespace handrail::test {

inline constexpr double kTick = 1e-3;  // [s]

inline WallRegion free_region() { return {}; }

inline WallRegion aisle(double viscosity = 0.0, bool progressive = false,
                        const Vec2& one_way = Vec2::Zero()) {
  WallRegion out;
  out.kind = RegionKind::kAisle;
  out.viscosity = viscosity;
  out.progressive = progressive;
  out.one_way = one_way;
  return out;
}

inline WallRegion wall(double stiffness = 5000.0, double damping = 0.0) {
  WallRegion out;
  out.kind = RegionKind::kWall;
  out.stiffness = stiffness;
  out.damping = damping;
  return out;
}

// A hand free in `region`.
inline EffectInput at(const Vec2& hand, const WallRegion& region) {
  EffectInput in;
  in.hand = in.proxy = hand;
  in.region = &region;
  in.dt = kTick;
  return in;
}

// A mass on one axis under a force held for a tick, exact in between.
struct Mass {
  double m = 0.5, x = 0.0, v = 0.0;
  void step(double f) {
    x += v * kTick + 0.5 * f / m * kTick * kTick;
    v += f / m * kTick;
  }
  double energy() const { return 0.5 * m * v * v; }
};

}  // namespace handrail::test
