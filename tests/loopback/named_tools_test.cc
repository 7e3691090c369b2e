// A tilted tip is brought upright by a tool that the scene names: file, command line, both daemons,
// the simulated arm.
#include <gmock/gmock.h>

#include "server/base/units.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class NamedToolsTest : public WholeCell {
 protected:
  void SetUp() override {
    folder.write("keys.scene",
                 "name: 'keys'\n"
                 "tool { name: 'upright' kind: F_ROTATION axis: [0, 0, -1] tip_axis: [0, 0, 1] }\n"
                 "tool { name: 'tilted' kind: N_ROTATION turn_deg: [25, 0, 0] }\n");
    slave_extra = "scene: 'keys' scene_path: '" + folder.path() + "'";
    master_extra = "scene: 'keys'";
    WholeCell::SetUp();
  }
  // Of the tip from straight down [deg].
  static double tilt(const pb::PoseMm& pose) {
    const Quat q(pose.quaternion(0), pose.quaternion(1), pose.quaternion(2), pose.quaternion(3));
    const Vec3 down = q * Vec3::UnitZ();
    return std::atan2(std::hypot(down.x(), down.y()), -down.z()) / kDeg;
  }
  bool comes_to(double degrees) {
    return eventually([&](const pb::Status& s) {
      return s.has_tip() && !s.orientation_tool().turning() &&
             std::abs(tilt(s.slave_command()) - degrees) < 0.01 &&
             std::abs(tilt(s.tip()) - degrees) < 0.5;
    });
  }
};

TEST_F(NamedToolsTest, ATiltedTipIsBroughtUprightAndStaysSo) {
  order("engage: true");
  const Vec3 place = mm(at_rest().slave_command());
  EXPECT_NEAR(tilt(status().slave_command()), 0.0, 0.01);
  const auto [listed, list] = handrail({"tool", "list"});
  EXPECT_EQ(listed, 0);
  EXPECT_THAT(list, HasSubstr("upright  f-rotation"));
  EXPECT_THAT(list, HasSubstr("tilted  n-rotation"));
  const auto [called, answer] = handrail({"tool", "call", "tilted"});
  EXPECT_EQ(called, 0) << answer;
  EXPECT_THAT(answer, HasSubstr("tool 'tilted' called ("));
  EXPECT_THAT(answer, HasSubstr(" deg to go, about "));
  // From tick to tick the command turns no faster than the scene lets it.
  Quat last = Quat::Identity();
  double last_at = -1.0;
  ASSERT_TRUE(eventually([&](const pb::Status& s) {
    const auto& c = s.command().quaternion();
    const Quat q(c[0], c[1], c[2], c[3]);
    if (last_at >= 0.0 && s.time_s() > last_at) {
      EXPECT_LT(angle_between(last, q) / kDeg, 15.0 * (s.time_s() - last_at) + 0.1);
    }
    last = q;
    last_at = s.time_s();
    return !s.orientation_tool().turning();
  }));
  ASSERT_TRUE(comes_to(25.0));
  EXPECT_EQ(status().orientation_tool().name(), "tilted");
  order("named_tool: 'upright'");
  ASSERT_TRUE(comes_to(0.0));
  EXPECT_EQ(status().orientation_tool().name(), "upright");
  EXPECT_THAT(handrail({"status"}).second, HasSubstr("f-rotation #2 'upright'"));
  order("tool_off { position: false }");
  EXPECT_NEAR(tilt(at_rest().slave_command()), 0.0, 0.01) << "the arm does not tilt back";
  EXPECT_EQ(status().orientation_tool().name(), "");
  EXPECT_LT((mm(status().slave_command()) - place).norm(), 0.1);
}

TEST_F(NamedToolsTest, WhatCannotBeCalledIsSaid) {
  EXPECT_THAT(refusal("named_tool: 'upright'"), HasSubstr("engaged"));
  order("engage: true");
  EXPECT_EQ(refusal("named_tool: 'nothing'"),
            "scene 'keys' has no tool 'nothing': expected one of upright, tilted");
  EXPECT_THAT(refusal("named_tool: 'upright' approach: true"),
              HasSubstr("approach: has no meaning for 'upright', a tool of the kind f-rotation"));
  EXPECT_THAT(refusal("tool { name: 'mine' kind: POINT }"), HasSubstr("only a scene's tool"));
  EXPECT_EQ(status().orientation_tool().kind(), "none");
}

}  // namespace
}  // namespace handrail
