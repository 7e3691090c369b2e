#include "server/lab/accuracy/explain.h"

#include <algorithm>

#include "server/lab/accuracy/explain_price.h"

namespace handrail {

Result<Explanation> explain_scene(const Scene& scene, const std::atomic<bool>& cancelled) {
  Explanation out;
  out.scene = scene.name;
  if (scene.walls) {
    out.effects = price_of_walls(scene, cancelled);
    for (int i = 0; i < static_cast<int>(EffectKind::kCount); ++i) {
      const auto kind = static_cast<EffectKind>(i);
      const bool listed = std::any_of(scene.effects.begin(), scene.effects.end(),
                                      [kind](const EffectSpec& e) { return e.kind == kind; });
      if (!listed) out.not_simulated.push_back(name_of(kind));
    }
    out.not_simulated.insert(out.not_simulated.end(),
                             {"backlash and flexibility of the device", "motor dynamics",
                              "robot arm, force sensor and link: none takes part"});
  } else {
    out.effects = price_of_arm(scene, cancelled);
    out.not_simulated = {"dynamics and gravity of the arm", "joint friction and backlash",
                         "contact with a workpiece", "loss and jitter of the link",
                         "walls and the effects of a two-axis scene"};
  }
  if (cancelled) return Status::error("cancelled");
  return out;
}

}  // namespace handrail
