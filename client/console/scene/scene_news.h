// What a page draws of a scene.
#pragma once

#include <string>

#include "proto/console.pb.h"
#include "server/model/scene.h"

namespace handrail {

// Every field but `picture`, which `map_url` is, with the picture's size [m].
pb::SceneNews scene_news(const Scene& scene, const std::string& map_url, const Vec2& map_size);

}  // namespace handrail
