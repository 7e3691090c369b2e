// What a page draws of the scenes that are shipped.
#include "client/console/scene/scene_news.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "client/console/scene/map_picture.h"
#include "server/base/units.h"
#include "server/painting/png_io.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

Scene shipped(const std::string& name) {
  auto scene = SceneLibrary().load(name);
  EXPECT_TRUE(scene) << scene.message();
  return *scene;
}

// The picture's colour at a place of the map.
std::array<std::uint8_t, 3> colour_at(const MapPicture& picture, const Vec2& p) {
  const auto image = decode_png(picture.png);
  EXPECT_TRUE(image) << image.message();
  const Vec2 pixel(image->width / picture.size.x(), image->height / picture.size.y());
  const int column = static_cast<int>((p.x() + 0.5 * picture.size.x()) * pixel.x());
  const int row = static_cast<int>((0.5 * picture.size.y() - p.y()) * pixel.y());
  const std::size_t at = 4 * static_cast<std::size_t>(row * image->width + column);
  return {image->rgba[at], image->rgba[at + 1], image->rgba[at + 2]};
}

TEST(SceneNews, AnArmsSceneHasItsChainItsRoomAndItsTask) {
  const pb::SceneNews news = scene_news(shipped("linear-movement"), "", Vec2::Zero());
  EXPECT_EQ(news.kind(), pb::SceneNews::ARM);
  EXPECT_EQ(news.name(), "linear-movement");
  EXPECT_EQ(news.goal_size(), 3);
  EXPECT_EQ(news.rotation_size(), 9);
  EXPECT_GT(news.scale(), 0.0);
  EXPECT_FALSE(news.has_map());
  EXPECT_EQ(news.arm().joint_lower_deg_size(), 6);
  // The chain as the contract has it, with all joints at 0 but J3: the tip straight ahead.
  const pb::ArmShape& arm = news.arm();
  const Vec3 tip(arm.shoulder_x_mm() + arm.forearm_mm() + arm.tip_mm(), 0.0,
                 arm.shoulder_z_mm() + arm.upper_arm_mm() - arm.elbow_x_mm());
  EXPECT_NEAR(tip.x(), 651.0, 1e-9);
  EXPECT_NEAR(tip.z(), 730.0, 1e-9);
}

TEST(SceneNews, EveryShippedSceneCanBeDrawn) {
  int walls = 0, bodies = 0;
  for (const auto& entry : SceneLibrary().list()) {
    const Scene scene = shipped(entry.name);
    const pb::SceneNews news = scene_news(scene, "/scene/map.png", Vec2(0.1, 0.1));
    EXPECT_EQ(news.kind() == pb::SceneNews::WALLS, scene.walls != nullptr) << entry.name;
    EXPECT_EQ(news.has_arm(), scene.walls == nullptr) << entry.name;
    bodies += news.body_size();
    if (!scene.walls) continue;
    ++walls;
    EXPECT_GT(news.map().region_size(), 1) << entry.name;
    EXPECT_GT(news.map().stage_size(), 0) << entry.name;
    const auto picture = map_picture(*scene.walls);
    ASSERT_TRUE(picture) << picture.message();
    const auto image = decode_png(picture->png);
    ASSERT_TRUE(image) << entry.name << ": " << image.message();
    EXPECT_NEAR(picture->size.x() / picture->size.y(), 1.0 * image->width / image->height, 1e-3);
  }
  EXPECT_GT(walls, 1);
  EXPECT_GT(bodies, 0);
}

// Cells from the lowest y on are the picture's colours from the top on, within a cell of an edge.
void expect_cells_like_the_picture(const MapPicture& picture, const std::string& name) {
  const MapCells& cells = picture.cells;
  const auto columns = static_cast<std::size_t>(cells.columns);
  const std::size_t count = columns * static_cast<std::size_t>(cells.rows);
  ASSERT_EQ(cells.rgb.size(), 3 * count) << name;
  ASSERT_GT(count, 100u) << name;
  EXPECT_LE(std::max(cells.columns, cells.rows), MapCells::kMost) << name;
  const auto image = decode_png(picture.png);
  const Vec2 pixel(image->width / picture.size.x(), image->height / picture.size.y());
  std::size_t like = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t across = i % columns, up = i / columns;
    const Vec2 at((static_cast<double>(across) + 0.5) / cells.columns - 0.5,
                  (static_cast<double>(up) + 0.5) / cells.rows - 0.5);
    const Vec2 p = at.cwiseProduct(cells.size);
    const int column = static_cast<int>((p.x() + 0.5 * picture.size.x()) * pixel.x());
    const int row = static_cast<int>((0.5 * picture.size.y() - p.y()) * pixel.y());
    const std::size_t from = 4 * static_cast<std::size_t>(row * image->width + column);
    int off = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      off += std::abs(image->rgba[from + c] - static_cast<std::uint8_t>(cells.rgb[3 * i + c]));
    }
    if (off < 30) ++like;
  }
  EXPECT_GT(like, 0.97 * static_cast<double>(count)) << name;
}

