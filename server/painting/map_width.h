// Where a painted map is too fine for its pixels.
#pragma once

#include <cstddef>

#include "server/model/walls.h"

namespace handrail {

// How wide the strip of wall, or of free space, that holds a pixel is [pixels]; 1e9 where it does
// not end. From the lengths of its runs along row and column, exact for straight strips at any
// angle.
double strip_width(const CoverageMap& map, std::size_t pixel, bool wall) noexcept;

// Whether the pixel is part of a wall, or of an aisle, so thin that no pixel may be all of it (2.2
// pixels); a speck is none.
bool is_in_thin_strip(const CoverageMap& map, std::size_t pixel, bool wall) noexcept;

struct Narrows {
  struct Found {
    std::size_t count = 0;  // pixels
    std::size_t at = 0;     // where it is narrowest
    double width = 0.0;     // there, the median around it [pixels]
    bool open = false;      // a pixel around it is at least half free
  };
  Found aisles;  // free space between walls narrower than two pixels, where it is half a pixel's
  Found slits;   // free space between walls narrower than one pixel
  Found walls;   // walls between free space thinner than one pixel
};

// Where only a few such pixels are together they are taken for a sharp corner. All walls count as
// there, whatever the stage.
Narrows narrows_of(const CoverageMap& map);

}  // namespace handrail
