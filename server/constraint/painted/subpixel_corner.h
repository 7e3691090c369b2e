// Corners of painted walls: where two surfaces meet, closer than pixels tell.
#pragma once

#include <vector>

#include "server/constraint/painted/subpixel_core.h"
#include "server/constraint/painted/subpixel_patch.h"

namespace handrail {

// Pixels at a corner hold two surfaces, and heights of columns there are of neither. Each surface
// goes on as it came up to where both meet, if that is what the pixels there show: pieces nearer to
// the corner give way to such ones. `patches` and `ends` of the whole map. The pixels that corners
// of free space explain: whatever wall is in them is before one of the pieces.
PixelSet resolve_corners(const CoverageView& view, const std::vector<SurfaceEnd>& ends,
                         std::vector<SurfacePatch>& patches);

}  // namespace handrail
