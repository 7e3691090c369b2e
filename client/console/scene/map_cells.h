// The walls of a scene as cells of colour.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/plane.h"

namespace handrail {

// About the map's origin, row by row from the lowest y on, in a row from the lowest x on.
struct MapCells {
  static constexpr int kMost =
      512;  // in a row or a column; coarser than the picture, cheap to send

  int columns = 0, rows = 0;  // 0: there is no map
  Vec2 size = Vec2::Zero();   // of all cells [m]
  std::string rgb;            // three bytes a cell
};

}  // namespace handrail
