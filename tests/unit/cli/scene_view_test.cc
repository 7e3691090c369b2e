#include "client/cli/scene_view.h"

#include <gmock/gmock.h>

#include <memory>
#include <sstream>

#include "server/scene/json_io.h"
#include "server/scene/scene_io.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const char kShapes[] = R"(name: "a"
walls {
  region { name: "free" kind: FREE viscosity_n_s_m: 5 }
  region { name: "wall" kind: WALL }
  shape { rectangle { centre_mm: [0, 0] size_mm: [60, 10] region: "free" } }
}
effect { wall {} }
effect { viscous {} }
effect { detent { place { name: "1" at_mm: [3, 0] } radius_mm: 2 peak_n: 4 } }
effect { device_inertia {} }
)";

struct Shown {
  pb::Scene raw;
  Scene scene;
};
Shown shown(const std::string& text) {
  Shown out;
  const Result<Scene> scene = parse_scene("a.scene", text, &out.raw);
  EXPECT_TRUE(scene.is_ok()) << scene.message();
  if (scene) out.scene = *scene;
  return out;
}
// Name and what follows it up to the line's end, without blanks; "-" when there is no such line.
std::string value_of(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string first, rest, word;
    words >> first;
    if (first != name) continue;
    while (words >> word) rest += (rest.empty() ? "" : " ") + word;
    return rest;
  }
  return "-";
}

TEST(SceneView, NamesTheMethodThatIsUsedNotTheFirstOfItsKind) {
  const Shown s = shown(kShapes);
  ASSERT_FALSE(s.raw.walls().has_method());
  EXPECT_EQ(value_of(scene_text(as_used(s.raw, s.scene)), "walls.method"), "EXACT");
  EXPECT_THAT(json_text(with_sections(as_used(s.raw, s.scene)), false),
              HasSubstr("\"method\":\"EXACT\""));
  // The file itself is left as it was.
  EXPECT_FALSE(s.raw.walls().has_method());
}

TEST(SceneView, NamesEachMethodThatAMapMayHave) {
  Shown s = shown(kShapes);
  const std::pair<WallMethod, const char*> methods[] = {{WallMethod::kExact, "EXACT"},
                                                        {WallMethod::kSubpixel, "SUBPIXEL"},
                                                        {WallMethod::kPublished, "PUBLISHED"}};
  for (const auto& [method, name] : methods) {
    auto walls = std::make_shared<Walls>(*s.scene.walls);
    walls->method = method;
    s.scene.walls = walls;
    EXPECT_EQ(value_of(scene_text(as_used(s.raw, s.scene)), "walls.method"), name);
  }
}

TEST(SceneView, ASceneWithoutWallsGetsNone) {
  const Shown s = shown("name: 'a'\n");
  EXPECT_FALSE(as_used(s.raw, s.scene).has_walls());
  EXPECT_THAT(scene_text(as_used(s.raw, s.scene)), Not(HasSubstr("walls.region")));
}

TEST(SceneView, ListsEveryEffectAlsoThoseThatSayNothingMore) {
  const Shown s = shown(kShapes);
  const std::string text = scene_text(as_used(s.raw, s.scene));
  EXPECT_THAT(text, HasSubstr("\neffect[0].wall.published_damper "));
  EXPECT_THAT(text, HasSubstr("\neffect[1].viscous.coupling_n_mm "));
  EXPECT_EQ(value_of(text, "effect[2].detent.radius_mm"), "2 mm");
  EXPECT_THAT(text, HasSubstr("\neffect[3].device_inertia\n"));
  EXPECT_THAT(text, Not(HasSubstr("effect[4]")));
  EXPECT_THAT(text, Not(HasSubstr("device_friction")));
}

}  // namespace
}  // namespace handrail
