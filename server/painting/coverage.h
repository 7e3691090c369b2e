// From the colours of a painted map to how much of each pixel is free.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/model/walls.h"
#include "server/painting/colour.h"
#include "server/painting/png_io.h"

namespace handrail {

// How the editor mixed the colours of a pixel that an edge crosses, in proportion to area.
enum class EdgeLaw : std::uint8_t {
  kSrgb,    // coded values
  kLinear,  // light
  kAlpha,   // the alpha channel, over the palette's transparent entry; colours as kSrgb
};

struct PaletteEntry {
  Rgb rgb{};
  bool wall = false;
  std::string name;
};

struct CoverageRules {
  std::vector<PaletteEntry> palette;  // 1 to 64, no colour twice
  int transparent = -1;               // entry that alpha 0 means; -1: none
  EdgeLaw law = EdgeLaw::kSrgb;
};

inline constexpr int kLeastImageSide = 100;  // [pixels]

// What of every pixel is free, its region and the wall near it; `pixel` is left alone. A pixel must
// be a palette colour, or within 2/255 of a mixture of two that its 5 x 5 neighbourhood holds; what
// of that lies outside the image may be any, and one of the two need stand nowhere where walls or
// aisles are too thin for it (is_in_thin_strip). Where three colours or more stand within 8 pixels
// it may be a mixture of any three of them, with a warning that names the place, as long as few
// such pixels hang together. Otherwise the error gives colour, position (column, row from 0 at the
// top left), count and the nearest mixture. An error, too, is an aisle so thin that nothing of it
// is left open. Warns of colours that are mixtures of two others beside them.
Result<CoverageMap> coverage_of(const RgbaImage& image, const CoverageRules& rules,
                                std::vector<std::string>& warnings);

// Which law an image was most likely made with, and what it was told from.
struct EdgeGuess {
  EdgeLaw law = EdgeLaw::kSrgb;
  std::string why;
};
EdgeGuess guess_edges(const RgbaImage& image, const CoverageRules& rules);

}  // namespace handrail
