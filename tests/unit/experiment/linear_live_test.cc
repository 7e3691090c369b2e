#include "client/experiment/linear_live.h"

#include <gtest/gtest.h>

#include "server/base/units.h"

namespace handrail {
namespace {

using Stage = LinearLive::Stage;

// Somebody at A who goes where the test says, 7 ms a sample.
class LinearLiveTest : public ::testing::Test {
 protected:
  LinearLiveTest() {
    task_.p_SA = Vec3(0.35, 0.0375, 0.329);
    task_.p_SB = task_.p_SA - 0.075 * Vec3::UnitY();
    task_.p_SC = task_.p_SB - 0.075 * Vec3::UnitZ();
    task_.turn = 45.0 * kDeg * Vec3::UnitX();
    now_.X_ST = {task_.p_SA, task_.q_first};
    now_.q_command = task_.q_first;
    now_.drives = now_.clutched = true;
    now_.time = 100.0;
  }
  LinearLive trial(StudyMode mode = StudyMode::kFree) const { return LinearLive(task_, mode); }
  void see(LinearLive& live, int samples = 1) {
    for (int i = 0; i < samples; ++i) {
      now_.time += 0.007;
      live.see(now_);
    }
  }
  void mark(LinearLive& live) {
    ++now_.marks;
    now_.marked = now_.time;
    see(live);
  }
  // Straight to `to` in a second.
  void go(LinearLive& live, const Vec3& to) {
    const Vec3 from = now_.X_ST.p;
    for (int i = 1; i <= 143; ++i) {
      now_.X_ST.p = from + (i / 143.0) * (to - from);
      see(live);
    }
  }
  void turn(LinearLive& live) {
    for (int i = 1; i <= 143; ++i) {
      now_.X_ST.q = (rotation_exp(i / 143.0 * task_.turn) * task_.q_first).normalized();
      see(live);
    }
    now_.q_command = now_.X_ST.q;
  }
  void make(LinearLive& live) {
    mark(live);
    go(live, task_.p_SB);
    mark(live);
    turn(live);
    mark(live);
    go(live, task_.p_SC);
    mark(live);
  }

