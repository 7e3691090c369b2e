#include "server/model/effect_list.h"

#include <algorithm>

namespace handrail {

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
