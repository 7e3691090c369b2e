// Colours of a palette as scene files write them, and the sRGB curve.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

namespace handrail {

using Rgb = std::array<std::uint8_t, 3>;  // coded sRGB

inline bool is_transparent(std::string_view text) { return text == "transparent"; }

// "#rrggbb" in either case; "transparent" counts as white. Empty for anything else.
inline std::optional<Rgb> colour_of(std::string_view text) {
  if (is_transparent(text)) return Rgb{255, 255, 255};
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  Rgb out{};
  for (std::size_t i = 0; i < 6; ++i) {
    const char c = text[i + 1];
    const int digit = c >= '0' && c <= '9'   ? c - '0'
                      : c >= 'a' && c <= 'f' ? c - 'a' + 10
                      : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                             : -1;
    if (digit < 0) return std::nullopt;
    std::uint8_t& value = out[i / 2];
    value = static_cast<std::uint8_t>(value * 16 + digit);
  }
  return out;
}

// IEC 61966-2-1: coded value to light and back, both 0 to 1.
inline float light_of(float coded) {
  return coded <= 0.04045f ? coded / 12.92f : std::pow((coded + 0.055f) / 1.055f, 2.4f);
}
inline float coded_of(float light) {
  return light <= 0.0031308f ? light * 12.92f : 1.055f * std::pow(light, 1.0f / 2.4f) - 0.055f;
}

}  // namespace handrail
