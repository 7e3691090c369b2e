#include "server/lab/scenes/explain.h"

#include <algorithm>

#include "server/lab/scenes/explain_price.h"
#include "server/lab/scenes/press_course.h"

namespace handrail {
namespace {

std::vector<std::string> not_on_rig(const Simulate& list) {
  std::vector<std::string> out;
  bool touches = false;
  for (int i = 0; i < static_cast<int>(RigEffectKind::kCount); ++i) {
    const auto kind = static_cast<RigEffectKind>(i);
    const bool listed = std::any_of(list.effects.begin(), list.effects.end(),
                                    [kind](const RigEffectSpec& e) { return kind_of(e) == kind; });
    if (!listed) out.emplace_back(name_of(kind));
    touches = touches || (listed && is_touched(kind));
  }
  if (!touches) out.emplace_back("contact with a workpiece");
  out.insert(out.end(),
             {"mass of arm and tool: impacts do not ring", "friction of the joints",
              "loss and jitter of the link", "walls and the effects of a two-axis scene"});
  return out;
}

}  // namespace

Result<Explanation> explain_scene(const Scene& scene, const std::atomic<bool>& cancelled) {
  Explanation out;
  out.scene = scene.name;
  if (scene.walls) {
    out.effects = price_of_walls(scene, cancelled);
    for (int i = 0; i < static_cast<int>(EffectKind::kCount); ++i) {
      const auto kind = static_cast<EffectKind>(i);
      const bool listed = std::any_of(scene.effects.begin(), scene.effects.end(),
                                      [kind](const EffectSpec& e) { return e.kind == kind; });
      if (!listed) out.not_simulated.emplace_back(name_of(kind));
    }
    out.not_simulated.insert(out.not_simulated.end(),
                             {"backlash and flexibility of the device", "motor dynamics",
                              "robot arm, force sensor and link: none takes part"});
  } else {
    out.effects = price_of_arm(scene, cancelled);
    const Result<RigPrice> rig = price_of_rig(scene, cancelled);
    if (!rig) return rig.status();
    out.effects.insert(out.effects.end(), rig->effects.begin(), rig->effects.end());
    out.not_simulated = not_on_rig(simulated_by(scene));
  }
  if (cancelled) return Status::error("cancelled");
  return out;
}

}  // namespace handrail
