#include "server/scene/effect_list.h"

#include <algorithm>

namespace handrail {

const char* name_of(EffectKind kind) noexcept {
  switch (kind) {
    case EffectKind::kWall:
      return "wall";
    case EffectKind::kViscous:
      return "viscous";
    case EffectKind::kProgressive:
      return "progressive";
    case EffectKind::kDetent:
      return "detent";
    case EffectKind::kReturn:
      return "return_spring";
    case EffectKind::kCoulomb:
      return "coulomb";
    case EffectKind::kOneWay:
      return "one_way";
    case EffectKind::kDeviceInertia:
      return "device_inertia";
    case EffectKind::kDeviceFriction:
      return "device_friction";
    case EffectKind::kDeviceQuantisation:
      return "device_quantisation";
    case EffectKind::kDeviceForceLimits:
      return "device_force_limits";
    case EffectKind::kCount:
      break;
  }
  return "none";
}

bool is_of_device(EffectKind kind) noexcept { return kind >= EffectKind::kDeviceInertia; }

DeviceEffects device_effects(const std::vector<EffectSpec>& effects) noexcept {
  const auto lists = [&effects](EffectKind kind) {
    return std::any_of(effects.begin(), effects.end(),
                       [kind](const EffectSpec& e) { return e.kind == kind; });
  };
  DeviceEffects out;
  out.inertia = lists(EffectKind::kDeviceInertia);
  out.friction = lists(EffectKind::kDeviceFriction);
  out.quantisation = lists(EffectKind::kDeviceQuantisation);
  out.force_limits = lists(EffectKind::kDeviceForceLimits);
  return out;
}

}  // namespace handrail
