#include "server/scene/coverage_text.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "server/scene/field_check.h"

namespace handrail {
namespace {

std::string colour_text(const std::uint8_t* rgba) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", rgba[0], rgba[1], rgba[2]);
  const std::string out = text.data();
  if (rgba[3] == 255) return out;
  return out + " at alpha " + std::to_string(rgba[3]) + "/255";
}

}  // namespace

std::string place_text(std::size_t pixel, int width) {
  const auto w = static_cast<std::size_t>(width);
  std::string out = "(";
  return out.append(std::to_string(pixel % w))
      .append(", ")
      .append(std::to_string(pixel / w))
      .append(")");
}

std::string pixels_text(const RgbaImage& image, const PixelCount& pixels) {
  const std::string one = "pixel " + place_text(pixels.first, image.width) + " of colour " +
                          colour_text(image.rgba.data() + 4 * pixels.first);
  if (pixels.count == 1) return one;
  return one + " and more, " + (pixels.count >= PixelCount::kMost ? "at least " : "") +
         std::to_string(pixels.count) + " pixels in all,";
}

std::string mixture_text(const CoverageRules& rules, const PixelMixer& mixer, const Mixture& m) {
  const auto name = [&](int entry) {
    return "'" + rules.palette[static_cast<std::size_t>(entry)].name + "'";
  };
  const auto part = [&](int entry, float share) {
    return std::to_string(std::lround(100.0f * share)) + " % " + name(entry);
  };
  const bool one = m.a == m.b || m.t < 0.005f || m.t > 0.995f;
  const std::array<std::uint8_t, 4> rgba = mixer.rgba_of(m);
  return colour_text(rgba.data()) + ", " +
         (one ? name(m.t < 0.5f ? m.b : m.a) : part(m.a, m.t) + " and " + part(m.b, 1.0f - m.t)) +
         ", off by " + number_text(std::round(2550.0 * static_cast<double>(m.error)) / 10.0) +
         "/255";
}

}  // namespace handrail
