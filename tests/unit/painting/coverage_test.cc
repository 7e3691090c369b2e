#include "server/painting/coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/support/wall_samples.h"

namespace handrail {
namespace {

using Paint = std::function<std::array<double, 4>(int x, int y)>;  // coded, 0 to 255

RgbaImage image_of(const Paint& paint, int size = 100) {
  RgbaImage image;
  image.width = image.height = size;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      for (const double v : paint(x, y)) {
        image.rgba.push_back(static_cast<std::uint8_t>(std::lround(v)));
      }
    }
  }
  return image;
}

using Colour = std::array<double, 4>;
const Colour kInk = {32, 48, 64, 255}, kPaper = {240, 224, 192, 255}, kLane = {200, 40, 120, 255};

CoverageRules rules(EdgeLaw law = EdgeLaw::kSrgb) {
  CoverageRules out;
  out.palette = {{{240, 224, 192}, false, "paper"},
                 {{32, 48, 64}, true, "ink"},
                 {{200, 40, 120}, false, "lane"}};
  out.law = law;
  return out;
}

double coded(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}
double light(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

// Share t of `a`, the rest `b`, blended as the law says.
Colour blend(const Colour& a, const Colour& b, double t, EdgeLaw law) {
  Colour out{};
  for (std::size_t k = 0; k < 4; ++k) {
    if (law == EdgeLaw::kLinear && k < 3) {
      out[k] = 255 * coded(t * light(a[k] / 255) + (1 - t) * light(b[k] / 255));
    } else {
      out[k] = t * a[k] + (1 - t) * b[k];
    }
  }
  return out;
}

// Wall below row 50; row 50 itself is wall to the share (x + 0.5) / 100.
RgbaImage ramp(EdgeLaw law, const Colour& wall = kInk, const Colour& open = kPaper) {
  return image_of([=](int x, int y) {
    return y < 50 ? open : y > 50 ? wall : blend(wall, open, (x + 0.5) / 100, law);
  });
}

CoverageMap map_of(const RgbaImage& image, const CoverageRules& r) {
  std::vector<std::string> warnings;
  const Result<CoverageMap> map = coverage_of(image, r, warnings);
  EXPECT_TRUE(map.is_ok()) << map.message();
  EXPECT_TRUE(warnings.empty());
  return map ? *map : CoverageMap();
}
std::string error_of(const RgbaImage& image, const CoverageRules& r) {
  std::vector<std::string> warnings;
  return coverage_of(image, r, warnings).message();
}

TEST(Coverage, IsTheShareOfThePixelThatIsNotWallUnderEitherLaw) {
  for (const EdgeLaw law : {EdgeLaw::kSrgb, EdgeLaw::kLinear}) {
    const CoverageMap map = map_of(ramp(law), rules(law));
    for (std::size_t x = 0; x < 100; ++x) {
      EXPECT_EQ(map.open[49 * 100 + x], 65535);
      EXPECT_EQ(map.open[51 * 100 + x], 0);
      // Half a step of 255 in the channel that differs most; light is steeper in the dark.
      EXPECT_NEAR(map.open[50 * 100 + x] / 65535.0, 1 - (static_cast<double>(x) + 0.5) / 100,
                  law == EdgeLaw::kSrgb ? 0.003 : 0.006);
      EXPECT_EQ(map.region[50 * 100 + x], x < 50 ? 0 : 1);
    }
  }
}

TEST(Coverage, ComesFromTheAlphaChannelOverTheTransparentColour) {
  CoverageRules r = rules(EdgeLaw::kAlpha);
  r.palette[0].name = "page";
  r.transparent = 0;
  const CoverageMap map = map_of(image_of([](int x, int y) {
                                   Colour c = y < 50 ? Colour{255, 255, 255, 0} : kInk;
                                   if (y == 50) c[3] = 2.55 * x;
                                   return c;
                                 }),
                                 r);
  for (std::size_t x = 0; x < 100; ++x) {
    EXPECT_EQ(map.open[49 * 100 + x], 65535);
    EXPECT_NEAR(map.open[50 * 100 + x] / 65535.0, 1 - static_cast<double>(x) / 100, 0.0021);
    EXPECT_EQ(map.region[50 * 100 + x], x <= 50 ? 0 : 1);
  }
}

TEST(Coverage, ForgivesRoundedColoursWhereAlphaIsLow) {
  CoverageRules r = rules(EdgeLaw::kAlpha);
  r.transparent = 0;
  // 1/255 of ink in an editor that keeps colours multiplied by alpha: nothing left of the colour.
  const auto image = image_of([](int x, int y) {
    if (x == 3 && y == 50) return Colour{0, 0, 0, 1};
    return y <= 50 ? Colour{255, 255, 255, 0} : kInk;
  });
  EXPECT_NEAR(map_of(image, r).open[50 * 100 + 3] / 65535.0, 254.0 / 255, 1e-3);
}

TEST(Coverage, WallsMixedWithWallsAreNoFreeSpace) {
  CoverageRules r = rules();
  r.palette[2].wall = true;
  const CoverageMap map = map_of(ramp(EdgeLaw::kSrgb, kInk, kLane), r);
  for (const std::uint16_t open : map.open) ASSERT_EQ(open, 0);
}

TEST(Coverage, AllowsWhatIsWithinTwoOf255OfAMixtureAndNothingFurther) {
  // Off the line from ink to paper in the channel that the line crosses least.
  const auto with_offset = [](double off) {
    return image_of([=](int x, int y) {
      Colour c = y < 50 ? kPaper : y > 50 ? kInk : blend(kInk, kPaper, 0.5, EdgeLaw::kSrgb);
      if (y == 50 && x == 20) c[2] += off;
      return c;
    });
  };
  EXPECT_EQ(error_of(with_offset(2), rules()), "");
  EXPECT_EQ(error_of(with_offset(-2), rules()), "");
  EXPECT_EQ(error_of(with_offset(3), rules()),
            "pixel (20, 50) of colour #888883 is neither in the palette nor a mixture of two of "
            "its colours around it ('paper', 'ink'); nearest is #898981, 50 % 'paper' and 50 % "
            "'ink', off by 2.5/255");
  EXPECT_NE(error_of(with_offset(-3), rules()), "");
}

TEST(Coverage, CountsWhatIsNotInThePalette) {
  const auto image = image_of([](int x, int y) {
    return x >= 10 && x < 14 && y == 7 ? Colour{255, 0, 0, 255} : kPaper;
  });
  EXPECT_EQ(
      error_of(image, rules()),
      "pixel (10, 7) of colour #ff0000 and more, 4 pixels in all, is neither in the palette "
      "nor a mixture of two of its colours around it ('paper'); nearest is #c82878, 'lane', off "
      "by 120/255; is it blurred, or a speck?");
}

TEST(Coverage, RefusesOtherColoursWhereThreeMeetAndSaysWhatToDo) {
  const auto image = image_of([](int x, int y) {
    if (x == 50 && y == 50) return Colour{144, 112, 112, 255};
    return y > 50 ? kInk : x <= 50 ? kPaper : kLane;
  });
  EXPECT_EQ(error_of(image, rules()),
            "pixel (50, 50) of colour #907070 is neither in the palette nor a mixture of two or "
            "three of its colours around it ('paper', 'ink', 'lane'); nearest is #7d7f79, 45 % "
            "'paper' and 55 % 'ink', off by 18.6/255; where three meet, let edges cross at 20 deg "
            "or more, and let one colour reach under the other");
}

TEST(Coverage, RefusesAMixtureFarFromItsColours) {
  // Half ink, half paper, with ink three pixels away.
  const auto at_distance = [](int rows) {
    return image_of([=](int, int y) {
      return y < 50 ? kPaper : y < 50 + rows ? blend(kInk, kPaper, 0.5, EdgeLaw::kSrgb) : kInk;
    });
  };
  EXPECT_EQ(error_of(at_distance(2), rules()), "");
  // Two rows of 96: at the ends ink may lie beside the image.
  EXPECT_TRUE(error_of(at_distance(3), rules())
                  .starts_with("pixel (2, 50) of colour #888880 and "
                               "more, 192 pixels in all"))
      << error_of(at_distance(3), rules());
}

// A strip of `in` through `around`, `width` pixels wide, turned and off the pixels' grid.
RgbaImage strip(double width, double deg, double off, EdgeLaw law, const Colour& in = kInk,
                const Colour& around = kPaper) {
  const paint::Polygon p =
      paint::rectangle(Vec2(50.3, 50.1 + off), 60.0, width, deg * std::numbers::pi / 180);
  return image_of([=](int x, int y) {
    const double share = paint::polygon_in_square(p, x, y);
    return share == 0.0 ? around : share == 1.0 ? in : blend(in, around, share, law);
  });
}
// All that the strip has of free space, or of wall [pixels].
double area_of(const CoverageMap& map, bool wall) {
  double sum = 0.0;
  for (const std::uint16_t open : map.open) sum += open / 65535.0;
  return wall ? static_cast<double>(map.open.size()) - sum : sum;
}

TEST(Coverage, TakesWallsAndAislesThatFillNoPixelAsTheyAre) {
  for (const EdgeLaw law : {EdgeLaw::kSrgb, EdgeLaw::kLinear}) {
    for (const double deg : {0.0, 9.0, 30.0, 45.0, 71.0, 90.0}) {
      for (const double width : {0.4, 0.8, 1.0, 1.5, 1.9}) {
        for (const double off : {0.0, 0.37}) {
          SCOPED_TRACE(testing::Message() << deg << " deg, " << width << " px, off " << off);
          const CoverageMap wall = map_of(strip(width, deg, off, law), rules(law));
          EXPECT_NEAR(area_of(wall, true), 60.0 * width, 0.02 * 60.0);
          if (width < 1.0) continue;
          const CoverageMap aisle = map_of(strip(width, deg, off, law, kPaper, kInk), rules(law));
          EXPECT_NEAR(area_of(aisle, false), 60.0 * width, 0.02 * 60.0);
        }
      }
    }
  }
}

TEST(Coverage, TakesThinWallsThatCrossAndKnowsWhichWallTheyAre) {
  CoverageRules r = rules();
  r.palette.push_back({{20, 160, 40}, true, "hedge"});
  const Colour hedge = {20, 160, 40, 255};
  const auto image = image_of([&](int x, int y) {
    const bool row = y == 50 || y == 51, column = x == 30 || x == 31;
    const double share = row && column ? 0.64 : row || column ? 0.4 : 0.0;
    return share > 0.0 ? blend(hedge, kPaper, share, EdgeLaw::kSrgb) : kPaper;
  });
  const CoverageMap map = map_of(image, r);
  EXPECT_NEAR(map.open[50 * 100 + 30] / 65535.0, 0.36, 0.004);
  EXPECT_NEAR(map.open[50 * 100 + 60] / 65535.0, 0.6, 0.004);
  EXPECT_EQ(map.wall[50 * 100 + 60], 3);
}

TEST(Coverage, RefusesASpeckOfAWall) {
  const auto image = image_of([](int x, int y) {
    return x / 2 == 20 && y / 2 == 20 ? blend(kInk, kPaper, 0.5, EdgeLaw::kSrgb) : kPaper;
  });
  EXPECT_EQ(error_of(image, rules()),
            "pixel (40, 40) of colour #888880 and more, 4 pixels in all, is neither in the palette "
            "nor a mixture of two of its colours around it ('paper'); nearest is #888880, 50 % "
            "'paper' and 50 % 'ink', off by 0/255; is it blurred, or a speck?");
}

TEST(Coverage, RefusesAThinStripThatNoWallIsPartOf) {
  EXPECT_EQ(error_of(strip(1.5, 30.0, 0.0, EdgeLaw::kSrgb, kInk, kLane), rules()), "");
  EXPECT_NE(error_of(strip(1.5, 30.0, 0.0, EdgeLaw::kSrgb, kLane, kPaper), rules()), "");
}

TEST(Coverage, RefusesAnAisleThatLeavesNothingOpen) {
  const auto image = [](double width) {
    return strip(width, 0.0, -0.1, EdgeLaw::kSrgb, kLane, kInk);
  };
  EXPECT_EQ(error_of(image(1.2), rules()), "");
  EXPECT_EQ(error_of(image(0.8), rules()),
            "'lane' is too narrow to leave anything open: pixel (20, 49) of colour #4f2e50 and "
            "more, 122 pixels in all, are all there is of it, 0.8 pixels wide, expected at least "
            "2");
}

TEST(Coverage, TakesAnEdgeThatRunsAlongTheBorder) {
  // A quarter of the last row is paper; the rest of it lies outside.
  const auto at_row = [](int row) {
    return image_of(
        [=](int, int y) { return y == row ? blend(kPaper, kInk, 0.25, EdgeLaw::kSrgb) : kInk; });
  };
  EXPECT_NEAR(map_of(at_row(99), rules()).open[99 * 100 + 50] / 65535.0, 0.25, 0.003);
  EXPECT_EQ(error_of(at_row(98), rules()), "");
  EXPECT_NE(error_of(at_row(97), rules()), "");
}

TEST(Coverage, RefusesTransparencyThatThePaletteDoesNotName) {
  const auto image = image_of([](int x, int) {
    return x == 5 ? Colour{32, 48, 64, 128} : x == 6 ? Colour{0, 0, 0, 0} : kInk;
  });
  EXPECT_TRUE(error_of(image, rules())
                  .starts_with("pixel (5, 0) of colour #203040 at alpha 128/255 and more, 200 "));
}

TEST(Coverage, WarnsOfAColourThatMayBeAnEdgeBetweenTwoOthers) {
  CoverageRules r;
  r.palette = {{{255, 255, 255}, false, "white"},
               {{0, 0, 0}, true, "black"},
               {{128, 128, 128}, false, "grey"}};
  const auto image = image_of([](int x, int y) {
    const double v = y < 50 ? 255 : y > 50 ? 0 : x < 3 ? 128 : 100;
    return Colour{v, v, v, 255};
  });
  std::vector<std::string> warnings;
  EXPECT_TRUE(coverage_of(image, r, warnings).is_ok());
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0],
            "pixel (0, 50) is 'grey', but its colour is also a mixture of 'white' and 'black' "
            "beside it (3 such pixels): an edge between those may be felt as 'grey'");
  const auto apart = image_of([](int, int y) {
    const double v = y < 40 ? 255 : y > 50 ? 0 : 128;
    return Colour{v, v, v, 255};
  });
  warnings.clear();
  EXPECT_TRUE(coverage_of(apart, r, warnings).is_ok());
  EXPECT_TRUE(warnings.empty());
}

