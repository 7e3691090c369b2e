// What must hold of any file that the PNG reader and the painting are given.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "server/painting/coverage.h"

namespace handrail::test {

// The file is refused in one line, or gives an image that is whole, of which a map is made or not.
// What does not hold; empty: all does. `read`: an image came of it.
inline std::string fault_with_png(std::string_view bytes, bool& read) {
  const Result<RgbaImage> image = decode_png(bytes);
  read = image.is_ok();
  if (!image) {
    const bool one_line =
        !image.message().empty() && image.message().find('\n') == std::string::npos;
    return one_line ? "" : "an error is one line: " + image.message();
  }
  const auto side = [](int n) { return n >= 1 && n <= kMostImageSide; };
  if (!side(image->width) || !side(image->height)) return "an image has a size that is allowed";
  const std::size_t pixels =
      static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height);
  if (image->rgba.size() != 4 * pixels) return "an image has all its pixels";
  CoverageRules rules;
  rules.palette = {{{255, 255, 255}, false, "free"},
                   {{0, 0, 0}, true, "wall"},
                   {{128, 128, 128}, false, "aisle"}};
  rules.law = guess_edges(*image, rules).law;
  std::vector<std::string> warnings;
  const Result<CoverageMap> map = coverage_of(*image, rules, warnings);
  if (!map) return map.message().empty() ? "an error says what" : "";
  if (map->open.size() != pixels) return "a map has all its pixels";
  if (*std::max_element(map->region.begin(), map->region.end()) >= 3) return "a region is known";
  if (*std::max_element(map->wall.begin(), map->wall.end()) >= 3) return "a wall is known";
  return "";
}

}  // namespace handrail::test
