// Where a painted map is too fine for its pixels.
#pragma once

#include <cstddef>

#include "server/scene/walls.h"

namespace handrail {

struct Narrows {
  struct Found {
    std::size_t count = 0;  // pixels
    std::size_t first = 0;  // one of them
  };
  Found aisles;  // free space between walls narrower than two pixels
  Found walls;   // walls between free space thinner than one pixel
};

// From the lengths of a pixel's run along its row and its column, exact for strips at any angle.
// Where only a few such pixels are together they are taken for a sharp corner. All walls count as
// there, whatever the stage.
Narrows narrows_of(const CoverageMap& map);

}  // namespace handrail
