// What each effect of a scene's rig does to the result, and what it costs.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/lab/scenes/press_course.h"
#include "server/model/scene.h"

namespace handrail {

struct EffectRow {
  std::string left_out;
  PressResult result;  // of the course without it
  double ns = 0.0;     // that it adds to a millisecond of the rig
};

struct EffectRows {
  std::string scene;
  PressResult whole;     // of the course with all effects
  double step_ns = 0.0;  // of a millisecond of the rig, all effects
  std::vector<EffectRow> rows;
};

// Leads the tip over the scene's course once with all effects and once without each in turn, and
// prices them. The figures of a course are the same every time; prices are this machine's. The
// error says that the scene has no arm, or what its arm cannot reach.
Result<EffectRows> effects_in_turn(const Scene& scene, const std::atomic<bool>& cancelled);

std::string effects_json(const EffectRows& rows);
std::string effects_table(const EffectRows& rows);

}  // namespace handrail
