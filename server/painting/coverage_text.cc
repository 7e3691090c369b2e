#include "server/painting/coverage_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

std::string colour_text(const std::uint8_t* rgba) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", rgba[0], rgba[1], rgba[2]);
  std::string out = text.data();
  if (rgba[3] == 255) return out;
  return out + " at alpha " + std::to_string(rgba[3]) + "/255";
}

}  // namespace

std::size_t together(const std::vector<std::size_t>& pixels, int width, std::size_t first,
                     std::size_t most) {
  std::vector<std::size_t> found{first};
  for (std::size_t i = 0; i < found.size() && found.size() < most; ++i) {
    // A row ends where the next begins: what hangs together across the border is counted, too.
    for (const int step : {-width - 1, -width, -width + 1, -1, 1, width - 1, width, width + 1}) {
      const std::size_t k = found[i] + static_cast<std::size_t>(step);
      if (std::binary_search(pixels.begin(), pixels.end(), k) &&
          std::find(found.begin(), found.end(), k) == found.end()) {
        found.push_back(k);
      }
    }
  }
  return std::min(found.size(), most);
}

std::string place_text(std::size_t pixel, int width) {
  const auto w = static_cast<std::size_t>(width);
  std::string out = "(";
  return out.append(std::to_string(pixel % w))
      .append(", ")
      .append(std::to_string(pixel / w))
      .append(")");
}

std::string pixels_text(const RgbaImage& image, const PixelCount& pixels) {
  std::string one = "pixel " + place_text(pixels.first, image.width) + " of colour " +
                    colour_text(image.rgba.data() + 4 * pixels.first);
  if (pixels.count == 1) return one;
  return one + " and more, " + (pixels.count >= PixelCount::kMost ? "at least " : "") +
         std::to_string(pixels.count) + " pixels in all,";
}

std::string shares_text(const CoverageRules& rules, const Mixture& m) {
  const float opaque = 1.0f - (rules.transparent < 0 ? 0.0f : m.share_of(rules.transparent));
  std::vector<Mixture::Part> parts;
  for (const Mixture::Part& part : m.parts) {
    const bool seen = part.entry >= 0 && part.entry != rules.transparent;
    if (seen && part.share >= 0.005f * opaque) parts.push_back(part);
  }
  std::string out;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    out += i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ";
    if (parts.size() > 1) {
      out += std::to_string(std::lround(100.0f * parts[i].share / opaque)) + " % ";
    }
    out += "'" + rules.palette[static_cast<std::size_t>(parts[i].entry)].name + "'";
  }
  return out;
}

std::string mixture_text(const CoverageRules& rules, const PixelMixer& mixer, const Mixture& m) {
  return colour_text(mixer.rgba_of(m).data()) + ", " + shares_text(rules, m) + ", off by " +
         number_text(std::round(2550.0 * static_cast<double>(m.error)) / 10.0) + "/255";
}

}  // namespace handrail