TEST(Coverage, KnowsTheNearestOfSeveralWalls) {
  CoverageRules r = rules();
  r.palette[2].wall = true;
  // Ink to the left of column 40, lane from 60 on, paper between.
  const CoverageMap map =
      map_of(image_of([](int x, int) { return x < 40   ? kInk
                                              : x < 60 ? kPaper
                                                       : kLane; }), r);
  for (const int x : {0, 39, 40, 41, 42}) EXPECT_EQ(map.wall[static_cast<std::size_t>(x)], 1) << x;
  for (const int x : {57, 58, 59, 60}) EXPECT_EQ(map.wall[static_cast<std::size_t>(x)], 2) << x;
}

TEST(Coverage, RefusesMapsBelowAHundredPixels) {
  EXPECT_EQ(error_of(image_of([](int, int) { return kPaper; }, 99), rules()),
            "99 x 99 pixels, expected at least 100 x 100");
}

TEST(GuessEdges, TellsTheLawsApartByTheSpreadOfCoverages) {
  EXPECT_EQ(guess_edges(ramp(EdgeLaw::kSrgb), rules()).law, EdgeLaw::kSrgb);
  EXPECT_EQ(guess_edges(ramp(EdgeLaw::kLinear), rules()).law, EdgeLaw::kLinear);
}

TEST(GuessEdges, TellsTheLawsApartByColoursThatOnlyOneCanMix) {
  // From red to green light is brighter than coded values half way.
  const Colour red = {220, 30, 40, 255}, green = {20, 200, 60, 255};
  CoverageRules r;
  r.palette = {{{220, 30, 40}, true, "red"}, {{20, 200, 60}, false, "green"}};
  EXPECT_EQ(guess_edges(ramp(EdgeLaw::kSrgb, red, green), r).law, EdgeLaw::kSrgb);
  EXPECT_EQ(guess_edges(ramp(EdgeLaw::kLinear, red, green), r).law, EdgeLaw::kLinear);
}

TEST(GuessEdges, FallsBackOnTheUsual) {
  const EdgeGuess crisp =
      guess_edges(image_of([](int, int y) { return y < 50 ? kInk : kPaper; }), rules());
  EXPECT_EQ(crisp.law, EdgeLaw::kSrgb);
  EXPECT_EQ(crisp.why, "as no pixel lies on an edge");
  CoverageRules r = rules();
  r.transparent = 0;
  EXPECT_EQ(guess_edges(ramp(EdgeLaw::kSrgb), r).law, EdgeLaw::kAlpha);
}

}  // namespace
}  // namespace handrail