  LinearTask task_;
  LiveSample now_;
};

TEST_F(LinearLiveTest, AStraightWayIsJudgedAsTheTaskSays) {
  LinearLive live = trial();
  see(live, 10);
  ASSERT_EQ(live.stage(), Stage::kAtA);
  const double started = now_.time;
  make(live);
  ASSERT_EQ(live.stage(), Stage::kEnded);
  EXPECT_EQ(live.result().end, TrialEnd::kDone);
  // Marks are timed by themselves, not by the sample that shows them.
  EXPECT_NEAR(live.result().execution_time, now_.marked - started, 1e-9);
  EXPECT_NEAR(live.result().path, 0.150, 1e-3);
  EXPECT_LT(live.result().position_error, 1e-9);
  EXPECT_LT(live.result().orientation_error, 1e-7);
}

TEST_F(LinearLiveTest, ErrorsAreThoseOfTheWayGone) {
  LinearLive live = trial();
  see(live);
  mark(live);
  go(live, task_.p_SA + Vec3(4e-3, -0.04, 0.0));
  now_.X_ST.q = (rotation_exp(3.0 * kDeg * Vec3::UnitY()) * task_.q_first).normalized();
  see(live);
  now_.X_ST.q = task_.q_first;
  go(live, task_.p_SB);
  mark(live);
  turn(live);
  mark(live);
  go(live, task_.p_SC);
  mark(live);
  ASSERT_EQ(live.result().end, TrialEnd::kDone);
  EXPECT_NEAR(live.result().position_error, 4e-3, 1e-6);
  EXPECT_NEAR(live.result().orientation_error / kDeg, 3.0, 1e-6);
}

TEST_F(LinearLiveTest, TheClockStartsAtAAlone) {
  LinearLive live = trial();
  const LiveSample at_a = now_;
  const auto spoil = [&](int which) {
    const double time = now_.time;
    const std::uint64_t marks = now_.marks;
    now_ = at_a;
    now_.time = time;
    now_.marks = marks;
    if (which == 0) now_.X_ST.p.z() += 1.1e-3;
    if (which == 1) now_.X_ST.q = (rotation_exp(1.1 * kDeg * Vec3::UnitX()) * task_.q_first);
    if (which == 2) now_.drives = false;
    if (which == 3) now_.clutched = false;
    if (which == 4) now_.position_tool = true;
    if (which == 5) now_.orientation_tool = true;
  };
  for (int which = 0; which < 6; ++which) {
    spoil(which);
    see(live);
    EXPECT_EQ(live.stage(), Stage::kToA) << which;
    mark(live);
    EXPECT_EQ(live.stage(), Stage::kToA) << which;
    spoil(-1);
    see(live, 3);  // a mark of before is not made up for
    EXPECT_EQ(live.stage(), Stage::kAtA) << which;
  }
  mark(live);
  EXPECT_EQ(live.stage(), Stage::kToB);
}

TEST_F(LinearLiveTest, MarksOfBeforeAreNone) {
  now_.marks = 7;
  now_.marked = 90.0;
  LinearLive live = trial();
  see(live, 3);
  EXPECT_EQ(live.stage(), Stage::kAtA);
  // The master starts anew and counts from zero.
  now_.marks = 0;
  see(live, 3);
  EXPECT_EQ(live.stage(), Stage::kAtA);
  mark(live);
  EXPECT_EQ(live.stage(), Stage::kToB);
}

// With tools errors count from when they are called; without them, or without calling any, from
// the mark. The path counts always.
TEST_F(LinearLiveTest, CallingToolsIsNoPartOfTheErrors) {
  for (const bool called : {true, false}) {
    for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
      LinearLive live = trial(mode);
      now_ = LiveSample{{task_.p_SA, task_.q_first}, task_.q_first, true, true};
      see(live);
      mark(live);
      go(live, task_.p_SA + Vec3(3e-3, 0.0, 0.0));  // strays while it looks for the keys
      go(live, task_.p_SA);
      now_.position_tool = now_.orientation_tool = called;
      see(live);
      go(live, task_.p_SB);
      mark(live);
      now_.orientation_tool = false;
      turn(live);
      mark(live);
      now_.orientation_tool = called;
      see(live);
      go(live, task_.p_SC);
      mark(live);
      ASSERT_EQ(live.result().end, TrialEnd::kDone);
      const bool spared = called && mode == StudyMode::kTools;
      EXPECT_NEAR(live.result().position_error, spared ? 0.0 : 3e-3, 1e-6);
      EXPECT_NEAR(live.result().path, 0.156, 1e-3);
    }
  }
}

TEST_F(LinearLiveTest, APlaceCalledReachedFromTooFarFails) {
  for (const double off : {0.0099, 0.0101}) {
    LinearLive live = trial();
    now_.X_ST = {task_.p_SA, task_.q_first};
    see(live);
    mark(live);
    go(live, task_.p_SB + Vec3(off, 0.0, 0.0));
    mark(live);
    EXPECT_EQ(live.stage(), off < kOffTarget ? Stage::kTurn : Stage::kEnded);
    if (off > kOffTarget) {
      EXPECT_EQ(live.result().end, TrialEnd::kOffTarget);
    }
  }
}

TEST_F(LinearLiveTest, TheLastPlaceToo) {
  LinearLive live = trial();
  see(live);
  mark(live);
  go(live, task_.p_SB);
  mark(live);
  turn(live);
  mark(live);
  go(live, task_.p_SC + Vec3(0.0, 0.0, 0.02));
  mark(live);
  EXPECT_EQ(live.result().end, TrialEnd::kOffTarget);
}

TEST_F(LinearLiveTest, AMinuteIsAllThereIs) {
  LinearLive live = trial();
  see(live);
  mark(live);
  see(live, static_cast<int>(kTrialLimit / 0.007) - 2);
  EXPECT_EQ(live.stage(), Stage::kToB);
  see(live, 5);
  EXPECT_EQ(live.result().end, TrialEnd::kTimeOut);
}

TEST_F(LinearLiveTest, ASessionThatEndsEndsTheTrial) {
  LinearLive live = trial();
  see(live);
  mark(live);
  see(live, 10);
  now_.drives = false;
  see(live);
  EXPECT_EQ(live.stage(), Stage::kEnded);
  EXPECT_EQ(live.result().end, TrialEnd::kSession);
}

TEST_F(LinearLiveTest, EveryStageSaysWhatToDo) {
  for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
    LinearLive live = trial(mode);
    now_.X_ST = {task_.p_SA, task_.q_first};
    now_.q_command = task_.q_first;
    see(live);
    std::string before;
    mark(live);
    for (const Vec3& to : {task_.p_SB, task_.p_SB, task_.p_SC}) {
      EXPECT_NE(live.prompt(), before);
      EXPECT_NE(live.prompt().find('M'), std::string::npos);
      EXPECT_EQ(live.prompt().find("(N)") != std::string::npos,
                mode == StudyMode::kTools && live.stage() != Stage::kTurn);
      before = live.prompt();
      go(live, to);
      mark(live);
    }
    EXPECT_EQ(live.prompt(), "");
  }
}

}  // namespace
}  // namespace handrail
