#include "server/scene/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "server/scene/field_check.h"
#include "server/scene/pixel_mix.h"
#include "server/scene/wall_near.h"

namespace handrail {
namespace {

constexpr std::uint8_t kMixed = 0x80;  // in a region while reading: the pixel is no palette colour
constexpr int kReach = 2;              // of the neighbourhood [pixels]
constexpr std::size_t kMostCounted = 100'000;  // bad pixels; then reading stops

std::string place_text(std::size_t i, int width) {
  const auto w = static_cast<std::size_t>(width);
  std::string out = "(";
  return out.append(std::to_string(i % w)).append(", ").append(std::to_string(i / w)).append(")");
}

std::string colour_text(const std::uint8_t* rgba) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", rgba[0], rgba[1], rgba[2]);
  const std::string out = text.data();
  if (rgba[3] == 255) return out;
  return out + " at alpha " + std::to_string(rgba[3]) + "/255";
}

// The palette entries that stand as such around a pixel.
struct Neighbours {
  std::array<int, 64> entries;
  int count = 0;
};

// Reads an image pixel by pixel against a palette.
class Reader {
 public:
  Reader(const RgbaImage& image, const CoverageRules& rules)
      : image_(image), rules_(rules), mixer_(rules) {}

  // Palette colours as such; everything else is marked.
  void read_plain(CoverageMap& map) const {
    const std::size_t n = map.region.size();
    std::uint32_t last = 0;
    std::uint8_t last_region = kMixed, last_wall = kNoWall;
    std::uint16_t last_open = 0;
    for (std::size_t i = 0; i < n; ++i) {
      std::uint32_t key = 0;
      std::copy_n(pixel(i), 4, reinterpret_cast<std::uint8_t*>(&key));
      if (i == 0 || key != last) {
        last = key;
        const int entry = mixer_.entry_of(pixel(i));
        last_region = entry < 0 ? kMixed : static_cast<std::uint8_t>(entry);
        const bool wall = entry >= 0 && mixer_.is_wall(entry);
        last_open = entry < 0 || wall ? 0 : 65535;
        last_wall = wall ? last_region : kNoWall;
      }
      map.region[i] = last_region;
      map.open[i] = last_open;
      map.wall[i] = last_wall;
    }
  }

  // The pixels marked, from what is around them. Adds to `map` and its regions' marks.
  Status read_mixed(CoverageMap& map) const {
    std::size_t bad = 0, first = 0;
    for (std::size_t i = 0; i < map.region.size() && bad < kMostCounted; ++i) {
      if ((map.region[i] & kMixed) == 0) continue;
      const Mixture m = mixture_at(map, i);
      if (m.error > PixelMixer::kTolerance) {
        if (bad++ == 0) first = i;
        continue;
      }
      map.open[i] = static_cast<std::uint16_t>(std::lround(65535.0f * mixer_.open_of(m)));
      map.region[i] = static_cast<std::uint8_t>(kMixed | mixer_.most_of(m));
      const int wall = mixer_.wall_of(m);
      if (wall >= 0) map.wall[i] = static_cast<std::uint8_t>(wall);
    }
    return bad == 0 ? Status::ok() : Status::error(bad_text(map, first, bad));
  }

  // Palette colours that may have been meant as an edge between two others.
  void warn_ambiguous(const CoverageMap& map, std::vector<std::string>& warnings) const {
    if (!mixer_.has_ambiguous_colours()) return;
    std::size_t count = 0, first = 0;
    std::array<int, 3> what{};
    for (std::size_t i = 0; i < map.region.size(); ++i) {
      if ((map.region[i] & kMixed) != 0) continue;
      const Neighbours near = around(map, i);
      if (near.count < 3 || !is_ambiguous(map.region[i], near, count == 0 ? &what : nullptr)) {
        continue;
      }
      if (count++ == 0) first = i;
    }
    if (count == 0) return;
    warnings.push_back("pixel " + place_text(first, image_.width) + " is '" + name(what[0]) +
                       "', but its colour is also a mixture of '" + name(what[1]) + "' and '" +
                       name(what[2]) + "' beside it (" + std::to_string(count) +
                       (count == 1 ? " such pixel" : " such pixels") +
                       "): an edge between those may be felt as '" + name(what[0]) + "'");
  }