TEST(MapCells, AreThePictureCoarser) {
  int painted = 0, drawn = 0;
  for (const auto& entry : SceneLibrary().list()) {
    const Scene scene = shipped(entry.name);
    if (!scene.walls) continue;
    ++(scene.walls->image.empty() ? drawn : painted);
    const auto picture = map_picture(*scene.walls);
    ASSERT_TRUE(picture) << picture.message();
    expect_cells_like_the_picture(*picture, entry.name);
  }
  EXPECT_GT(painted, 0);
  EXPECT_GT(drawn, 0);
}

TEST(MapPicture, ShowsDrawnShapesWhereTheyAre) {
  Walls walls;
  WallRegion free, aisle, brick;
  aisle.kind = RegionKind::kAisle;
  brick.kind = RegionKind::kWall;
  walls.regions = {free, aisle, brick};
  walls.outside = 2;
  WallShape disc, bar, arc;
  disc.kind = WallShape::Kind::kDisc;
  disc.radius = 0.005;
  disc.centre = Vec2(-0.02, 0.01);
  bar.half = Vec2(0.01, 0.002);
  bar.angle = 90.0 * kDeg;
  bar.region = 1;
  arc.kind = WallShape::Kind::kArc;
  arc.radius = 0.02;
  arc.width = 0.004;
  arc.from = 80.0 * kDeg;
  arc.to = 100.0 * kDeg;
  walls.shapes = {disc, bar, arc};
  const auto picture = map_picture(walls);
  ASSERT_TRUE(picture) << picture.message();
  EXPECT_EQ(colour_at(*picture, Vec2(-0.02, 0.013)), map_colour(walls, 0));
  EXPECT_EQ(colour_at(*picture, Vec2(0.0, 0.009)), map_colour(walls, 1)) << "turned upright";
  EXPECT_EQ(colour_at(*picture, Vec2(0.009, 0.0)), map_colour(walls, 2));
  EXPECT_EQ(colour_at(*picture, Vec2(0.0, 0.021)), map_colour(walls, 0)) << "of the arc";
  EXPECT_EQ(colour_at(*picture, Vec2(0.0, -0.02)), map_colour(walls, 2)) << "not of the arc";
  EXPECT_EQ(colour_at(*picture, Vec2(-0.02, -0.01)), map_colour(walls, 2));
  const std::set<std::array<std::uint8_t, 3>> colours = {map_colour(walls, 0), map_colour(walls, 1),
                                                         map_colour(walls, 2)};
  EXPECT_EQ(colours.size(), 3u);
}

// Where two bars cross, a corner of wall is cut off by an arc that touches both; the wall behind it
// stays.
TEST(MapPicture, ShowsTheRoundedCorners) {
  Walls walls;
  WallRegion aisle, brick;
  aisle.kind = RegionKind::kAisle;
  brick.kind = RegionKind::kWall;
  walls.regions = {aisle, brick};
  walls.outside = 1;
  WallShape across, along;
  across.half = Vec2(0.02, 0.003);
  along.half = Vec2(0.003, 0.02);
  walls.shapes = {across, along};
  // The arc's middle is 2 mm from both bars; its nearest point to the corner lies (1 - 1 / sqrt 2)
  // of that from both.
  const Vec2 in_the_cut = Vec2::Constant(0.003 + 0.3e-3), behind = Vec2::Constant(0.003 + 0.9e-3);
  for (const double fillet : {0.0, 2e-3}) {
    walls.fillet = fillet;
    const auto picture = map_picture(walls);
    ASSERT_TRUE(picture) << picture.message();
    EXPECT_EQ(colour_at(*picture, in_the_cut), map_colour(walls, fillet > 0.0 ? 0 : 1));
    EXPECT_EQ(colour_at(*picture, -in_the_cut), map_colour(walls, fillet > 0.0 ? 0 : 1));
    EXPECT_EQ(colour_at(*picture, behind), map_colour(walls, 1));
    EXPECT_EQ(colour_at(*picture, Vec2(0.01, 0.0)), map_colour(walls, 0));
  }
}

TEST(MapPicture, NamesAPaintedMapThatIsGone) {
  Walls walls;
  walls.image = "/nowhere/walls.png";
  walls.map = std::make_shared<CoverageMap>();
  EXPECT_THAT(map_picture(walls).message(), ::testing::HasSubstr("/nowhere/walls.png"));
}

}  // namespace
}  // namespace handrail
