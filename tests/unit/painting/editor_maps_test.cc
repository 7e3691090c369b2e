// Maps really exported by editors (tests/data/walls/README.md), against what was drawn in them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "server/painting/coverage.h"
#include "tests/support/wall_samples.h"

namespace handrail {
namespace {

constexpr int kSize = 200;                             // pixels of the maps, taken as 0.1 mm
constexpr double kTurn = 17 * std::numbers::pi / 180;  // of the block [rad]
constexpr double kMapPixel = 1e-4;                     // [m]

Vec2 metres(double x, double y) { return Vec2(x - 0.5 * kSize, 0.5 * kSize - y) * kMapPixel; }

// The drawing: wall, in it a free disc, in that a wall turned by 17 degrees.
CoverageMap drawing(double x, double y) {
  const test::Polygon block =
      test::rectangle(metres(105.2, 95.7), 60 * kMapPixel, 30 * kMapPixel, -kTurn);
  const Walls walls = test::WallPainter(kSize, kSize, kMapPixel, false)
                          .open_disc(metres(x, y), 80 * kMapPixel)
                          .wall(block)
                          .finish();
  return *walls.map;
}

struct Boundary {
  double rms = 0.0, worst = 0.0;  // of its place across the edge [pixels]
};

// How far the map's edges lie from those of `exact`: differences of coverage summed over five
// pixels along the row or column that crosses the edge more steeply, times that steepness. Corners,
// where four pixels around hold no straight edge, are left out.
Boundary compare(const CoverageMap& map, const CoverageMap& exact) {
  const auto at = [](const CoverageMap& m, int x, int y) {
    return m.open[static_cast<std::size_t>(y * kSize + x)] / 65535.0;
  };
  const auto near_corner = [](int x, int y) {
    for (const double u : {-30.0, 30.0}) {
      for (const double v : {-15.0, 15.0}) {
        const double c = std::cos(kTurn), s = std::sin(kTurn);
        if (std::hypot(105.2 + c * u - s * v - x - 0.5, 95.7 + s * u + c * v - y - 0.5) < 4) {
          return true;
        }
      }
    }
    return false;
  };
  Boundary out;
  int count = 0;
  for (int y = 4; y < kSize - 4; ++y) {
    for (int x = 4; x < kSize - 4; ++x) {
      const double here = at(exact, x, y);
      if (here < 0.02 || here > 0.98 || near_corner(x, y)) continue;
      double gx = 0.0, gy = 0.0;
      for (const int k : {-1, 0, 1}) {
        gx += at(exact, x + 1, y + k) - at(exact, x - 1, y + k);
        gy += at(exact, x + k, y + 1) - at(exact, x + k, y - 1);
      }
      const bool row = std::abs(gx) > std::abs(gy);
      double off = 0.0;
      for (int k = -2; k <= 2; ++k) {
        const int u = row ? x + k : x, v = row ? y : y + k;
        off += at(map, u, v) - at(exact, u, v);
      }
      off *= std::max(std::abs(gx), std::abs(gy)) / std::hypot(gx, gy);
      out.rms += off * off;
      out.worst = std::max(out.worst, std::abs(off));
      ++count;
    }
  }
  out.rms = std::sqrt(out.rms / std::max(count, 1));
  return out;
}

struct Export {
  const char* file;
  bool transparent;   // paper is the transparent page
  EdgeLaw law;        // of this program and mode
  double x, y;        // centre of its disc: GIMP's ellipses begin on whole pixels
  double rms, worst;  // allowed [pixels]
};

class EditorMaps : public testing::TestWithParam<Export> {
 protected:
  void SetUp() override {
    Result<RgbaImage> image =
        read_png(std::string(HANDRAIL_SOURCE_DIR "/tests/data/walls/") + GetParam().file);
    ASSERT_TRUE(image.is_ok()) << image.message();
    image_ = std::move(*image);
    rules_.palette = {{{240, 224, 192}, false, "paper"}, {{32, 48, 64}, true, "ink"}};
    rules_.transparent = GetParam().transparent ? 0 : -1;
  }
  // Empty when the law does not fit.
  std::optional<Boundary> under(EdgeLaw law) {
    CoverageRules rules = rules_;
    rules.law = law;
    std::vector<std::string> warnings;
    const Result<CoverageMap> map = coverage_of(image_, rules, warnings);
    if (!map) return std::nullopt;
    return compare(*map, drawing(GetParam().x, GetParam().y));
  }
  RgbaImage image_;
  CoverageRules rules_;
};

TEST_P(EditorMaps, AreWhereTheyWereDrawn) {
  const std::optional<Boundary> boundary = under(GetParam().law);
  ASSERT_TRUE(boundary.has_value());
  RecordProperty("rms_px", std::to_string(boundary->rms));
  RecordProperty("worst_px", std::to_string(boundary->worst));
  EXPECT_LE(boundary->rms, GetParam().rms);
  EXPECT_LE(boundary->worst, GetParam().worst);
}

TEST_P(EditorMaps, AreGuessedRight) { EXPECT_EQ(guess_edges(image_, rules_).law, GetParam().law); }

std::string name_of(const testing::TestParamInfo<Export>& export_) {
  std::string name = export_.param.file;
  name.erase(name.find('.'));
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
}

INSTANTIATE_TEST_SUITE_P(
    All, EditorMaps,
    testing::Values(Export{"inkscape.png", false, EdgeLaw::kSrgb, 100.3, 99.6, 0.02, 0.07},
                    Export{"inkscape-alpha.png", true, EdgeLaw::kAlpha, 100.3, 99.6, 0.02, 0.07},
                    Export{"gimp.png", false, EdgeLaw::kLinear, 100, 99, 0.03, 0.08},
                    Export{"gimp-alpha.png", true, EdgeLaw::kAlpha, 100, 99, 0.03, 0.08},
                    Export{"gimp-linear.png", false, EdgeLaw::kLinear, 100, 99, 0.03, 0.08}),
    name_of);

class OpaqueEditorMaps : public EditorMaps {};

TEST_P(OpaqueEditorMaps, ReadUnderTheOtherLawAreRefusedOrOff) {
  const EdgeLaw other = GetParam().law == EdgeLaw::kSrgb ? EdgeLaw::kLinear : EdgeLaw::kSrgb;
  const std::optional<Boundary> right = under(GetParam().law), wrong = under(other);
  ASSERT_TRUE(right.has_value());
  EXPECT_TRUE(!wrong || wrong->rms > 2 * right->rms);
}

INSTANTIATE_TEST_SUITE_P(
    All, OpaqueEditorMaps,
    testing::Values(Export{"inkscape.png", false, EdgeLaw::kSrgb, 100.3, 99.6, 0, 0},
                    Export{"gimp.png", false, EdgeLaw::kLinear, 100, 99, 0, 0},
                    Export{"gimp-linear.png", false, EdgeLaw::kLinear, 100, 99, 0, 0}),
    name_of);

}  // namespace
}  // namespace handrail
