// Sentences about the pixels of a painted map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "server/scene/coverage.h"
#include "server/scene/pixel_mix.h"

namespace handrail {

// Pixels of an image that have something in common.
struct PixelCount {
  static constexpr std::size_t kMost = 100'000;  // then whoever counts stops
  std::size_t count = 0, first = 0;
  void add(std::size_t pixel) { first = count++ == 0 || pixel < first ? pixel : first; }
};

// "(3, 4)": column, row.
std::string place_text(std::size_t pixel, int width);

// "pixel (3, 4) of colour #102030 and more, 7 pixels in all,"
std::string pixels_text(const RgbaImage& image, const PixelCount& pixels);

// "#102030, 40 % 'paper' and 60 % 'ink', off by 3/255"
std::string mixture_text(const CoverageRules& rules, const PixelMixer& mixer, const Mixture& m);

}  // namespace handrail
