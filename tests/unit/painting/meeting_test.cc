// Maps drawn in layers, anti-aliased as a vector editor exports them, where three colours meet.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "server/base/random.h"
#include "server/base/units.h"
#include "server/painting/coverage.h"

namespace handrail {
namespace {

constexpr int kMeetingSize = 120;  // [pixels]
constexpr std::size_t kFine = 16;  // samples along a pixel's side
constexpr std::uint8_t kRoom = 0, kWall = 1, kAisle = 2;

// One shape of the drawing: how far inside it a point is, in pixels from the top left.
struct Layer {
  std::uint8_t entry;
  std::function<double(const Vec2&)> depth;
};

struct Drawing {
  RgbaImage image;
  std::vector<double> open;  // what of each pixel is not wall, by area
};

CoverageRules meeting_rules() {
  CoverageRules out;
  out.palette = {{{240, 224, 192}, false, "room"},
                 {{32, 48, 64}, true, "wall"},
                 {{48, 160, 80}, false, "aisle"}};
  return out;
}

// One pixel, layer by layer. Source: Porter and Duff 1984, over, in 8 bits, as Inkscape's renderer
// does it: where two edges cross a pixel the coverages multiply, whatever the areas.
void draw_pixel(int x, int y, std::uint8_t page, const std::vector<Layer>& layers, Drawing& out) {
  const CoverageRules r = meeting_rules();
  std::array<double, 3> colour;
  for (std::size_t k = 0; k < 3; ++k) colour[k] = r.palette[page].rgb[k];
  std::array<std::uint8_t, kFine * kFine> top;
  top.fill(page);
  for (const Layer& layer : layers) {
    const double depth = layer.depth(Vec2(x + 0.5, y + 0.5));
    if (depth < -0.75) continue;
    int hits = 0;
    for (std::size_t s = 0; s < top.size(); ++s) {
      const std::size_t row = s / kFine, column = s % kFine;
      const Vec2 fine(static_cast<double>(column), static_cast<double>(row));
      if (layer.depth(Vec2(x, y) + (fine + Vec2(0.5, 0.5)) / kFine) < 0.0) continue;
      top[s] = layer.entry;
      ++hits;
    }
    const double alpha = std::round(255.0 * hits / top.size()) / 255.0;
    for (std::size_t k = 0; k < 3; ++k) {
      colour[k] = std::round(alpha * r.palette[layer.entry].rgb[k] + (1.0 - alpha) * colour[k]);
    }
  }
  for (const double c : colour) out.image.rgba.push_back(static_cast<std::uint8_t>(c));
  out.image.rgba.push_back(255);
  const auto walls = std::count(top.begin(), top.end(), kWall);
  out.open.push_back(1.0 - static_cast<double>(walls) / top.size());
}

Drawing draw(std::uint8_t page, const std::vector<Layer>& layers) {
  Drawing out;
  out.image.width = out.image.height = kMeetingSize;
  for (int i = 0; i < kMeetingSize * kMeetingSize; ++i)
    draw_pixel(i % kMeetingSize, i / kMeetingSize, page, layers, out);
  return out;
}

Layer disc(std::uint8_t entry, const Vec2& centre, double radius) {
  return {entry, [=](const Vec2& p) { return radius - (p - centre).norm(); }};
}
// All to the right of a line through `at`.
Layer half(std::uint8_t entry, const Vec2& at, double angle) {
  const Vec2 n(-std::sin(angle), std::cos(angle));
  return {entry, [=](const Vec2& p) { return n.dot(p - at); }};
}
// What is in both.
Layer both(const Layer& a, const Layer& b) {
  return {a.entry, [=](const Vec2& p) { return std::min(a.depth(p), b.depth(p)); }};
}
Layer outside(const Layer& a) {
  return {a.entry, [=](const Vec2& p) { return -a.depth(p); }};
}
// `width` wide, along a line through `at`.
Layer band(std::uint8_t entry, const Vec2& at, double angle, double width) {
  const Vec2 n(-std::sin(angle), std::cos(angle));
  return both(half(entry, at - 0.5 * width * n, angle),
              half(entry, at + 0.5 * width * n, angle + std::numbers::pi));
}

struct Read {
  std::string error;
  std::vector<std::string> warnings;
  double worst = 0.0;  // of the open share, against the areas
};
Read read(const Drawing& drawing) {
  Read out;
  const Result<CoverageMap> map = coverage_of(drawing.image, meeting_rules(), out.warnings);
  out.error = map.message();
  for (std::size_t i = 0; map && i < drawing.open.size(); ++i) {
    out.worst = std::max(out.worst, std::abs(map->open[i] / 65535.0 - drawing.open[i]));
  }
  return out;
}

// A room in the wall, and out of it an aisle along an arc.
Drawing curved_aisle(const Vec2& off) {
  const Vec2 room = Vec2(34.3, 60.1) + off, centre = Vec2(48.2, 104.4) + off;
  const Layer arc = both(disc(kAisle, centre, 58.0), outside(disc(kAisle, centre, 47.5)));
  return draw(kWall, {disc(kRoom, room, 24.0), both(arc, half(kAisle, room, -1.2))});
}

TEST(ThreeColours, OfACurvedAisleAreTakenWithAWarningThatNamesThePlace) {
  Random random(1);
  std::size_t warned = 0;
  for (int i = 0; i < 20; ++i) {
    const Drawing drawing = curved_aisle(Vec2(random.uniform(), random.uniform()));
    const Read map = read(drawing);
    ASSERT_EQ(map.error, "");
    EXPECT_LE(map.worst, 0.27);  // a quarter where edges cross, and two levels of 255
    ASSERT_LE(map.warnings.size(), 1U);
    warned += map.warnings.size();
    EXPECT_EQ(guess_edges(drawing.image, meeting_rules()).law, EdgeLaw::kSrgb);
  }
  EXPECT_GE(warned, 15U);
  const Read map = read(curved_aisle(Vec2::Zero()));
  ASSERT_EQ(map.warnings.size(), 1U);
  EXPECT_EQ(map.warnings[0],
            "pixel (53, 46) of colour #a5c394 and more, 3 pixels in all, is a mixture of colours "
            "that meet there, 61 % 'room', 4 % 'wall' and 35 % 'aisle': the edge there may be felt "
            "off by up to a quarter of a pixel");
}

// Every order of the layers, every place of the crossing in its pixel.
TEST(ThreeColours, AreTakenWhereEdgesCrossAt20DegOrMore) {
  Random random(2);
  for (const double deg : {20.0, 25.0, 30.0, 45.0, 60.0, 90.0, 120.0, 150.0}) {
    for (const auto& entries : {std::array{kWall, kRoom, kAisle}, std::array{kRoom, kWall, kAisle},
                                std::array{kAisle, kRoom, kWall}}) {
      const Vec2 at(60.0 + random.uniform(), 60.0 + random.uniform());
      const double angle = 2.0 * std::numbers::pi * random.uniform();
      const Read map = read(draw(
          entries[0], {half(entries[1], at, angle), half(entries[2], at, angle + deg * kDeg)}));
      EXPECT_EQ(map.error, "") << deg << " deg";
      EXPECT_LE(map.worst, 0.27) << deg << " deg";
    }
  }
}

// Two shapes with a common edge, and the wall under them shines through along it.
TEST(ThreeColours, AlongALineAreRefused) {
  const Vec2 at(60.3, 60.2);
  const double angle = 0.4;
  const std::vector<Layer> seam = {half(kRoom, at, angle),
                                   half(kAisle, at, angle + std::numbers::pi)};
  EXPECT_NE(read(draw(kWall, seam)).error.find("neither in the palette nor a mixture"),
            std::string::npos);
  std::vector<Layer> with_wall = seam;
  with_wall.push_back(band(kWall, at + 6.0 * Vec2(-std::sin(angle), std::cos(angle)), angle, 4.0));
  EXPECT_EQ(read(draw(kWall, with_wall)).error,
            "pixel (0, 34) of colour #319650 and more, 116 pixels in all, is a mixture of colours "
            "that meet there, 1 % 'room', 10 % 'wall' and 89 % 'aisle', but more than 16 of them "
            "hang together; where three meet, let edges cross at 20 deg or more, and let one "
            "colour reach under the other");
  // Drawn as the advice has it, it is taken.
  with_wall[0] = {kRoom, [](const Vec2&) { return 1.0; }};
  EXPECT_EQ(read(draw(kWall, with_wall)).error, "");
}

}  // namespace
}  // namespace handrail
