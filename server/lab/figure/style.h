// Colours, dashes and markers that tell series apart, in grey and to the colour-blind too.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace handrail::figure {

inline constexpr std::string_view kInk = "#222222";
inline constexpr std::string_view kPaleInk = "#5f5f5f";
inline constexpr std::string_view kGrid = "#e2e2e2";

// Every two differ by 9 or more in lightness (CIE L*), which no kind of colour-blindness takes
// away.
inline constexpr std::array<std::string_view, 5> kColours = {"#1f5aa6", "#d4570f", "#5e0f3c",
                                                             "#eaae25", "#3da78f"};

enum class Dash { kSolid, kDashed, kDotted, kDashDot, kLongDash };
enum class Marker { kNone, kCircle, kSquare, kTriangle, kDiamond, kCross };

struct Style {
  std::string_view colour = kColours[0];
  double width = 1.6;  // of the line [px]
  Dash dash = Dash::kSolid;
  Marker marker = Marker::kCircle;
  bool hollow = false;  // markers filled white
};

// The style of series `index`: colour, dash and marker all differ among the first five.
constexpr Style style_of(std::size_t index) {
  constexpr std::size_t n = kColours.size();
  return {.colour = kColours[index % n],
          .dash = static_cast<Dash>(index % n),
          .marker = static_cast<Marker>(1 + index % n)};
}

// For places that have a name.
inline constexpr Style kPlaceStyle = {.colour = kInk, .marker = Marker::kSquare};

// For what was expected or published, beside what was found.
inline constexpr Style kReferenceStyle = {.colour = kInk,
                                          .width = 1.2,
                                          .dash = Dash::kDashed,
                                          .marker = Marker::kDiamond,
                                          .hollow = true};

}  // namespace handrail::figure
