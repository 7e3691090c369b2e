#include "server/painting/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "server/base/plain_text.h"
#include "server/painting/coverage_text.h"
#include "server/painting/map_width.h"
#include "server/painting/near_colours.h"
#include "server/painting/pixel_mix.h"
#include "server/painting/wall_near.h"

namespace handrail {
namespace {

constexpr int kReach = 2;  // of the neighbourhood [pixels]
// Where three colours meet, one of them may end in a wedge. In one of 20 deg the first whole pixel
// is sqrt(2) / sin(10 deg) from its tip: a disc of radius sqrt(2) has one wherever it is.
constexpr int kMeetReach = 8;
constexpr int kMostMeeting = 8;            // colours tried there, three by three
constexpr std::size_t kMostTogether = 16;  // such pixels in one place: edges at 20 deg have up to 8

constexpr char kMeetAdvice[] =
    "; where three meet, let edges cross at 20 deg or more, and let one colour reach under the "
    "other";

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
  Status read_mixed(CoverageMap& map, std::vector<std::string>& warnings) const {
    PixelCount bad;
    std::vector<Strip> strips;
    std::vector<std::size_t> meetings;
    for (std::size_t i = 0; i < map.region.size() && bad.count < PixelCount::kMost; ++i) {
      if ((map.region[i] & kMixed) == 0) continue;
      const Found found = mixture_at(map, i);
      if (found.mixture.error > PixelMixer::kTolerance) {
        if (!take_meeting(map, i, meetings)) bad.add(i);
        continue;
      }
      set(map, i, found.mixture);
      if (found.strip >= 0) {
        strips.push_back({i, found.strip, found.mixture.share_of(found.strip)});
      }
    }
    settle(map, strips);
    for (const Strip& strip : strips) {
      if (is_in_thin_strip(map, strip.pixel, mixer_.is_wall(strip.entry))) continue;
      if (!take_meeting(map, strip.pixel, meetings)) bad.add(strip.pixel);
    }
    if (bad.count > 0) return Status::error(bad_text(map, bad));
    std::sort(meetings.begin(), meetings.end());
    if (Status status = check_meetings(map, meetings, warnings); !status) return status;
    return check_open(map, strips);
  }

  // Palette colours that may have been meant as an edge between two others.
  void warn_ambiguous(const CoverageMap& map, std::vector<std::string>& warnings) const {
    if (!mixer_.has_ambiguous_colours()) return;
    std::size_t count = 0, first = 0;
    std::array<int, 3> what{};
    for (std::size_t i = 0; i < map.region.size(); ++i) {
      if ((map.region[i] & kMixed) != 0) continue;
      const NearColours near = near_colours(map, i, kReach);
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
      const Mixture m = mixture_at(map, i).mixture;
      if (m.error > PixelMixer::kTolerance) {
        ++out.bad;
      } else {
        // From the brighter of the two: which way round must not depend on the palette's order.
        const float a = m.parts[0].share, b = m.parts[1].share;
        const bool first = brightness(m.parts[0].entry) >= brightness(m.parts[1].entry);
        const float t = (first ? a : b) / (a + b);
        ++out.seen[std::min<std::size_t>(static_cast<std::size_t>(t * 64.0f), 63)];
      }
    }
    return out;
  }

 private:
  struct Found {
    Mixture mixture;
    int strip = -1;  // the entry that does not stand around the pixel: perhaps a thin strip
  };
  struct Strip {
    std::size_t pixel;
    int entry;
    float share;  // that the pixel has of it
    bool operator<(std::size_t other) const { return pixel < other; }
  };

  const std::uint8_t* pixel(std::size_t i) const { return image_.rgba.data() + 4 * i; }
  const std::string& name(int entry) const {
    return rules_.palette[static_cast<std::size_t>(entry)].name;
  }
  int brightness(int entry) const {
    const Rgb& c = rules_.palette[static_cast<std::size_t>(entry)].rgb;
    return 2 * c[0] + 7 * c[1] + c[2];
  }

