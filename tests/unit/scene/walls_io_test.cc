#include "server/scene/walls_io.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "server/base/units.h"
#include "server/scene/scene_io.h"
#include "tests/unit/painting/painted_scene.h"

namespace handrail {
namespace {

const std::string kRegions =
    "region { name: 'road' kind: FREE viscosity_n_s_m: 3 }\n"
    "region { name: 'lane' kind: AISLE one_way: [3, 4] progressive: true }\n"
    "region { name: 'rim' kind: WALL stiffness_n_mm: 8 damping_n_s_mm: 0.002 }\n";
const std::string kSquare =
    "shape { rectangle { centre_mm: [0, 0] size_mm: [40, 20] angle_deg: 90 region: 'road' } }\n";

std::string walls_error_of(const std::string& walls) {
  return parse_scene("/x/a.scene", "name: 'a'\nwalls {\n" + walls + "}\n").message();
}
Walls walls_of(const std::string& text) {
  const Result<Scene> scene = parse_scene("/x/a.scene", "name: 'a'\nwalls {\n" + text + "}\n");
  EXPECT_TRUE(scene.is_ok()) << scene.message();
  return scene && scene->walls ? *scene->walls : Walls();
}

TEST(WallsIo, ASceneWithoutWallsHasNone) {
  const Result<Scene> scene = parse_scene("/x/a.scene", "name: 'a'");
  ASSERT_TRUE(scene.is_ok());
  EXPECT_EQ(scene->walls, nullptr);
}

TEST(WallsIo, ReadsRegionsInSi) {
  const Walls walls = walls_of(kRegions + kSquare);
  ASSERT_EQ(walls.regions.size(), 3U);
  EXPECT_EQ(walls.regions[0].kind, RegionKind::kFree);
  EXPECT_DOUBLE_EQ(walls.regions[0].viscosity, 3.0);
  EXPECT_EQ(walls.regions[1].kind, RegionKind::kAisle);
  EXPECT_TRUE(walls.regions[1].one_way.isApprox(Vec2(0.6, 0.8)));
  EXPECT_TRUE(walls.regions[1].progressive);
  EXPECT_EQ(walls.regions[2].kind, RegionKind::kWall);
  EXPECT_DOUBLE_EQ(walls.regions[2].stiffness, 8000.0);
  EXPECT_DOUBLE_EQ(walls.regions[2].damping, 2.0);
}

TEST(WallsIo, ReadsShapesInSi) {
  const Walls walls = walls_of(
      kRegions + kSquare +
      "shape { disc { centre_mm: [0, 20] radius_mm: 5 region: 'lane' } }\n"
      "shape { arc { centre_mm: [0, 40] radius_mm: 15 width_mm: 6 from_deg: -90 to_deg: 90\n"
      "region: 'lane' } }\nfillet_mm: 1.5 start_mm: [2, -3]\n");
  EXPECT_EQ(walls.method, WallMethod::kExact);
  ASSERT_EQ(walls.shapes.size(), 3U);
  EXPECT_EQ(walls.shapes[0].kind, WallShape::Kind::kRectangle);
  EXPECT_TRUE(walls.shapes[0].half.isApprox(Vec2(0.02, 0.01)));
  EXPECT_DOUBLE_EQ(walls.shapes[0].angle, 90 * kDeg);
  EXPECT_EQ(walls.shapes[0].region, 0);
  EXPECT_EQ(walls.shapes[1].kind, WallShape::Kind::kDisc);
  EXPECT_DOUBLE_EQ(walls.shapes[1].radius, 0.005);
  EXPECT_EQ(walls.shapes[2].kind, WallShape::Kind::kArc);
  EXPECT_DOUBLE_EQ(walls.shapes[2].radius, 0.015);
  EXPECT_DOUBLE_EQ(walls.shapes[2].width, 0.006);
  EXPECT_DOUBLE_EQ(walls.shapes[2].to, 90 * kDeg);
  EXPECT_EQ(walls.shapes[2].region, 1);
  EXPECT_DOUBLE_EQ(walls.fillet, 0.0015);
  EXPECT_EQ(walls.outside, 2);
  EXPECT_TRUE(walls.start.isApprox(Vec2(0.002, -0.003)));
}

TEST(WallsIo, AlwaysHasAStageToBeginWith) {
  const Walls walls = walls_of(kRegions + kSquare);
  ASSERT_EQ(walls.stages.size(), 1U);
  EXPECT_EQ(walls.stages[0].pose.p, Vec2::Zero());
  EXPECT_TRUE(walls.stages[0].gone.empty());
}

TEST(WallsIo, ReadsStages) {
  const Walls walls =
      walls_of(kRegions + kSquare +
               "stage { name: 'one' }\n"
               "stage { name: 'two' at_mm: [10, -5] turn_deg: 30 without: 'rim' }\n");
  ASSERT_EQ(walls.stages.size(), 2U);
  EXPECT_EQ(walls.stages[1].name, "two");
  EXPECT_TRUE(walls.stages[1].pose.p.isApprox(Vec2(0.01, -0.005)));
  EXPECT_DOUBLE_EQ(walls.stages[1].pose.angle, 30 * kDeg);
  EXPECT_EQ(walls.stages[1].gone, std::vector<std::uint8_t>{2});
}

TEST(WallsIo, SaysWhereAndWhatIsWrongWithRegions) {
  const std::string wall = "region { name: 'w' kind: WALL }\n";
  EXPECT_EQ(walls_error_of("region { name: 'w' kind: WALL }\nregion { name: 'w' kind: FREE }\n" +
                           kSquare),
            "/x/a.scene:4:10: field 'walls.region[1].name': a second region 'w'");
  EXPECT_EQ(walls_error_of("region { name: 'f' kind: FREE stiffness_n_mm: 2 }\n" + wall + kSquare),
            "/x/a.scene:3:31: field 'walls.region[0].stiffness_n_mm': has no meaning for FREE");
  EXPECT_EQ(walls_error_of("region { name: 'f' kind: FREE colour: '#12345g' }\n" + wall + kSquare),
            "/x/a.scene:3:31: field 'walls.region[0].colour': '#12345g', expected \"#rrggbb\" or "
            "\"transparent\"");
  EXPECT_EQ(walls_error_of("region { name: 'road' kind: FREE colour: '#aabbcc' }\n"
                           "region { name: 'w' kind: WALL colour: '#AABBCC' }\n" +
                           kSquare),
            "/x/a.scene:4:31: field 'walls.region[1].colour': '#AABBCC' is the colour of 'road' "
            "already, expected each colour once");
  EXPECT_EQ(
      walls_error_of("region { name: 'lane' kind: AISLE one_way: [0, 0] }\n" + wall + kSquare),
      "/x/a.scene:3:35: field 'walls.region[0].one_way': has no direction");
  EXPECT_EQ(walls_error_of("region { name: 'w' kind: WALL stiffness_n_mm: 51 }\n" + kSquare),
            "/x/a.scene:3:31: field 'walls.region[0].stiffness_n_mm': 51 is outside 0.01 to 50 "
            "N/mm");
}

TEST(WallsIo, ADetentIsNothingForAWallOrADrawnRegion) {
  EXPECT_EQ(walls_error_of("region { name: 'w' kind: WALL detent {} }\n" + kSquare),
            "/x/a.scene:3:31: field 'walls.region[0].detent': has no meaning for WALL");
  EXPECT_EQ(walls_error_of("region { name: 'w' kind: WALL }\n"
                           "region { name: 'road' kind: FREE detent {} }\n" +
                           kSquare),
            "/x/a.scene:4:34: field 'walls.region[1].detent': only used with an image; effect { "
            "detent } takes places as well");
}

TEST(WallsIo, SaysWhereAndWhatIsWrongWithShapes) {
  const auto error = [](const std::string& text) { return walls_error_of(kRegions + text); };
  EXPECT_EQ(error(""),
            "/x/a.scene:2:1: field 'walls': has neither image nor shape, expected one "
            "of them");
  EXPECT_EQ(error("shape { disc { centre_mm: [0, 0] radius_mm: 5 region: 'laen' } }"),
            "/x/a.scene:6:47: field 'walls.shape[0].disc.region': no region 'laen'; did you mean "
            "'lane'?");
  EXPECT_EQ(error("shape { disc { centre_mm: [0, 0] radius_mm: 5 region: 'rim' } }"),
            "/x/a.scene:6:47: field 'walls.shape[0].disc.region': 'rim' is a WALL, but shapes are "
            "free space");
  EXPECT_EQ(error("shape { }"),
            "/x/a.scene:6:1: field 'walls.shape[0]': expected exactly one of rectangle, disc and "
            "arc");
  const std::string arc = "shape { arc { centre_mm: [0, 0] radius_mm: 5 region: 'road' ";
  EXPECT_EQ(error(arc + "width_mm: 10.5 from_deg: 0 to_deg: 90 } }"),
            "/x/a.scene:6:61: field 'walls.shape[0].arc.width_mm': 10.5 mm is more than twice the "
            "radius of 5 mm");
  EXPECT_EQ(error(arc + "width_mm: 2 from_deg: 90 to_deg: 0 } }"),
            "/x/a.scene:6:86: field 'walls.shape[0].arc.to_deg': 0 deg is -90 deg from from_deg, "
            "expected above 0 to 360");
  EXPECT_EQ(error(arc + "width_mm: 2 from_deg: -10 to_deg: 351 } }"),
            "/x/a.scene:6:87: field 'walls.shape[0].arc.to_deg': 351 deg is 361 deg from from_deg, "
            "expected above 0 to 360");
  EXPECT_EQ(error(kSquare + "method: SUBPIXEL"),
            "/x/a.scene:7:1: field 'walls.method': SUBPIXEL needs an image; shapes are felt EXACT");
  EXPECT_EQ(error(kSquare + "search_radius_px: 2"),
            "/x/a.scene:7:1: field 'walls.search_radius_px': only used with method: PUBLISHED");
  EXPECT_EQ(error(kSquare + "outside: 'road'"),
            "/x/a.scene:7:1: field 'walls.outside': 'road' is not a WALL");
  EXPECT_EQ(error("region { name: 'other' kind: WALL }\n" + kSquare),
            "/x/a.scene:2:1: field 'walls.outside': missing, but there are several WALL regions");
}

TEST(WallsIo, SaysWhereAndWhatIsWrongWithStages) {
  const auto error = [](const std::string& text) {
    return walls_error_of(kRegions + kSquare + text);
  };
  EXPECT_EQ(error("stage { name: 'a' }\nstage { name: 'a' }"),
            "/x/a.scene:8:9: field 'walls.stage[1].name': a second stage 'a'");
  EXPECT_EQ(error("stage { name: 'a' without: ['rim', 'road'] }"),
            "/x/a.scene:7:19: field 'walls.stage[0].without[1]': 'road' is not a WALL");
}

TEST(WallsIo, ShapesThatShareASideHangTogether) {
  const auto beside = [](const std::string& x) {
    return walls_error_of(kRegions + kSquare + "shape { rectangle { centre_mm: [" + x +
                          ", 3] size_mm: [0.3, 9] region: 'lane' } }\n");
  };
  EXPECT_EQ(beside("10.15"), "");
  EXPECT_NE(beside("10.151"), "");
}

TEST(WallsIo, RefusesShapesThatTheHandCannotReach) {
  EXPECT_EQ(walls_error_of(kRegions + kSquare + "start_mm: [0, 21]\n"),
            "/x/a.scene:7:1: field 'walls.start_mm': the start 0, 21 mm is inside the wall, "
            "expected it in a shape");
  EXPECT_EQ(
      walls_error_of(kRegions + kSquare +
                     "shape { disc { centre_mm: [20, 0] radius_mm: 9.99 region: 'lane' } }\n"),
      "/x/a.scene:7:1: field 'walls.shape[1]': cannot be reached from the start, the wall "
      "seals it off");
}

TEST_F(PaintedScene, IsReadFromTheFolderOfTheScene) {
  const Result<Scene> scene = load();
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  const Walls& walls = *scene->walls;
  EXPECT_EQ(walls.method, WallMethod::kSubpixel);
  EXPECT_EQ(walls.image, folder_.path() + "/maps/a.png");
  ASSERT_NE(walls.map, nullptr);
  EXPECT_EQ(walls.map->width, 120);
  EXPECT_EQ(walls.map->height, 100);
  EXPECT_DOUBLE_EQ(walls.map->pixel, 2e-4);
  EXPECT_EQ(walls.map->open[59 * 120], 65535);
  EXPECT_EQ(walls.map->open[60 * 120], 0);
  EXPECT_EQ(walls.map->region[60 * 120], 1);
  EXPECT_EQ(walls.map->wall[59 * 120], 1);
  EXPECT_TRUE(walls.warnings.empty());
}

TEST_F(PaintedScene, WarnsOfAGuessWhereEdgesAreNotGiven) {
  const Result<Scene> scene = load("", "image { file: 'maps/a.png' size_mm: [24, 20] }\n");
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  ASSERT_FALSE(warnings_of(*scene).empty());
  EXPECT_EQ(warnings_of(*scene)[0],
            "walls.image.edges: not given, guessed SRGB, as no pixel lies on an edge");
}

TEST_F(PaintedScene, WarnsWhereThreeColoursMeetAndNamesThePlace) {
  png_.pixel = [](int x, int y) {
    if (x == 60 && y == 60) return test::Pixel{126, 90, 110, 255};
    return y >= 60  ? test::Pixel{32, 48, 64, 255}
           : x < 60 ? test::Pixel{240, 224, 192, 255}
                    : test::Pixel{200, 40, 120, 255};
  };
  const Result<Scene> scene = load("region { name: 'lane' kind: AISLE colour: '#c82878' }\n");
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  const std::vector<std::string> warnings = warnings_of(*scene);
  EXPECT_EQ(std::count(warnings.begin(), warnings.end(),
                       "walls.image.file: pixel (60, 60) of colour #7e5a6e is a mixture of colours "
                       "that meet there, 25 % 'paper', 50 % 'ink' and 25 % 'lane': the edge there "
                       "may be felt off by up to a quarter of a pixel"),
            1);
}

TEST_F(PaintedScene, SaysWhatIsWrongWithTheImage) {
  const std::string at = "a.scene:3:9: field 'walls.image.file': maps/a.png: ";
  png_.pixel = [](int x, int) {
    return x == 7 ? test::Pixel{255, 0, 0, 255} : test::Pixel{240, 224, 192, 255};
  };
  EXPECT_EQ(error_of(), at + "pixel (7, 0) of colour #ff0000 and more, 100 pixels in all, is "
                             "neither in the palette nor a mixture of two of its colours around it "
                             "('paper'); nearest is #646a6a, 33 % 'paper' and 67 % 'ink', off by "
                             "154.7/255; is it blurred, or a speck?");
  png_.width = 8001;
  EXPECT_EQ(error_of(), at + "8001 x 100 pixels, expected at most 8000 x 8000");
  EXPECT_EQ(error_of("", "image { file: 'b.png' size_mm: [24, 20] edges: SRGB }\n"),
            "a.scene:3:9: field 'walls.image.file': b.png: cannot open: No such file or directory");
}

TEST_F(PaintedScene, SaysWhatIsWrongWithTheSceneAboutTheImage) {
  const auto image = [](const std::string& rest) {
    return "image { file: 'maps/a.png' " + rest + " }\n";
  };
  EXPECT_EQ(error_of("", image("size_mm: [24, 24] edges: SRGB")),
            "a.scene:3:28: field 'walls.image.size_mm': 24 x 24 mm on 120 x 100 pixels, expected "
            "square pixels");
  EXPECT_EQ(error_of("", image("size_mm: [24, 20] edges: ALPHA")),
            "a.scene:3:46: field 'walls.image.edges': ALPHA needs a region with colour "
            "\"transparent\"");
  EXPECT_EQ(error_of("region { name: 'lane' kind: AISLE }\n"),
            "a.scene:6:1: field 'walls.region[2].colour': missing, but a painted map needs a "
            "colour for every region");
  EXPECT_EQ(error_of(kSquare),
            "a.scene:2:1: field 'walls': has both image and shapes, expected "
            "one of them");
  EXPECT_EQ(error_of("method: EXACT\n"),
            "a.scene:6:1: field 'walls.method': EXACT needs shapes, not an image");
  EXPECT_EQ(error_of("fillet_mm: 1\n"),
            "a.scene:6:1: field 'walls.fillet_mm': only used with shapes");
  EXPECT_EQ(error_of("start_mm: [0, -5]\n"),
            "a.scene:6:1: field 'walls.start_mm': the start 0, -5 mm is inside the wall 'ink', "
            "pixel (60, 75)");
}

TEST_F(PaintedScene, OverridesReachTheWalls) {
  const Result<Scene> scene = load("", kImage, {{"walls.method", "PUBLISHED"}});
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  EXPECT_EQ(scene->walls->method, WallMethod::kPublished);
  ASSERT_NE(scene->walls->map, nullptr);
}

}  // namespace
}  // namespace handrail
