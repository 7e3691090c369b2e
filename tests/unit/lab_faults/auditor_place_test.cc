// The auditor on where a tip may be: where it was asked to, on its tool, or on its way there.
#include "server/lab/faults/audit/auditor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/unit/lab_faults/audited_stream.h"

namespace handrail {
namespace {

constexpr double kPlaceFast = 0.003;  // of J1 in a cycle [rad]

TEST(AuditorTest, ATipWhereNobodySentItIsFound) {
  for (const double turn : {0.0, 0.005}) {  // of the hand, in its place, a cycle [rad]
    Stream s;
    const Pose start = s.state.X_SU;
    s.change_speed(kPlaceFast);
    s.coast(5);
    EXPECT_EQ(s.report().total(), 0u);
    for (int i = 0; i < 20; ++i) {  // the commands stay, the tip goes on
      s.state.X_SU = {start.p, rotation_exp(i * turn * Vec3::UnitZ()) * start.q};
      s.cycle(kPlaceFast);
    }
    EXPECT_GT(s.report().of(Breach::kUnasked), 0u) << turn;
    EXPECT_EQ(s.report().total(), s.report().of(Breach::kUnasked));
  }
}

// The nearest the arm can do need not lie between the commands.
TEST(AuditorTest, ATipMayGoAlongTheEndOfReachButNotAwayFromWhatIsAskedBeyond) {
  for (const bool away : {false, true}) {
    Stream s;
    s.change_speed(kPlaceFast);
    // A metre further out, and as much to the side as J1 still turns.
    JointVector there = s.q;
    there[0] += away ? -0.3 : 0.3;
    s.state.X_SU = forward(limits().arm, there);
    s.state.X_SU.p += 1.0 * s.state.X_SU.p.cwiseProduct(Vec3(1.0, 1.0, 0.0)).normalized();
    for (int i = 0; i < 60; ++i) s.cycle(kPlaceFast);
    EXPECT_EQ(s.report().of(Breach::kUnasked) > 0, away);
    EXPECT_EQ(s.report().total(), s.report().of(Breach::kUnasked));
  }
}

// Round the base's axis the tip leaves the box of what is asked and where it stood, but comes ever
// nearer: to a place beside the axis that it cannot reach, and to one on its far side.
TEST(AuditorTest, ATipMayLeaveTheBoxOfCommandsThatItOnlyGetsToOnAWayRound) {
  for (const bool in_reach : {false, true}) {
    Stream s;
    const Vec3 start = s.auditor.tip();
    JointVector there = s.q;
    there[0] = 2.0;
    const Vec3 beside = 0.05 * Vec3(std::cos(0.6), std::sin(0.6), 0.0);
    s.state.X_SU.p = beside + start.z() * Vec3::UnitZ();
    if (in_reach) s.state.X_SU = forward(limits().arm, there);
    const double jerk = 0.9 * limits().max_jerk[0] * kDt * kDt * kDt;
    double change = 0.0, step = 0.0;
    for (int i = 0; i < (in_reach ? 600 : 60); ++i) {
      change = std::min({change + jerk, 0.5 * (kPlaceFast - step), jerk});
      step += change;
      s.cycle(step);
    }
    EXPECT_GT(s.auditor.tip().y(), start.y() + 0.05);
    EXPECT_EQ(s.report().total(), 0u) << in_reach;
  }
}

TEST(AuditorTest, ATipLeavingItsToolIsFound) {
  Stream s;
  s.state.position_tool = line_through(s.state.X_SU.p);
  s.coast(60);
  EXPECT_EQ(s.report().total(), 0u);
  s.change_speed(0.5 * kPlaceFast);
  EXPECT_GT(s.report().of(Breach::kOffTool), 0u);
  EXPECT_EQ(s.report().total(), s.report().of(Breach::kOffTool));
}

TEST(AuditorTest, ATipThatAToolIsCalledAcrossMayStopAndComeBackButNotGoOn) {
  for (const bool goes_on : {false, true}) {
    Stream s;
    s.change_speed(kPlaceFast);
    s.state.position_tool = line_through(forward(limits().arm, s.q).p);
    if (goes_on) {
      s.coast(60);
      EXPECT_GT(s.report().of(Breach::kOffTool), 0u);
      continue;
    }
    s.change_speed(0.0);
    s.change_speed(-0.5 * kPlaceFast);
    EXPECT_EQ(s.report().of(Breach::kOffTool), 0u);
  }
}

TEST(AuditorTest, ATipThatHasComeNearerItsToolMayNotLeaveAgain) {
  Stream s;
  s.state.position_tool = line_through(forward(limits().arm, s.q).p + Vec3(0.0, 0.05, 0.0));
  s.coast(3);
  s.change_speed(kPlaceFast);
  s.coast(5);
  s.change_speed(0.0);
  s.coast(130);  // 0.05 m at the speed of easing
  EXPECT_EQ(s.report().of(Breach::kOffTool), 0u);
  s.change_speed(-kPlaceFast);
  EXPECT_GT(s.report().of(Breach::kOffTool), 0u);
}

// What it may still do while it is eased there: come nearer faster, and back as far as that goes.
TEST(AuditorTest, TheWayToAToolClosesBehindATipAsItIsEased) {
  AuditLimits slow = limits();
  slow.catch_up = 1e-5;
  Stream s(slow);
  s.state.position_tool = line_through(forward(limits().arm, s.q).p + Vec3(0.0, 0.05, 0.0));
  s.coast(3);
  for (const double speed : {kPlaceFast, 0.0, -kPlaceFast, 0.0}) s.change_speed(speed);
  EXPECT_EQ(s.report().of(Breach::kOffTool), 0u);
  s.change_speed(-kPlaceFast);
  s.coast(5);
  EXPECT_GT(s.report().of(Breach::kOffTool), 0u);
}

TEST(AuditorTest, ASurfaceMayPushATipOffItsToolTheWayItPushesAndNoOther) {
  for (const int push : {0, 1, 2}) {
    Stream s;
    s.state.position_tool = line_through(forward(limits().arm, s.q).p);
    s.coast(3);
    const double away = 0.0008 / forward(limits().arm, s.q).p.x();
    for (int i = 0; i < 16; ++i) {
      if (push > 0) s.auditor.touched(push == 1 ? Vec3::UnitY() : Vec3::UnitZ());
      s.cycle(away / 16.0);
    }
    EXPECT_EQ(s.report().of(Breach::kOffTool) > 0, push != 1) << push;
  }
}

// Held back by a surface the tip is far from all commands; it may be there, but not beside them.
TEST(AuditorTest, ATipHeldOutByASurfaceIsWhereItWasAsked) {
  for (const bool touched : {false, true}) {
    Stream s;
    const double reach = s.state.X_SU.p.x();
    s.state.X_SU.p.y() -= 0.05;
    const double step = 0.02 / reach / 20.0;
    for (int i = 0; i < 600; ++i) {
      if (touched) s.auditor.touched(Vec3::UnitY());
      s.cycle(i % 40 < 20 ? step : -step);
    }
    EXPECT_EQ(s.report().of(Breach::kUnasked) > 0, !touched);
  }
}

// The same epoch with another definition is none the slave may follow.
TEST(AuditorTest, AToolUnderAnOldEpochDoesNotCount) {
  Stream s;
  const Vec3 p = s.state.X_SU.p;
  s.state.position_tool = line_through(p);
  s.coast(3);
  s.state.position_tool = ToolDefinition();
  s.state.position_tool.epoch = 1;
  s.coast(3);
  s.change_speed(0.5 * kPlaceFast);
  EXPECT_GT(s.report().of(Breach::kOffTool), 0u);
}

}  // namespace
}  // namespace handrail
