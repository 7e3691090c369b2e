// One pixel as a mixture of palette colours.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/painting/coverage.h"

namespace handrail {

// Shares of palette entries that make up a pixel.
struct Mixture {
  struct Part {
    int entry = -1;      // -1: none
    float share = 0.0f;  // of the pixel; together 1
  };
  std::array<Part, 3> parts{};
  float error = 1e9f;  // largest difference of a channel, of 1

  // What the pixel has of an entry.
  float share_of(int entry) const noexcept {
    float out = 0.0f;
    for (const Part& part : parts) out += part.entry == entry ? part.share : 0.0f;
    return out;
  }
};

// Tells palette colours and their mixtures. Coded values; thread-safe after construction.
class PixelMixer {
 public:
  // Counts as the same colour: 2/255.
  static constexpr float kTolerance = 2.0f / 255.0f + 1e-6f;

  explicit PixelMixer(const CoverageRules& rules);

  // The palette entry of exactly this colour (four bytes); -1: none.
  int entry_of(const std::uint8_t* rgba) const noexcept;
  // The pixel as a mixture of the entries in `near` that is nearest to it. Two entries are tried
  // pairwise; the transparent one mixes through alpha only.
  Mixture mixture_of(const std::uint8_t* rgba, const int* near, int count) const noexcept;
  // The same of two or three of these, for an opaque pixel. Three are tried where their colours
  // span a triangle: then a colour off by kTolerance moves no share by more than an eighth.
  Mixture meeting_of(const std::uint8_t* rgba, const int* near, int count) const noexcept;
  // The same of an entry in `near` and this one, of which one is wall and one is not: what there is
  // to see of a strip too thin for a pixel of its own colour.
  Mixture strip_of(const std::uint8_t* rgba, const int* near, int count, int entry) const noexcept;
  // The mixture's own colour, rounded, and alpha.
  std::array<std::uint8_t, 4> rgba_of(const Mixture& m) const noexcept;
  // Whether entry c is, within tolerance, a mixture of a and b.
  bool is_between(int c, int a, int b) const noexcept;
  // Share of a mixture that is not wall, and the entry that it mostly is.
  float open_of(const Mixture& m) const noexcept;
  int most_of(const Mixture& m) const noexcept;
  // The wall with the largest share; -1: none.
  int wall_of(const Mixture& m) const noexcept;
  // Where it says that some c lies between a and b; most palettes have none.
  bool has_ambiguous_colours() const noexcept { return ambiguous_; }
  bool is_wall(int entry) const noexcept { return wall_[static_cast<std::size_t>(entry)]; }

 private:
  using Colour = std::array<float, 3>;
  struct Fit {
    float t = 0.0f, error = 0.0f;
  };
  // A pixel's colour as coded, and in the space that edges mix in.
  struct PixelColour {
    Colour coded, mixed;
  };
  PixelColour pixel_of(const std::uint8_t* rgba) const noexcept;
  Fit fit(const Colour& coded, const Colour& mixed, int a, int b) const noexcept;
  float largest_difference(const Colour& coded, const Colour& mixed) const noexcept;
  // Of three entries; an error above 1 where the colour lies outside their triangle, or there is
  // hardly one.
  Mixture triangle(const Colour& coded, const Colour& mixed,
                   const std::array<int, 3>& of) const noexcept;
  float mixing(float coded) const noexcept { return linear_ ? light_of(coded) : coded; }

  bool linear_ = false;
  bool ambiguous_ = false;
  int transparent_ = -1;
  std::vector<std::uint32_t> keys_;  // the colours' four bytes
  std::vector<Colour> mixed_;        // in the space that edges mix in
  std::vector<bool> wall_;
  std::array<float, 256> decode_{};  // coded byte to that space
};

}  // namespace handrail
