// Pixels of a painted map that have something in common, and sentences about them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/painting/coverage.h"
#include "server/painting/pixel_mix.h"

namespace handrail {

// Pixels of an image that have something in common.
struct PixelCount {
  static constexpr std::size_t kMost = 100'000;  // then whoever counts stops
  std::size_t count = 0, first = 0;
  void add(std::size_t pixel) { first = count++ == 0 || pixel < first ? pixel : first; }
};

// How many of `pixels`, which rise, hang together with `first`, one of them, across corners too;
// counted up to `most`.
std::size_t together(const std::vector<std::size_t>& pixels, int width, std::size_t first,
                     std::size_t most);

// "(3, 4)": column, row.
std::string place_text(std::size_t pixel, int width);

// "pixel (3, 4) of colour #102030 and more, 7 pixels in all,"
std::string pixels_text(const RgbaImage& image, const PixelCount& pixels);

// "40 % 'paper' and 60 % 'ink'": of what is not transparent.
std::string shares_text(const CoverageRules& rules, const Mixture& m);

// "#102030, 40 % 'paper' and 60 % 'ink', off by 3/255"
std::string mixture_text(const CoverageRules& rules, const PixelMixer& mixer, const Mixture& m);

}  // namespace handrail