  // How the mixed pixels fit this law: those that do not, and the share that each coverage has.
  struct Trial {
    std::size_t mixed = 0, bad = 0;
    std::array<int, 64> seen{};  // coverages, in 64ths: evenly spread if the law is right
  };
  Trial trial(const CoverageMap& map) const {
    constexpr std::size_t kMost = 50'000;
    Trial out;
    for (std::size_t i = 0; i < map.region.size() && out.mixed < kMost; ++i) {
      if ((map.region[i] & kMixed) == 0) continue;
      ++out.mixed;
      const Mixture m = mixture_at(map, i);
      if (m.error > PixelMixer::kTolerance) {
        ++out.bad;
      } else {
        // From the brighter of the two: which way round must not depend on the palette's order.
        const float t = brightness(m.a) >= brightness(m.b) ? m.t : 1.0f - m.t;
        ++out.seen[std::min<std::size_t>(static_cast<std::size_t>(t * 64.0f), 63)];
      }
    }
    return out;
  }

 private:
  const std::uint8_t* pixel(std::size_t i) const { return image_.rgba.data() + 4 * i; }
  const std::string& name(int entry) const {
    return rules_.palette[static_cast<std::size_t>(entry)].name;
  }
  int brightness(int entry) const {
    const Rgb& c = rules_.palette[static_cast<std::size_t>(entry)].rgb;
    return 2 * c[0] + 7 * c[1] + c[2];
  }

  Neighbours around(const CoverageMap& map, std::size_t i) const {
    const int w = map.width, x = static_cast<int>(i % static_cast<std::size_t>(w)),
              y = static_cast<int>(i / static_cast<std::size_t>(w));
    std::uint64_t present = 0;
    for (int v = std::max(0, y - kReach); v <= std::min(map.height - 1, y + kReach); ++v) {
      const std::uint8_t* row = map.region.data() + std::ptrdiff_t{v} * w;
      for (int u = std::max(0, x - kReach); u <= std::min(w - 1, x + kReach); ++u) {
        if ((row[u] & kMixed) == 0) present |= std::uint64_t{1} << row[u];
      }
    }
    Neighbours out;
    for (; present != 0; present &= present - 1) {
      out.entries[static_cast<std::size_t>(out.count++)] = __builtin_ctzll(present);
    }
    return out;
  }

  Mixture mixture_at(const CoverageMap& map, std::size_t i) const {
    const Neighbours near = around(map, i);
    const Mixture m = mixer_.mixture_of(pixel(i), near.entries.data(), near.count);
    return m.error > PixelMixer::kTolerance && is_at_border(map, i) ? mixture_of_any(i) : m;
  }

  // Any colour may have been drawn beyond the border.
  bool is_at_border(const CoverageMap& map, std::size_t i) const {
    const auto w = static_cast<std::size_t>(map.width), h = static_cast<std::size_t>(map.height);
    const std::size_t x = i % w, y = i / w;
    return std::min({x, y, w - 1 - x, h - 1 - y}) < std::size_t{kReach};
  }
  Mixture mixture_of_any(std::size_t i) const {
    std::array<int, 64> entries;
    std::iota(entries.begin(), entries.end(), 0);
    return mixer_.mixture_of(pixel(i), entries.data(), static_cast<int>(rules_.palette.size()));
  }

  bool is_ambiguous(int c, const Neighbours& near, std::array<int, 3>* what) const {
    for (int i = 0; i < near.count; ++i) {
      for (int k = 0; k < i; ++k) {
        const int a = near.entries[static_cast<std::size_t>(k)];
        const int b = near.entries[static_cast<std::size_t>(i)];
        if (!mixer_.is_between(c, a, b)) continue;
        if (what != nullptr) *what = {c, a, b};
        return true;
      }
    }
    return false;
  }

