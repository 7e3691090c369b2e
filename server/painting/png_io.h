// Reads PNG files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/status.h"

namespace handrail {

// A decoded image: four bytes a pixel, row by row from the top. Colours are coded sRGB and not
// multiplied by alpha.
struct RgbaImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

inline constexpr int kMostImageSide = 8000;             // [pixels]
inline constexpr std::size_t kMostPngBytes = 1u << 28;  // above 8000 x 8000 uncompressed

// Decodes a PNG of any colour type, bit depth and interlace. 16 bits a channel are rounded to 8. A
// file whose gamma chunk says other than sRGB, or whose profile says light, is converted; any other
// file's values are taken for sRGB. Errors say what is wrong with the file, without its name.
// Nothing of the image's size is allocated before the size is known to be allowed.
Result<RgbaImage> decode_png(std::string_view bytes);

// The same for a file; errors begin with its path.
Result<RgbaImage> read_png(const std::string& path);

}  // namespace handrail
