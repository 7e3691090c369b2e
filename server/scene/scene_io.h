// Reads and validates scene files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "proto/scene.pb.h"
#include "server/base/status.h"
#include "server/model/scene.h"
#include "server/scene/overrides.h"

namespace handrail {

// Extension of scene files, with the dot.
inline constexpr std::string_view kSceneExtension = ".scene";

// Loads one file. Besides the ranges in scene.proto: the name is the file's stem, the rotation is
// one, limits lie within Table 3.1, tools can be anchored and there is at most one of each sort, a
// task's points are at least 1 mm apart, walls name known regions, their image holds the palette's
// colours only and they do not seal the start point, the rig can do what it shall simulate,
// the arm reaches the task's points and the socket.
// Errors are one line with file, line, column, field, value and what was expected. With `raw` the
// message as written is given too. `overrides` are then set in the message and checked as strictly;
// an error about one names it instead of a place in the file.
Result<Scene> load_scene_file(const std::string& path, pb::Scene* raw = nullptr,
                              const std::vector<Override>& overrides = {});

// The same for text in memory, as if read from `path`.
Result<Scene> parse_scene(const std::string& path, std::string_view text, pb::Scene* raw = nullptr,
                          const std::vector<Override>& overrides = {});

}  // namespace handrail