  std::string bad_text(const CoverageMap& map, std::size_t i, std::size_t count) const {
    std::string around_it;
    const Neighbours near = around(map, i);
    for (int k = 0; k < near.count; ++k) {
      around_it += (k == 0 ? " '" : ", '") + name(near.entries[static_cast<std::size_t>(k)]) + "'";
    }
    const std::string among = count == 1 ? "" : " and more, " + counted(count) + " pixels in all,";
    return "pixel " + place_text(i, image_.width) + " of colour " + colour_text(pixel(i)) + among +
           " is neither in the palette nor a mixture of two of its colours around it (" +
           (around_it.empty() ? "none" : around_it.substr(1)) + ")" +
           (near.count < 2   ? "; is it blurred, or thinner than a pixel?"
            : near.count > 2 ? "; where three meet, let two of them meet along whole pixels"
                             : "");
  }
  static std::string counted(std::size_t n) {
    return (n >= kMostCounted ? "at least " : "") + std::to_string(n);
  }

  const RgbaImage& image_;
  const CoverageRules& rules_;
  PixelMixer mixer_;
};

// How far the centre of a histogram is from its middle. Square roots, so that one long edge along
// the pixels, all of one coverage, does not outweigh the rest.
double unevenness(const std::array<int, 64>& seen) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const double weight = std::sqrt(static_cast<double>(seen[i]));
    sum += weight * (static_cast<double>(i) + 0.5) / 64.0;
    weights += weight;
  }
  return weights > 0.0 ? std::abs(sum / weights - 0.5) : 0.5;
}

CoverageMap empty_map(const RgbaImage& image) {
  CoverageMap map;
  map.width = image.width;
  map.height = image.height;
  const std::size_t n = image.rgba.size() / 4;
  map.open.resize(n);
  map.region.resize(n);
  map.wall.resize(n);
  return map;
}

}  // namespace

Result<CoverageMap> coverage_of(const RgbaImage& image, const CoverageRules& rules,
                                std::vector<std::string>& warnings) {
  if (std::min(image.width, image.height) < kLeastImageSide) {
    return Status::error(std::to_string(image.width) + " x " + std::to_string(image.height) +
                         " pixels, expected at least " + std::to_string(kLeastImageSide) + " x " +
                         std::to_string(kLeastImageSide));
  }
  CoverageMap map = empty_map(image);
  const Reader reader(image, rules);
  reader.read_plain(map);
  reader.warn_ambiguous(map, warnings);
  if (Status status = reader.read_mixed(map); !status) return status;
  for (std::uint8_t& region : map.region) region &= static_cast<std::uint8_t>(~kMixed);
  const auto wall = std::find_if(rules.palette.begin(), rules.palette.end(),
                                 [](const PaletteEntry& entry) { return entry.wall; });
  const auto other =
      static_cast<std::uint8_t>(wall == rules.palette.end() ? 0 : wall - rules.palette.begin());
  spread_walls(other, map);
  return map;
}

EdgeGuess guess_edges(const RgbaImage& image, const CoverageRules& rules) {
  if (rules.transparent >= 0) return {EdgeLaw::kAlpha, "as the palette has a transparent colour"};
  CoverageRules tried = rules;
  CoverageMap map = empty_map(image);
  tried.law = EdgeLaw::kSrgb;
  const Reader srgb(image, tried);
  srgb.read_plain(map);
  const Reader::Trial as_srgb = srgb.trial(map);
  if (as_srgb.mixed == 0) return {EdgeLaw::kSrgb, "as no pixel lies on an edge"};
  CoverageRules other = rules;
  other.law = EdgeLaw::kLinear;
  const Reader::Trial as_linear = Reader(image, other).trial(map);
  const std::string mixed = std::to_string(as_srgb.mixed) + " edge pixels";
  if (as_srgb.bad != as_linear.bad) {
    const bool linear = as_linear.bad < as_srgb.bad;
    return {linear ? EdgeLaw::kLinear : EdgeLaw::kSrgb, "which fits more of the " + mixed};
  }
  constexpr std::ptrdiff_t kFew = 8;  // different coverages: less says nothing
  if (64 - std::count(as_srgb.seen.begin(), as_srgb.seen.end(), 0) < kFew) {
    return {EdgeLaw::kSrgb, "the usual, as " + mixed + " tell nothing"};
  }
  return {unevenness(as_linear.seen) < unevenness(as_srgb.seen) ? EdgeLaw::kLinear : EdgeLaw::kSrgb,
          "which spreads the coverages of " + mixed + " more evenly"};
}

}  // namespace handrail
