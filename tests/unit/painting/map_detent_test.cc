// Detents that colours of a painted map ask for.
#include "server/painting/map_detent.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/unit/painting/painted_scene.h"

namespace handrail {
namespace {

// Paper with an ink rim; `lock` where `in_lock` says so, in pixels of 0.2 mm from the top left.
class PaintedDetent : public PaintedScene {
 protected:
  void paint(std::function<bool(int x, int y)> in_lock) {
    png_.pixel = [in_lock](int x, int y) {
      if (std::min({x, y, 119 - x, 99 - y}) < 5) return test::Pixel{32, 48, 64, 255};
      return in_lock(x, y) ? test::Pixel{200, 40, 120, 255} : test::Pixel{240, 224, 192, 255};
    };
  }
  static bool near(int x, int y, double u, double v, double r) {
    return std::hypot(x + 0.5 - u, y + 0.5 - v) < r;
  }
  // A scene whose region 'lock' has such a detent, and such effects.
  Result<Scene> load_with(const std::string& detent, const std::string& effects = kDetent,
                          const std::string& more = "") {
    folder_.write("maps/a.png", test::png_of(png_));
    return load_scene_file(
        folder_.write("a.scene", "name: 'a'\nwalls {\n" + kImage + kPalette +
                                     "region { name: 'lock' kind: AISLE colour: '#c82878'\n" +
                                     detent + "}\n" + more + "}\n" + effects));
  }
  std::string error_with(const std::string& detent, const std::string& effects = kDetent) {
    const std::string text = load_with(detent, effects).message();
    return text.substr(std::min(text.size(), folder_.path().size() + 1));
  }
  static inline const std::string kDetent = "effect { wall {} }\neffect { detent { peak_n: 6 } }\n";
};

TEST_F(PaintedDetent, EveryPatchIsAPlaceAtItsMiddleAsLargeAsItself) {
  paint([](int x, int y) { return near(x, y, 30, 30, 10) || (x >= 70 && x < 80 && y / 20 == 3); });
  const Result<Scene> scene = load_with("detent {}");
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  ASSERT_EQ(scene->effects.size(), 2U);
  const EffectSpec& detent = scene->effects[1];
  ASSERT_EQ(detent.places.size(), 2U);
  EXPECT_LT((detent.places[0] - Vec2(-6e-3, 4e-3)).norm(), 1e-9);
  EXPECT_LT((detent.places[1] - Vec2(3e-3, -4e-3)).norm(), 1e-9);
  EXPECT_EQ(detent.place_names, (std::vector<std::string>{"lock 1", "lock 2"}));
  EXPECT_NEAR(detent.radii[0], 10 * 2e-4, 0.01e-3);
  EXPECT_NEAR(detent.radii[1], std::sqrt(200 / 3.14159265) * 2e-4, 1e-9);
  EXPECT_EQ(detent.peaks, (std::vector<double>{6.0, 6.0}));
  EXPECT_TRUE(scene->walls->warnings.empty()) << scene->walls->warnings.front();
}

TEST_F(PaintedDetent, TakesReachAndStrengthFromTheRegionAndJoinsThePlacesOfTheEffect) {
  paint([](int x, int y) { return near(x, y, 30, 30, 10); });
  const Result<Scene> scene =
      load_with("detent { radius_mm: 3 peak_n: 2 }",
                "effect { detent { place { name: 'far' at_mm: [5, -5] } radius_mm: 1 } }\n");
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  const EffectSpec& detent = scene->effects[0];
  EXPECT_EQ(detent.place_names, (std::vector<std::string>{"far", "lock"}));
  EXPECT_EQ(detent.radii, (std::vector<double>{1e-3, 3e-3}));
  EXPECT_EQ(detent.peaks, (std::vector<double>{4.0, 2.0}));
}

TEST_F(PaintedDetent, IsNotSimulatedUnlessTheSceneListsIt) {
  paint([](int x, int y) { return near(x, y, 30, 30, 10); });
  const Result<Scene> scene = load_with("detent {}", "effect { wall {} }\n");
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  EXPECT_EQ(scene->effects.size(), 1U);
  EXPECT_EQ(scene->walls->warnings,
            (std::vector<std::string>{
                "walls.region[2].detent: not simulated, as no effect is detent {}"}));
}

TEST_F(PaintedDetent, WarnsOfAColourThatPaintsNothing) {
  paint([](int, int) { return false; });
  const Result<Scene> scene = load_with("detent {}");
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  EXPECT_EQ(scene->walls->warnings,
            (std::vector<std::string>{
                "walls.region[2].colour: '#c82878' paints nothing, so there is no 'lock'"}));
  EXPECT_TRUE(scene->effects[1].places.empty());
}

TEST_F(PaintedDetent, WarnsOfAPlaceInAWall) {
  // A horseshoe of lock around ink.
  paint([](int x, int y) { return near(x, y, 60, 50, 20); });
  const auto without = png_.pixel;
  png_.pixel = [without](int x, int y) {
    return near(x, y, 60, 50, 10) ? test::Pixel{32, 48, 64, 255} : without(x, y);
  };
  const Result<Scene> scene =
      load_with("detent { radius_mm: 5 }\n", kDetent, "start_mm: [-8, 0]\n");
  ASSERT_TRUE(scene.is_ok()) << scene.message();
  ASSERT_EQ(scene->walls->warnings.size(), 1U);
  EXPECT_EQ(
      scene->walls->warnings[0],
      "walls.region[2].detent: the middle of the patch 'lock', 0, 0 mm, is in a wall: the hand "
      "is pulled against it");
}

TEST_F(PaintedDetent, SaysWhereAndWhatIsWrong) {
  paint([](int x, int y) { return near(x, y, 30, 30, 10) || near(x, y, 52, 30, 10); });
  const std::string at = "a.scene:7:1: field 'walls.region[2].detent";
  EXPECT_EQ(error_with("detent { peak_n: -3 }"),
            "a.scene:7:10: field 'walls.region[2].detent.peak_n': -3 is outside 0.01 to 50 N");
  EXPECT_EQ(error_with("detent { peak_n: nan }"),
            "a.scene:7:10: field 'walls.region[2].detent.peak_n': nan is not a finite number");
  EXPECT_EQ(error_with("detent { radius_mm: 0.1 }"),
            "a.scene:7:10: field 'walls.region[2].detent.radius_mm': 0.1 is outside 0.2 to 100 mm");
  EXPECT_EQ(error_with("detent { radius_mm: 2.21 }"),
            at + "': the patch 'lock 2' at -1.6, 4 mm is 4.4 mm from 'lock 1', expected at least "
                 "both radii, 2.21 and 2.21 mm");
  EXPECT_EQ(error_with("detent { radius_mm: 2.2 }"), "");
  paint([](int x, int y) { return x == 30 && y == 30; });
  EXPECT_EQ(error_with("detent {}"),
            at + "': the patch 'lock' at -5.9, 3.9 mm is as large as a disc of radius 0.11 mm, "
                 "expected 0.2 to 100 mm, or radius_mm");
  paint([](int x, int y) { return x % 10 < 3 && y == 30; });
  EXPECT_EQ(error_with("detent { radius_mm: 0.2 }",
                       "effect { detent { place { name: 'far' at_mm: "
                       "[5, -5] } radius_mm: 1 } }\n"),
            "");
  paint([](int x, int y) { return x % 6 < 3 && y == 30; });
  EXPECT_EQ(error_with("detent { radius_mm: 0.2 }"),
            at + "': 19 places in all, 19 of them patches of 'lock', expected at most 16");
}

}  // namespace
}  // namespace handrail
