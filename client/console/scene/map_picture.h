// The walls of a scene as a picture.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "client/console/scene/map_cells.h"
#include "server/base/status.h"
#include "server/model/walls.h"

namespace handrail {

struct MapPicture {
  std::string png;
  Vec2 size = Vec2::Zero();  // that it shows, about the map's origin [m]
  MapCells cells;            // the same, coarser
};

// A painted map's own file, or drawn shapes in the colours of map_colour, with their rounded
// corners. A file that is gone or too long is an error that names it. Blocks.
Result<MapPicture> map_picture(const Walls& walls);

// What a region's colour in the picture is: the scene's, or where it names none, by its kind.
std::array<std::uint8_t, 3> map_colour(const Walls& walls, std::size_t region);

}  // namespace handrail
