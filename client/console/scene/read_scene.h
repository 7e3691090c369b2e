// A scene read for the pages.
#pragma once

#include <utility>

#include "client/console/scene/map_picture.h"
#include "server/base/status.h"
#include "server/model/scene.h"

namespace handrail {

struct ReadScene {
  Scene scene;
  MapPicture picture;  // of walls
};

// With the picture of its walls, if it has some. Blocks.
inline Result<ReadScene> with_picture(Scene scene) {
  ReadScene out{std::move(scene), {}};
  if (!out.scene.walls) return out;
  auto picture = map_picture(*out.scene.walls);
  if (!picture) return picture.status();
  out.picture = std::move(*picture);
  return out;
}

}  // namespace handrail
