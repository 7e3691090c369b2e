#include "server/scene/tool_io.h"

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <limits>

namespace handrail {
namespace {

pb::Tool tool_of(const std::string& text) {
  pb::Tool tool;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &tool)) << text;
  return tool;
}

std::string tool_complaint(const std::string& text) {
  ToolCall call;
  const auto problem = tool_call_from(tool_of(text), call);
  return problem ? problem->path + ": " + problem->text : "";
}

TEST(ToolIo, ConvertsToSi) {
  ToolCall call;
  const auto problem = tool_call_from(
      tool_of("kind: LINE at_mm: [350, 0, 429] direction: [0, -2, 0] end_mm: [350, -150, 429] "
              "one_way: true stiffness_n_mm: 0.8"),
      call);
  ASSERT_FALSE(problem.has_value());
  EXPECT_EQ(call.kind, ToolKind::kLine);
  EXPECT_FALSE(call.at_present);
  EXPECT_TRUE(call.p_SA.isApprox(Vec3(0.35, 0, 0.429)));
  EXPECT_TRUE(call.direction_S.isApprox(Vec3(0, -2, 0)));
  EXPECT_TRUE(call.has_end);
  EXPECT_TRUE(call.p_SE.isApprox(Vec3(0.35, -0.15, 0.429)));
  EXPECT_TRUE(call.one_way);
  EXPECT_DOUBLE_EQ(call.stiffness, 800.0);
}

TEST(ToolIo, AnchorsAtTheTipWhenNoPlaceIsGiven) {
  ToolCall call;
  ASSERT_FALSE(tool_call_from(tool_of("kind: F_ROTATION"), call).has_value());
  EXPECT_TRUE(call.at_present);
  EXPECT_FALSE(call.has_axis);
  ASSERT_FALSE(tool_call_from(tool_of("kind: F_ROTATION axis: [0, 0, 1]"), call).has_value());
  EXPECT_TRUE(call.has_axis);
}

TEST(ToolIo, RefusesWhatAKindWouldIgnore) {
  EXPECT_EQ(tool_complaint("kind: POINT direction: [1, 0, 0]"),
            "direction: has no meaning for POINT");
  EXPECT_EQ(tool_complaint("kind: LINE direction: [1, 0, 0] normal: [0, 0, 1]"),
            "normal: has no meaning for LINE");
  EXPECT_EQ(tool_complaint("kind: N_ROTATION at_mm: [1, 0, 0]"),
            "at_mm: has no meaning for N_ROTATION");
  EXPECT_EQ(tool_complaint("kind: F_ROTATION one_way: true"),
            "one_way: has no meaning for F_ROTATION");
  EXPECT_EQ(tool_complaint("kind: N_ROTATION stiffness_n_mm: 1"),
            "stiffness_n_mm: has no meaning for N_ROTATION");
}

TEST(ToolIo, RefusesDirectionsWithoutLength) {
  EXPECT_EQ(tool_complaint("kind: LINE direction: [0, 0, 0]"),
            "direction: the direction has no length");
  EXPECT_EQ(tool_complaint("kind: PLANE normal: [0, 0, 0]"), "normal: the direction has no length");
  EXPECT_EQ(tool_complaint("kind: PLANE normal: [0, 0, 1] direction: [0, 0, 0]"),
            "direction: the direction has no length");
  EXPECT_EQ(tool_complaint("kind: F_ROTATION axis: [0, 0, 0]"),
            "axis: the direction has no length");
  EXPECT_EQ(tool_complaint("kind: LINE"), "direction: missing, but a LINE needs it");
  EXPECT_EQ(tool_complaint("kind: PLANE"), "normal: missing, but a PLANE needs it");
}

