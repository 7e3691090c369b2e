// A scene file's values for people, defaults included.
#pragma once

#include <string>

#include "proto/scene.pb.h"
#include "server/model/scene.h"

namespace handrail {

// One line a value: name, value, unit, and whether it is a default.
std::string scene_text(const pb::Scene& scene);

// The file's values, and those that are chosen by what it holds: the method of its walls.
pb::Scene as_used(const pb::Scene& raw, const Scene& scene);

// The scene with every section that has defaults present, so that JSON shows them too.
pb::Scene with_sections(pb::Scene scene);

}  // namespace handrail
