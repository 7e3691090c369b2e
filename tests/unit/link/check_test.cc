#include "server/link/check.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/link/link_samples.h"

namespace handrail {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

ToolDefinition position_tool(ToolKind kind) {
  ToolDefinition tool;
  tool.kind = kind;
  tool.id = 1;
  if (kind == ToolKind::kLine) tool.direction_S = {0, 0.6, 0.8};
  if (kind == ToolKind::kPlane) tool.normal_S = {0, 0, 1};
  tool.stiffness = 800;
  return tool;
}

TEST(Check, SoundStatesPass) {
  EXPECT_EQ(check(MasterState{}), Reject::kNone);
  EXPECT_EQ(check(SlaveState{}), Reject::kNone);
  EXPECT_EQ(check(sample_master()), Reject::kNone);
  EXPECT_EQ(check(sample_slave()), Reject::kNone);
}

TEST(Check, CodesOutOfRangeAreRefused) {
  MasterState m;
  m.desired = Desired::kCount;
  EXPECT_EQ(check(m), Reject::kEnum);
  m = {};
  m.state = static_cast<SessionState>(200);
  EXPECT_EQ(check(m), Reject::kEnum);
  m = {};
  m.grip = Grip::kCount;
  EXPECT_EQ(check(m), Reject::kEnum);
  SlaveState s;
  s.fault = Reason::kCount;
  EXPECT_EQ(check(s), Reject::kEnum);
  s = {};
  s.gripper = GripperState::kCount;
  EXPECT_EQ(check(s), Reject::kEnum);
}

TEST(Check, PositionsTenMetresAwayAreRefused) {
  MasterState m;
  m.X_SU.p = {0, 9.999, 0};
  EXPECT_EQ(check(m), Reject::kNone);
  m.X_SU.p = {0, -10.0, 0};
  EXPECT_EQ(check(m), Reject::kRange);
  SlaveState s;
  s.X_ST.p = {8, 8, 0};
  EXPECT_EQ(check(s), Reject::kRange);
  s = {};
  s.X_ST_command.p = {8, 8, 0};
  EXPECT_EQ(check(s), Reject::kRange);
}

TEST(Check, NonFiniteNumbersAreRefusedWhereverTheyStand) {
  for (const double bad : {kNan, kInf, -kInf}) {
    MasterState m;
    m.X_SU.p.x() = bad;
    EXPECT_EQ(check(m), Reject::kNotFinite);
    m = {};
    m.X_SU.q.w() = bad;
    EXPECT_EQ(check(m), Reject::kNotFinite);
    m = sample_master();
    m.position_tool.stiffness = bad;
    EXPECT_EQ(check(m), Reject::kNotFinite);
    m = sample_master();
    m.orientation_tool.axis_T.z() = bad;
    EXPECT_EQ(check(m), Reject::kNotFinite);
    SlaveState s;
    s.q_measured[5] = bad;
    EXPECT_EQ(check(s), Reject::kNotFinite);
    s = {};
    s.f_E_S.torque.z() = bad;
    EXPECT_EQ(check(s), Reject::kNotFinite);
  }
}

TEST(Check, QuaternionsMustBeOfUnitLength) {
  SlaveState s;
  s.X_ST.q.coeffs().setZero();
  EXPECT_EQ(check(s), Reject::kRotation);
  MasterState m;
  m.X_SU.q.coeffs() *= 1.0 + 1e-6;
  EXPECT_EQ(check(m), Reject::kRotation);
}

TEST(Check, EveryKindOfToolPassesInItsOwnSlotOnly) {
  for (const ToolKind kind : {ToolKind::kPoint, ToolKind::kLine, ToolKind::kPlane}) {
    EXPECT_EQ(check_position_tool(position_tool(kind)), Reject::kNone);
    EXPECT_EQ(check_orientation_tool(position_tool(kind)), Reject::kTool);
  }
  ToolDefinition n;
  n.kind = ToolKind::kNRotation;
  n.q_ref = Quat(0, 1, 0, 0);
  EXPECT_EQ(check_orientation_tool(n), Reject::kNone);
  EXPECT_EQ(check_orientation_tool(sample_f_rotation()), Reject::kNone);
  EXPECT_EQ(check_position_tool(n), Reject::kTool);
  EXPECT_EQ(check_position_tool(sample_f_rotation()), Reject::kTool);
}

TEST(Check, NoToolKeepsItsEpochAndNothingElse) {
  ToolDefinition none;
  none.epoch = 7;
  EXPECT_EQ(check_position_tool(none), Reject::kNone);
  EXPECT_EQ(check_orientation_tool(none), Reject::kNone);
  none.id = 1;
  EXPECT_EQ(check_position_tool(none), Reject::kTool);
  none.id = 0;
  none.stiffness = 1;
  EXPECT_EQ(check_orientation_tool(none), Reject::kTool);
}

TEST(Check, ToolsThatContradictThemselvesAreRefused) {
  ToolDefinition tool = position_tool(ToolKind::kLine);
  tool.direction_S *= 1.01;
  EXPECT_EQ(check_position_tool(tool), Reject::kTool);
  tool = position_tool(ToolKind::kLine);
  tool.end = 0.1;  // without has_end
  EXPECT_EQ(check_position_tool(tool), Reject::kTool);
  tool.has_end = true;
  EXPECT_EQ(check_position_tool(tool), Reject::kNone);
  tool.end = 0.0;
  EXPECT_EQ(check_position_tool(tool), Reject::kTool);
  tool = position_tool(ToolKind::kPlane);
  tool.one_way = true;  // without a direction
  EXPECT_EQ(check_position_tool(tool), Reject::kTool);
  tool = position_tool(ToolKind::kPlane);
  tool.direction_S = {0, 0.6, 0.8};  // out of the plane
  EXPECT_EQ(check_position_tool(tool), Reject::kTool);
  tool = position_tool(ToolKind::kPoint);
  tool.normal_S = {0, 0, 1};
  EXPECT_EQ(check_position_tool(tool), Reject::kTool);
  tool = sample_f_rotation();
  tool.axis_T.setZero();
  EXPECT_EQ(check_orientation_tool(tool), Reject::kTool);
  tool = sample_f_rotation();
  tool.q_ref = Quat(0, 1, 0, 0);
  EXPECT_EQ(check_orientation_tool(tool), Reject::kTool);
  tool = position_tool(ToolKind::kPoint);
  tool.stiffness = -1;
  EXPECT_EQ(check_position_tool(tool), Reject::kRange);
}

TEST(Check, SceneNamesAreLettersDigitsDashesAndUnderscores) {
  MasterState m;
  m.scene = scene_name("Linear-movement_2");
  EXPECT_EQ(check(m), Reject::kNone);
  for (const char* name : {"../etc", "a b", "<b>", "\xc3\xa9", "a\n"}) {
    m.scene = scene_name(name);
    EXPECT_EQ(check(m), Reject::kScene) << name;
  }
  m.scene.fill('x');
  EXPECT_EQ(check(m), Reject::kScene);
  m.scene = scene_name("a");
  m.scene[5] = 'b';
  EXPECT_EQ(check(m), Reject::kScene);
}

TEST(Check, NegativeSpansAreRefused) {
  SlaveState s;
  s.program.calendar = -1;
  EXPECT_EQ(check(s), Reject::kRange);
  s.program.calendar = 0;
  s.oldest_applied = -1;
  EXPECT_EQ(check(s), Reject::kRange);
}

TEST(Check, ASurfaceHasAUnitNormalAPlaceAndAStiffness) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Surface sound{Vec3(0.6, 0, -0.8), -1.5, 60e3};
  const auto cause = [](const Surface& surface) {
    SlaveState s;
    s.surface = surface;
    return check(s);
  };
  EXPECT_EQ(cause(sound), Reject::kNone);
  EXPECT_EQ(cause({{nan, 0, -0.8}, -1.5, 60e3}), Reject::kNotFinite);
  EXPECT_EQ(cause({sound.n_S, nan, 60e3}), Reject::kNotFinite);
  EXPECT_EQ(cause({sound.n_S, -1.5, 1.0 / 0.0}), Reject::kNotFinite);
  EXPECT_EQ(cause({sound.n_S, -1.5, nan}), Reject::kNotFinite);
  EXPECT_EQ(cause({{0, 0, 0}, -1.5, 60e3}), Reject::kSurface);
  EXPECT_EQ(cause({{0.6, 0, -0.81}, -1.5, 60e3}), Reject::kSurface);
  EXPECT_EQ(cause({sound.n_S, 10.0, 60e3}), Reject::kSurface);
  EXPECT_EQ(cause({sound.n_S, -10.0, 60e3}), Reject::kSurface);
  EXPECT_EQ(cause({sound.n_S, -1.5, 99.0}), Reject::kSurface);
  EXPECT_EQ(cause({sound.n_S, -1.5, -60e3}), Reject::kSurface);
  EXPECT_EQ(cause({sound.n_S, -1.5, 1.1e7}), Reject::kSurface);
}

TEST(Reject, EveryCauseHasItsOwnWords) {
  for (std::size_t i = 0; i < kRejectCauses; ++i) {
    EXPECT_STRNE(describe(static_cast<Reject>(i)), "unknown cause") << i;
  }
  EXPECT_STREQ(describe(Reject::kCount), "unknown cause");
  RejectCounts counts{};
  counts[static_cast<std::size_t>(Reject::kNone)] = 9;
  EXPECT_EQ(causes_text(counts), "");
  counts[static_cast<std::size_t>(Reject::kStale)] = 20;
  counts[static_cast<std::size_t>(Reject::kChecksum)] = 3;
  EXPECT_EQ(causes_text(counts), "checksum mismatch 3, older than the newest accepted 20");
}

}  // namespace
}  // namespace handrail