TEST(ToolIo, RefusesForwardAlongThePlanesNormal) {
  EXPECT_EQ(tool_complaint("kind: PLANE normal: [0, 0, 1] direction: [0, 0, -3]"),
            "direction: along the normal, expected one within the plane");
  EXPECT_EQ(tool_complaint("kind: PLANE normal: [0, 0, 1] one_way: true"),
            "one_way: needs a direction within the PLANE");
  EXPECT_EQ(tool_complaint("kind: PLANE normal: [0, 0, 1] end_mm: [1, 0, 0]"),
            "end_mm: needs a direction within the PLANE");
  EXPECT_EQ(tool_complaint("kind: PLANE normal: [0, 0, 1] direction: [1, 0, 5] one_way: true"), "");
}

TEST(ToolIo, RefusesAnEndBehindTheStart) {
  EXPECT_EQ(tool_complaint("kind: LINE direction: [1, 0, 0] at_mm: [10, 0, 0] end_mm: [9, 0, 0]"),
            "end_mm: the end point lies behind the start");
  EXPECT_EQ(tool_complaint("kind: LINE direction: [1, 0, 0] at_mm: [10, 0, 0] end_mm: [10, 5, 0]"),
            "end_mm: the end point lies behind the start");
  EXPECT_EQ(tool_complaint("kind: LINE direction: [1, 0, 0] at_mm: [10, 0, 0] end_mm: [11, 0, 0]"),
            "");
  // Only the master knows where a line without an anchor starts.
  EXPECT_EQ(tool_complaint("kind: LINE direction: [1, 0, 0] end_mm: [-9, 0, 0]"), "");
}

TEST(ToolIo, RefusesAnEndThatNoDatagramCarries) {
  const std::string line = "kind: LINE direction: [1, 0, 0] at_mm: [-5000, 0, 0] ";
  EXPECT_EQ(tool_complaint(line + "end_mm: [4999, 0, 0]"), "");
  EXPECT_EQ(tool_complaint(line + "end_mm: [5000, 0, 0]"),
            "end_mm: 10000 mm from at_mm, expected less than 10000");
  EXPECT_EQ(tool_complaint("kind: LINE direction: [1, 1, 1] at_mm: [-5000, -5000, -5000] "
                           "end_mm: [5000, 5000, 5000]"),
            "end_mm: 17320.5 mm from at_mm, expected less than 10000");
}

TEST(ToolIo, LeavesTheCallAloneOnAProblem) {
  ToolCall call;
  call.stiffness = 5.0;
  ASSERT_TRUE(tool_call_from(tool_of("kind: LINE at_mm: [1, 1, 1]"), call).has_value());
  EXPECT_EQ(call.stiffness, 5.0);
  EXPECT_EQ(call.kind, ToolKind::kNone);
  EXPECT_TRUE(call.at_present);
}

TEST(ToolCall, RefusesWhatIsNotFiniteOrTooLargeToSquare) {
  ToolCall call;
  call.kind = ToolKind::kLine;
  call.direction_S = Vec3::UnitX();
  EXPECT_EQ(check(call), Reason::kNone);
  call.direction_S = Vec3(1e200, 0, 0);
  EXPECT_EQ(check(call), Reason::kToolValueInvalid);
  call.direction_S = Vec3::UnitX();
  call.p_SA.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(check(call), Reason::kToolValueInvalid);
  call.p_SA.setZero();
  call.stiffness = -1.0;
  EXPECT_EQ(check(call), Reason::kToolValueInvalid);
  call.stiffness = 0.0;
  call.kind = ToolKind::kNone;
  EXPECT_EQ(check(call), Reason::kNoSuchTool);
}

TEST(ToolCall, MeasuresAPlanesTravelWithinThePlane) {
  ToolCall call;
  call.kind = ToolKind::kPlane;
  call.normal_S = Vec3::UnitZ();
  call.direction_S = Vec3(1, 0, 10);
  call.has_end = true;
  call.p_SE = Vec3(-0.1, 0, 5);
  EXPECT_TRUE(end_behind_start(call, Vec3::Zero()));
  call.p_SE = Vec3(0.1, 0, -5);
  EXPECT_FALSE(end_behind_start(call, Vec3::Zero()));
}

}  // namespace
}  // namespace handrail
