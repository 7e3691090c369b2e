#include "client/cli/tool_command.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

TEST(ToolCommand, BuildsTheToolThatTheOptionsDescribe) {
  Options o;
  o.at.emplace("350,0,429");
  o.direction.emplace("-y");
  o.end.emplace("350,-150,429");
  o.one_way = true;
  o.stiffness.emplace("0.8");
  const Result<pb::Tool> tool = tool_from(pb::Tool::LINE, o);
  ASSERT_TRUE(tool.is_ok()) << tool.message();
  EXPECT_EQ(tool->ShortDebugString(),
            "kind: LINE at_mm: 350 at_mm: 0 at_mm: 429 direction: 0 direction: -1 direction: 0 "
            "end_mm: 350 end_mm: -150 end_mm: 429 one_way: true stiffness_n_mm: 0.8");
}

TEST(ToolCommand, LeavesOutWhatWasNotGiven) {
  const Result<pb::Tool> tool = tool_from(pb::Tool::N_ROTATION, Options());
  ASSERT_TRUE(tool.is_ok()) << tool.message();
  EXPECT_EQ(tool->ShortDebugString(), "kind: N_ROTATION");
}

TEST(ToolCommand, NamesTheOptionBehindAProblem) {
  Options o;
  EXPECT_EQ(tool_from(pb::Tool::LINE, o).message(), "--dir: missing, but a LINE needs it");
  EXPECT_EQ(tool_from(pb::Tool::PLANE, o).message(), "--normal: missing, but a PLANE needs it");
  o.direction.emplace("x");
  EXPECT_EQ(tool_from(pb::Tool::POINT, o).message(), "--dir: has no meaning for POINT");
  o.at.emplace("0,0,9000");
  EXPECT_EQ(tool_from(pb::Tool::LINE, o).message(), "--at: 9000 is outside -5000 to 5000 mm");
  o.at.emplace("10,0,0");
  o.end.emplace("0,0,0");
  EXPECT_EQ(tool_from(pb::Tool::LINE, o).message(), "--end: the end point lies behind the start");
}

}  // namespace
}  // namespace handrail
