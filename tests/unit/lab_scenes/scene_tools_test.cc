// What is said, drawn and chosen for scenes.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "server/lab/accuracy/resolve_io.h"
#include "server/lab/scenes/canvas.h"
#include "server/lab/scenes/explain.h"
#include "server/lab/scenes/preview.h"
#include "server/lab/scenes/report_io.h"
#include "server/lab/scenes/view.h"
#include "server/painting/png_io.h"
#include "server/scene/scene_io.h"
#include "server/scene/scene_library.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const std::atomic<bool> kToolsGoOn = false;

// An aisle 60 mm by 10 mm.
const char* const kAisle = R"(name: "aisle"
walls {
  region { name: "free" kind: FREE viscosity_n_s_m: 5 }
  region { name: "wall" kind: WALL }
  shape { rectangle { centre_mm: [0, 0] size_mm: [60, 10] region: "free" } }
}
effect { wall {} }
effect { viscous {} }
effect { device_friction {} }
)";

// The same painted: 80 mm by 40 mm at 0.2 mm a pixel.
std::string painted(const TempFolder& folder, const std::string& size_mm = "80, 40") {
  Canvas map(400, 200, {0, 0, 0});
  for (int y = 75; y < 125; ++y) {
    for (int x = 50; x < 350; ++x) map.set(x, y, {255, 255, 255});
  }
  EXPECT_TRUE(map.write_png(folder.path() + "/aisle.png"));
  return folder.write("painted.scene", R"(name: "painted"
walls {
  image { file: "aisle.png" edges: LINEAR size_mm: [)" +
                                           size_mm + R"(] }
  region { name: "free" colour: "#ffffff" kind: FREE }
  region { name: "wall" colour: "#000000" kind: WALL }
}
effect { wall {} }
)");
}

std::vector<std::string> names_of(const Explanation& explanation, bool rig) {
  std::vector<std::string> out;
  for (const PricedEffect& effect : explanation.effects) {
    if (effect.on_rig == rig) out.push_back(effect.name);
  }
  return out;
}

TEST(ExplainScene, ListsTheEffectsOfAWallSceneWithTheirSideAndNothingElse) {
  const auto scene = parse_scene("aisle.scene", kAisle);
  ASSERT_TRUE(scene) << scene.message();
  const auto said = explain_scene(*scene, kToolsGoOn);
  ASSERT_TRUE(said) << said.message();
  EXPECT_EQ(said->scene, "aisle");
  EXPECT_THAT(names_of(*said, false), ElementsAre("wall", "viscous"));
  EXPECT_THAT(names_of(*said, true), ElementsAre("device_friction"));
  EXPECT_THAT(said->not_simulated, Contains("detent"));
  EXPECT_THAT(said->not_simulated, Contains("device_quantisation"));
  EXPECT_THAT(said->not_simulated, Not(Contains("viscous")));
  for (const PricedEffect& effect : said->effects) EXPECT_GE(effect.ns_per_tick, 0.0);
}

TEST(ExplainScene, SaysWhatTheLinearMovementSimulates) {
  const auto scene = SceneLibrary().load("linear-movement");
  ASSERT_TRUE(scene) << scene.message();
  const auto said = explain_scene(*scene, kToolsGoOn);
  ASSERT_TRUE(said) << said.message();
  EXPECT_THAT(names_of(*said, false), ElementsAre("position_tool", "orientation_tool", "smoother"));
  for (const char* name : {"servo_lag", "encoder_offsets", "sensor_noise", "hand_tremor"}) {
    EXPECT_THAT(names_of(*said, true), Contains(name));
  }
  EXPECT_THAT(said->not_simulated, Contains(HasSubstr("contact")));
}

TEST(ExplainScene, CanBeCancelled) {
  const std::atomic<bool> cancelled = true;
  const auto scene = parse_scene("aisle.scene", kAisle);
  ASSERT_TRUE(scene);
  EXPECT_FALSE(explain_scene(*scene, cancelled));
}

TEST(ScenePreview, ShowsWallsForcesAndTheProxysWay) {
  const auto scene = parse_scene("aisle.scene", kAisle);
  ASSERT_TRUE(scene);
  const auto canvas = preview_scene(*scene);
  ASSERT_TRUE(canvas) << canvas.message();
  EXPECT_EQ(canvas->width(), kPreviewSide);
  // 72 mm by 22 mm with the margin, and the legend below.
  const double per_mm = kPreviewSide / 72.0;
  const int walls_end = static_cast<int>(22.0 * per_mm);
  EXPECT_GT(canvas->height(), walls_end + 20);
  int outside = 0, inside = 0, forces = 0;
  for (int y = 0; y < walls_end; ++y) {
    for (int x = 0; x < canvas->width(); ++x) {
      const Colour c = canvas->at(x, y);
      forces += c == kForceColour;
      if (c != kProxyColour) continue;
      const bool within = std::abs(x / per_mm - 36.0) < 30.3 && std::abs(y / per_mm - 11.0) < 5.3;
      ++(within ? inside : outside);
    }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_EQ(outside, 0);  // the hand goes there, its proxy does not
  EXPECT_GT(forces, 1000);
  EXPECT_GT(canvas->at(canvas->width() / 2 + 40, walls_end - 3)[0], 150);
  EXPECT_LT(canvas->at(canvas->width() / 2 + 40, walls_end - 3)[0], 200);
}

TEST(ScenePreview, IsAPngThatReadsBack) {
  const TempFolder folder;
  const auto scene = load_scene_file(painted(folder));
  ASSERT_TRUE(scene) << scene.message();
  const auto canvas = preview_scene(*scene);
  ASSERT_TRUE(canvas) << canvas.message();
  const std::string file = folder.path() + "/preview.png";
  ASSERT_TRUE(canvas->write_png(file));
  const auto image = read_png(file);
  ASSERT_TRUE(image) << image.message();
  EXPECT_EQ(image->width, 1000);
  EXPECT_EQ(image->height, canvas->height());
  EXPECT_GT(image->height, 500);  // a legend below the walls
  const Colour corner = canvas->at(3, 3);
  EXPECT_EQ(image->rgba[4 * (3 * 1000 + 3)], corner[0]);
  EXPECT_THAT(canvas->write_png("/nowhere/p.png").message(), HasSubstr("/nowhere/p.png"));
}

TEST(ScenePreview, RefusesASceneWithoutWalls) {
  const auto scene = SceneLibrary().load("linear-movement");
  ASSERT_TRUE(scene);
  EXPECT_THAT(preview_scene(*scene).message(), HasSubstr("no walls"));
}

AccuracyRow choice(double worst, double cost) {
  AccuracyRow row;
  row.error = {"um", 0.5 * worst, worst};
  row.cost = {"ns", cost, 2.0 * cost};
  return row;
}

TEST(ResolveScene, ChoosesTheCheapestThatIsAccurateOrTheMostAccurateThatIsCheap) {
  const AccuracyRows rows = {choice(1.0, 90.0), choice(5.0, 40.0), choice(9.0, 60.0),
                             choice(50.0, 10.0)};
  EXPECT_EQ(choose(rows, {10.0, 0.0}), 1);
  EXPECT_EQ(choose(rows, {4.0, 0.0}), 0);
  EXPECT_EQ(choose(rows, {0.5, 0.0}), -1);
  EXPECT_EQ(choose(rows, {0.0, 500.0}), 0);
  EXPECT_EQ(choose(rows, {0.0, 70.0}), 1);
  EXPECT_EQ(choose(rows, {0.0, 10.0}), 3);
  EXPECT_EQ(choose(rows, {0.0, 9.0}), -1);
}

TEST(ResolveScene, CountsWhatAProxyStaysBehind) {
  AccuracyRows rows = {choice(5.0, 90.0), choice(5.0, 40.0)};
  rows[1].whole = {"um", 400.0, 1000.0};
  EXPECT_EQ(choose(rows, {10.0, 0.0}), 0);
  EXPECT_EQ(choose(rows, {1000.0, 0.0}), 1);
  EXPECT_EQ(choose(rows, {0.0, 500.0}), 0);
}

TEST(ResolveScene, UnderstandsWishesWithUnitsOnly) {
  EXPECT_DOUBLE_EQ(accuracy_wish("0.01mm", "")->most_error, 10.0);
  EXPECT_DOUBLE_EQ(accuracy_wish("10um", "")->most_error, 10.0);
  EXPECT_DOUBLE_EQ(accuracy_wish("", "500ns")->most_cost, 500.0);
  EXPECT_DOUBLE_EQ(accuracy_wish("", "0.5us")->most_cost, 500.0);
  for (const char* bad : {"10", "mm", "-1mm", "0mm", "1 mm", "1cm", "nanmm", "infmm", "500ns"}) {
    EXPECT_THAT(accuracy_wish(bad, "").message(), HasSubstr(std::string("--accuracy ") + bad));
  }
  EXPECT_FALSE(accuracy_wish("", ""));
  EXPECT_FALSE(accuracy_wish("1mm", "1ns"));
}

TEST(ResolveScene, WritesACopyOfAPaintedSceneThatLoadsFromElsewhere) {
  const TempFolder folder, elsewhere;
  const std::string file = painted(folder);
  const std::string out = elsewhere.path() + "/fine.scene";
  const auto resolved = resolve_scene(file, {10.0, 0.0}, out, kToolsGoOn);
  ASSERT_TRUE(resolved) << resolved.message();
  const AccuracyRow& row = resolved->rows[static_cast<std::size_t>(resolved->chosen)];
  EXPECT_LE(row.whole_error().worst, 10.0);
  const auto copy = load_scene_file(out);
  ASSERT_TRUE(copy) << copy.message();
  EXPECT_EQ(copy->name, "fine");
  EXPECT_EQ(copy->walls->method, WallMethod::kSubpixel);
  EXPECT_EQ(copy->walls->map->width, 400);
  EXPECT_THAT(resolved->why, HasSubstr("subpixel"));
}

TEST(ResolveScene, WritesSearchRadiusAndMethodWhenTimeIsDear) {
  const TempFolder folder;
  const std::string file = painted(folder), out = folder.path() + "/fast.scene";
  const auto resolved = resolve_scene(file, {1e4, 0.0}, out, kToolsGoOn);
  ASSERT_TRUE(resolved) << resolved.message();
  const AccuracyRow& row = resolved->rows[static_cast<std::size_t>(resolved->chosen)];
  for (const AccuracyRow& other : resolved->rows) {
    EXPECT_LE(row.cost.median, other.cost.median) << other.setting;
  }
  const auto copy = load_scene_file(out);
  ASSERT_TRUE(copy) << copy.message();
  EXPECT_EQ(row.method == "published", copy->walls->method == WallMethod::kPublished);
}

TEST(ResolveScene, MeasuresNoLargerMapsForVeryFineOrCoarsePixels) {
  const TempFolder folder;
  const std::string out = folder.path() + "/copy.scene", other = folder.path() + "/other.scene";
  const auto coarse = resolve_scene(painted(folder, "1600, 800"), {1e6, 0.0}, out, kToolsGoOn);
  ASSERT_TRUE(coarse) << coarse.message();
  const auto fine = resolve_scene(painted(folder, "0.001e3, 0.5e0"), {1e6, 0.0}, out, kToolsGoOn);
  EXPECT_THAT(fine.message(), HasSubstr("size_mm"));  // at least 1 mm
  const auto least = resolve_scene(painted(folder, "2, 1"), {1e6, 0.0}, other, kToolsGoOn);
  ASSERT_TRUE(least) << least.message();
  EXPECT_THAT(coarse->rows[1].setting, HasSubstr("pixel 4 mm, radius 1.5 px"));
  EXPECT_THAT(least->rows[1].setting, HasSubstr("pixel 0.005 mm, radius 1.5 px"));
  // The published error is some share of a pixel, whatever the pixel.
  EXPECT_NEAR(coarse->rows[1].error.rms / 4000.0, 0.3, 0.1);
  EXPECT_NEAR(least->rows[1].error.rms / 5.0, 0.3, 0.1);
  EXPECT_THAT(least->rows[1].note, HasSubstr("0.02 mm"));
}

TEST(ResolveScene, KeepsDrawnWallsExactAndToolsInClosedForm) {
  const TempFolder folder;
  const std::string out = folder.path() + "/copy.scene", other = folder.path() + "/other.scene";
  ASSERT_TRUE(resolve_scene(folder.write("aisle.scene", kAisle), {1.0, 0.0}, out, kToolsGoOn));
  EXPECT_EQ(load_scene_file(out)->walls->method, WallMethod::kExact);
  const auto linear = SceneLibrary().find("published");
  ASSERT_TRUE(linear);
  ASSERT_TRUE(resolve_scene(*linear, {1.0, 0.0}, other, kToolsGoOn));
  EXPECT_FALSE(load_scene_file(other)->guidance.published_method);
}

TEST(ResolveScene, SaysWhatIsNearestWhenNothingMeetsTheWish) {
  const TempFolder folder;
  const std::string out = folder.path() + "/copy.scene";
  const auto none =
      resolve_scene(folder.write("aisle.scene", kAisle), {0.0, 1e-3}, out, kToolsGoOn);
  EXPECT_THAT(none.message(), HasSubstr("nearest is exact"));
  EXPECT_FALSE(std::ifstream(out).good());
}

TEST(ResolveScene, SaysBothErrorsAndWhatTheyAreFrom) {
  const TempFolder folder;
  const auto made =
      resolve_scene(painted(folder), {1e4, 0.0}, folder.path() + "/a.scene", kToolsGoOn);
  ASSERT_TRUE(made) << made.message();
  const AccuracyRow& row = made->rows[static_cast<std::size_t>(made->chosen)];
  char both[200];
  std::snprintf(both, sizeof both,
                "off by %.3g um RMS, %.3g um at worst from the exact one, %.3g um RMS, %.3g um at "
                "worst from the surface",
                row.whole.rms, row.whole.worst, row.error.rms, row.error.worst);
  EXPECT_THAT(made->why, HasSubstr(both));
  EXPECT_THAT(accuracy_table(made->rows), HasSubstr("wall: the error is from the true surface; "));
  AccuracyRows tools = made->rows;
  for (AccuracyRow& r : tools) r.whole = {};
  EXPECT_THAT(accuracy_table(tools), Not(HasSubstr("surface")));
}

TEST(ResolveScene, OverwritesNothing) {
  const TempFolder folder;
  const std::string file = folder.write("aisle.scene", kAisle);
  const std::string mine = folder.write("mine.scene", "mine");
  const std::string link = folder.path() + "/link.scene";
  std::filesystem::create_symlink(folder.path() + "/nowhere.scene", link);
  for (const std::string& out : {mine, link}) {
    EXPECT_EQ(resolve_scene(file, {1.0, 0.0}, out, kToolsGoOn).message(),
              out + ": is there already, expected a new file; remove it or name another");
  }
  std::string text;
  std::ifstream(mine) >> text;
  EXPECT_EQ(text, "mine");
  EXPECT_FALSE(std::filesystem::exists(folder.path() + "/nowhere.scene"));
}

TEST(ResolveScene, RefusesPlacesThatCannotHoldAScene) {
  const TempFolder folder;
  const std::string file = folder.write("aisle.scene", kAisle);
  for (const std::string& out : {folder.path() + "/copy.txt", folder.path() + "/a b.scene", file,
                                 std::string("/nowhere/copy.scene")}) {
    EXPECT_THAT(resolve_scene(file, {1.0, 0.0}, out, kToolsGoOn).message(), HasSubstr(out)) << out;
  }
  EXPECT_FALSE(
      resolve_scene("/nowhere/a.scene", {1.0, 0.0}, folder.path() + "/c.scene", kToolsGoOn));
}

TEST(WallView, HoldsAllShapesAndTheWanderingHandStaysWithin) {
  const auto scene = parse_scene("aisle.scene", kAisle);
  ASSERT_TRUE(scene);
  const View view = view_of(*scene->walls, 1e-3);
  EXPECT_NEAR(view.half().x(), 31e-3, 1e-12);
  EXPECT_NEAR(view.half().y(), 6e-3, 1e-12);
  EXPECT_EQ(wander(*scene->walls, view, 0.0), scene->walls->start);
  for (double t = 0.0; t < 20.0; t += 0.01) {
    const Vec2 p = wander(*scene->walls, view, t) - view.centre();
    ASSERT_LE(std::abs(p.x()), view.half().x());
    ASSERT_LE(std::abs(p.y()), view.half().y());
  }
}

}  // namespace
}  // namespace handrail