  Found mixture_at(const CoverageMap& map, std::size_t i) const {
    const NearColours near = near_colours(map, i, kReach);
    Found out{mixer_.mixture_of(pixel(i), near.entries.data(), near.count)};
    if (out.mixture.error <= PixelMixer::kTolerance) return out;
    if (is_at_border(map, i)) {
      const Mixture any = mixture_of_any(i);
      if (any.error <= PixelMixer::kTolerance) return {any};
    }
    for (int entry = 0; entry < static_cast<int>(rules_.palette.size()); ++entry) {
      const Mixture m = mixer_.strip_of(pixel(i), near.entries.data(), near.count, entry);
      if (m.error <= PixelMixer::kTolerance && m.error < out.mixture.error) out = {m, entry};
    }
    return out;
  }
  void set(CoverageMap& map, std::size_t i, const Mixture& m) const {
    map.open[i] = static_cast<std::uint16_t>(std::lround(65535.0f * mixer_.open_of(m)));
    map.region[i] = static_cast<std::uint8_t>(kMixed | mixer_.most_of(m));
    const int wall = mixer_.wall_of(m);
    if (wall >= 0) map.wall[i] = static_cast<std::uint8_t>(wall);
  }
  // Where three colours or more are near, any two or three of them.
  Mixture meeting_at(const CoverageMap& map, std::size_t i) const {
    const NearColours near = near_colours(map, i, kMeetReach);
    if (near.count < 3 || near.count > kMostMeeting) return {};
    return mixer_.meeting_of(pixel(i), near.entries.data(), near.count);
  }
  bool take_meeting(CoverageMap& map, std::size_t i, std::vector<std::size_t>& meetings) const {
    const Mixture m = meeting_at(map, i);
    if (m.error > PixelMixer::kTolerance) return false;
    set(map, i, m);
    meetings.push_back(i);
    return true;
  }
  // Three colours meet at a point. Along a line they are a blur, a sliver or a seam.
  Status check_meetings(const CoverageMap& map, const std::vector<std::size_t>& meetings,
                        std::vector<std::string>& warnings) const {
    PixelCount all, line;
    for (const std::size_t i : meetings) {
      if (line.count == PixelCount::kMost) break;
      all.add(i);
      if (together(meetings, map.width, i, kMostTogether + 1) > kMostTogether) line.add(i);
    }
    if (line.count > 0) {
      return Status::error(pixels_text(image_, line) +
                           " is a mixture of colours that meet there, " +
                           shares_text(rules_, meeting_at(map, line.first)) + ", but more than " +
                           std::to_string(kMostTogether) + " of them hang together" + kMeetAdvice);
    }
    if (all.count > 0) {
      warnings.push_back(pixels_text(image_, all) + " is a mixture of colours that meet there, " +
                         shares_text(rules_, meeting_at(map, all.first)) +
                         ": the edge there may be felt off by up to a quarter of a pixel");
    }
    return Status::ok();
  }

  // A pixel with little of a strip may be of several: it is of that which most is of beside it.
  void settle(CoverageMap& map, std::vector<Strip>& strips) const {
    const std::vector<Strip> before = strips;
    const auto w = static_cast<std::size_t>(map.width);
    for (Strip& strip : strips) {
      const Strip* most = &strip;
      for (std::size_t row = 0; row <= 2 * kReach; ++row) {
        // Columns wrap at the border, where the neighbour is not asked for much.
        const std::size_t middle = strip.pixel + row * w;
        if (middle < kReach * w + kReach) continue;
        const std::size_t first = middle - kReach * w - kReach;
        for (auto k = std::lower_bound(before.begin(), before.end(), first);
             k != before.end() && k->pixel <= first + 2 * kReach; ++k) {
          if (k->share > most->share) most = &*k;
        }
      }
      if (most->entry == strip.entry) continue;
      const NearColours near = near_colours(map, strip.pixel, kReach);
      const Mixture m =
          mixer_.strip_of(pixel(strip.pixel), near.entries.data(), near.count, most->entry);
      if (m.error > PixelMixer::kTolerance) continue;
      strip.entry = most->entry;
      set(map, strip.pixel, m);
    }
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

  bool is_ambiguous(int c, const NearColours& near, std::array<int, 3>* what) const {
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

  // Refuses an aisle so thin that no pixel is half of it: there would be none.
  Status check_open(const CoverageMap& map, const std::vector<Strip>& strips) const {
    std::array<bool, 64> looked_at{};
    for (const Strip& strip : strips) {
      const auto entry = static_cast<std::size_t>(strip.entry);
      if (mixer_.is_wall(strip.entry) || std::exchange(looked_at[entry], true)) continue;
      const bool open = std::any_of(map.region.begin(), map.region.end(), [&](std::uint8_t region) {
        return (region & ~kMixed) == strip.entry;
      });
      if (open) continue;
      PixelCount all;
      const Strip* most = &strip;
      for (const Strip& other : strips) {
        if (other.entry != strip.entry) continue;
        all.add(other.pixel);
        if (other.share > most->share) most = &other;
      }
      const double width = strip_width(map, most->pixel, false);
      return Status::error("'" + name(strip.entry) + "' is too narrow to leave anything open: " +
                           pixels_text(image_, all) + " are all there is of it, " +
                           number_text(std::round(width * 100.0) / 100.0) +
                           " pixels wide, expected at least 2");
    }
    return Status::ok();
  }

  std::string bad_text(const CoverageMap& map, const PixelCount& bad) const {
    std::string around_it;
    const NearColours near = near_colours(map, bad.first, kReach);
    for (int k = 0; k < near.count; ++k) {
      around_it += (k == 0 ? "'" : ", '") + name(near.entries[static_cast<std::size_t>(k)]) + "'";
    }
    // The nearest of two around it; of any two where hardly any are.
    Mixture nearest = mixer_.mixture_of(pixel(bad.first), near.entries.data(), near.count);
    if (nearest.error > 1.0f) nearest = mixture_of_any(bad.first);
    return pixels_text(image_, bad) + " is neither in the palette nor a mixture of two" +
           (near.count > 2 ? " or three" : "") + " of its colours around it (" +
           (around_it.empty() ? "none" : around_it) + ")" +
           (nearest.error > 1.0f ? "" : "; nearest is " + mixture_text(rules_, mixer_, nearest)) +
           (near.count < 2   ? "; is it blurred, or a speck?"
            : near.count > 2 ? kMeetAdvice
                             : "");
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
  if (Status status = reader.read_mixed(map, warnings); !status) return status;
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
