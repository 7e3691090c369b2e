// Orders on scenes of walls: stages, the screw, where a prompt leads.
#include <gmock/gmock.h>

#include "tests/unit/master/desk_bench.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class WallOrdersTest : public DeskBench {};

TEST_F(WallOrdersTest, StagesAreThoseOfTheSceneByName) {
  EXPECT_EQ(refusal("stage: 'open'"), "refused: scene 'first' has no stages");
  auto walls = std::make_shared<Walls>();
  walls->stages.resize(1);
  scenes["second"].walls = walls;
  tick();
  ask("scene_load: 'second'");
  EXPECT_EQ(refusal("stage: ''"), "refused: scene 'second' has no stages");
  walls->stages.assign(2, {});
  walls->stages[0].name = "shut";
  walls->stages[1].name = "open";
  EXPECT_EQ(refusal("stage: 'ajar'"),
            "refused: scene 'second' has no stage 'ajar', expected one of 'shut', 'open'");
  EXPECT_EQ(at_once("stage: 'open'"), "done: ");
  EXPECT_EQ(last_order(), OrderKind::kStage);
  EXPECT_EQ(taken.back().order.stage, 1);
}

TEST_F(WallOrdersTest, AScrewIsTheScenesAndItsCWithinBounds) {
  EXPECT_EQ(refusal("screw_c: 15"),
            "refused: scene 'first' has no screw: it lists no progressive effect");
  scenes["second"].walls = std::make_shared<Walls>();
  EffectSpec screw;
  screw.kind = EffectKind::kProgressive;
  scenes["second"].effects = {screw};
  tick();
  ask("scene_load: 'second'");
  for (const char* c : {"-0.1", "100.1", "nan", "inf"}) {
    EXPECT_THAT(refusal(std::string("screw_c: ") + c), HasSubstr("expected 0 to 100 N s/(m rad)"));
  }
  EXPECT_EQ(at_once("screw_c: 15"), "done: ");
  EXPECT_EQ(last_order(), OrderKind::kScrew);
  EXPECT_EQ(taken.back().order.screw_c, 15.0);
}

TEST_F(WallOrdersTest, APromptMayLeadToAPlace) {
  for (const char* ball : {"1", "[1, 2, 3]", "[1, nan]", "[1, 1e9]"}) {
    EXPECT_THAT(refusal(std::string("prompt: 'x' ball_mm: ") + ball),
                HasSubstr("ball_mm: expected two numbers"));
  }
  tick();
  EXPECT_EQ(text(ask("prompt: 'There.' ball_mm: [1, -2]")), "done: ");
  const Answer answer = ask("status: true");
  EXPECT_EQ((*answer)->status().prompt(), "There.");
  EXPECT_FALSE((*answer)->status().has_walls()) << "there is no place without walls";
}

}  // namespace
}  // namespace handrail
