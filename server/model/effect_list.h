// The effects a scene lists, as data. SI, frame of the scene's walls.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "server/base/plane.h"

namespace handrail {

enum class EffectKind : std::uint8_t {
  kWall,           // spring and damper of the walls (2.1)
  kViscous,        // drag of the regions' viscosity
  kProgressive,    // friction that grows with the angle turned (2.2)
  kDetent,         // places that pull in and lock
  kReturn,         // spring back to a point, outside locks
  kCoulomb,        // dry friction everywhere
  kOneWay,         // motion against a region's direction is held
  kDeviceInertia,  // of the simulated device, like the three that follow
  kDeviceFriction,
  kDeviceQuantisation,
  kDeviceForceLimits,
  kCount,
};

// Most effects a scene can list, and most places of one detent.
inline constexpr int kMostEffects = 16;
inline constexpr int kMostDetents = 16;

// One effect with its parameters; those its kind does not use stay as they are here.
struct EffectSpec {
  EffectKind kind = EffectKind::kWall;
  double coupling = 2500.0;              // viscous, progressive, coulomb [N/m]
  double c = 0.0;                        // progressive: of (2.2) [N s/(m rad)]
  bool clockwise = true;                 // progressive: the way that tightens
  bool published_damper = false;         // wall: that of (2.1) to the letter
  Vec2 at = Vec2::Zero();                // progressive: centre; return: where to [m]
  double stiffness = 100.0;              // return, one-way [N/m]
  double peak = 0.0;                     // detent, return: largest force; coulomb: its force [N]
  double radius = 0.0;                   // detent: of the pull; return: closer counts as home [m]
  std::vector<Vec2> places;              // detent [m]
  std::vector<std::string> place_names;  // detent: one for each
  std::vector<double> radii, peaks;      // detent: of each place; empty: `radius` and `peak` of all
};

// What a scene file calls it. Static storage.
inline const char* name_of(EffectKind kind) noexcept {
  constexpr std::array<const char*, static_cast<std::size_t>(EffectKind::kCount) + 1> kNames = {
      "wall",
      "viscous",
      "progressive",
      "detent",
      "return_spring",
      "coulomb",
      "one_way",
      "device_inertia",
      "device_friction",
      "device_quantisation",
      "device_force_limits",
      "none"};
  return kNames[static_cast<std::size_t>(std::min(kind, EffectKind::kCount))];
}

// True for what the simulated device does, false for what the master's step does.
bool is_of_device(EffectKind kind) noexcept;

// Which of its own effects a simulated device shows.
struct DeviceEffects {
  bool inertia = true;
  bool friction = true;
  bool quantisation = true;
  bool force_limits = true;
};

// Those that `effects` lists.
DeviceEffects device_effects(const std::vector<EffectSpec>& effects) noexcept;

}  // namespace handrail
