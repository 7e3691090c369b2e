// The auditor against command streams made by hand: sound ones pass, each wrong one is named.
#include "server/lab/faults/audit/auditor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/unit/lab_faults/audited_stream.h"

namespace handrail {
namespace {

constexpr double kFast = 0.003;  // of J1 in a cycle [rad]

TEST(AuditorTest, ASoundDriveHasNoBreach) {
  Stream s;
  s.change_speed(kFast);
  s.coast(50);
  s.change_speed(-kFast);
  s.change_speed(0.0);
  EXPECT_EQ(s.report().total(), 0u);
  EXPECT_EQ(s.report().stops, 0u);
  EXPECT_GT(s.report().moved, 60u);
  EXPECT_GT(s.report().jerk, 0.3);
  EXPECT_EQ(s.report().fresh, s.number);
}

TEST(AuditorTest, NamesEachLimit) {
  const JointLimits& joints = rv2a_limits();
  const double v = joints.max_speed[0] * kDt;
  const double a = joints.max_acceleration[0] * kDt * kDt;
  Stream fast;
  fast.v = 1.01 * v;
  fast.coast(2);
  EXPECT_EQ(fast.report().of(Breach::kSpeed), 2u);
  Stream hard;
  hard.v = 1.01 * a;
  hard.coast(2);
  EXPECT_EQ(hard.report().of(Breach::kAcceleration), 1u);
  EXPECT_EQ(hard.report().of(Breach::kSpeed), 0u);
  Stream jerky;
  jerky.v = 1.01 * limits().max_jerk[0] * kDt * kDt * kDt;
  jerky.coast(2);
  EXPECT_EQ(jerky.report().of(Breach::kAcceleration), 0u);
  EXPECT_EQ(jerky.report().of(Breach::kJerk), 2u);
  Stream far;
  far.q[0] = joints.upper[0] + 1e-6;
  far.cycle();
  EXPECT_EQ(far.report().of(Breach::kRange), 1u);
  Stream broken;
  broken.q[0] = std::numeric_limits<double>::quiet_NaN();
  broken.cycle();
  EXPECT_EQ(broken.report().of(Breach::kNotFinite), 1u);
}

TEST(AuditorTest, AStopWithinItsTimeIsCountedAndOneThatLastsIsLate) {
  Stream good;
  good.change_speed(kFast);
  good.link = false;
  good.coast(3);  // 21.3 ms
  good.change_speed(0.0);
  good.coast(10);
  good.auditor.finish();
  EXPECT_EQ(good.report().total(), 0u);
  EXPECT_EQ(good.report().stops, 1u);
  EXPECT_LT(good.report().worst.took, good.report().worst.allowed);
  EXPECT_GT(good.report().worst.took, 40 * kMillisecond);

  Stream late;
  late.change_speed(kFast);
  late.link = false;
  late.coast(40);
  EXPECT_GT(late.report().of(Breach::kLateStop), 10u);
}

TEST(AuditorTest, TheBoundIsWatchdogCycleAndTheJointsOwnTime) {
  Stream s;
  s.change_speed(kFast);
  s.link = false;
  s.coast(4);
  s.auditor.finish();
  const double own = kFast / kDt / rv2a_limits().max_acceleration[0] + 2.5 * 0.020;
  EXPECT_NEAR(to_seconds(s.report().worst.allowed), 0.020 + 0.0071 + 0.002 + own, 1e-9);
}

// An arm that turns stands for one command, with an acceleration that its jerk does not let go at
// once: what it still moves belongs to its stop. From rest nothing may move.
TEST(AuditorTest, AnArmThatTurnsWhenItMustStopIsStoppingAndNotAtRest) {
  const double jerk = 0.9 * limits().max_jerk[0] * kDt * kDt * kDt;
  for (const std::size_t heard : {4u, 5u, 6u}) {  // cycles; the last is followed by 20 ms
    for (const bool goes_on : {false, true}) {
      Stream s;
      double step = 0.0;
      const std::array<double, 9> changes = {0.75, 1.5, 0.75, 0.0, -0.5, -1.0, -1.5, -0.5, 0.5};
      for (std::size_t i = 0; i < changes.size(); ++i) {
        s.link = i < heard;
        step += changes[i] * jerk;
        s.cycle(step);
        EXPECT_EQ(s.auditor.led(), i < heard + 2) << heard << " " << i;
      }
      s.link = false;
      s.cycle();
      s.cycle();
      if (goes_on) s.cycle(1e-9);
      s.auditor.finish();
      EXPECT_EQ(s.report().stops, 1u) << heard;
      EXPECT_EQ(s.report().of(Breach::kUnled), goes_on ? 1u : 0u) << heard;
      EXPECT_EQ(s.report().total(), s.report().of(Breach::kUnled)) << heard;
    }
  }
}

TEST(AuditorTest, AShortGapResumesByItself) {
  Stream s;
  s.change_speed(kFast);
  s.link = false;
  s.coast(3);
  s.change_speed(0.0);
  s.link = true;
  s.coast(1);
  s.change_speed(kFast);
  EXPECT_EQ(s.report().total(), 0u);
  EXPECT_EQ(s.report().resumed, 1u);
  EXPECT_EQ(s.report().latched, 0u);
}

TEST(AuditorTest, AfterALongGapOnlyANewEngagementMayMove) {
  for (const bool engages_again : {false, true}) {
    Stream s;
    s.change_speed(kFast);
    s.link = false;
    s.coast(3);
    s.change_speed(0.0);
    s.coast(30);
    s.link = true;
    s.coast(1);
    if (engages_again) {
      s.state.state = SessionState::kAligning;
      s.coast(1);
      s.state.state = SessionState::kEngaged;
    }
    s.change_speed(kFast);
    EXPECT_EQ(s.report().latched, 1u);
    EXPECT_EQ(s.report().of(Breach::kUnled) > 0, !engages_again);
    EXPECT_EQ(s.report().resumed, 0u);
  }
}

TEST(AuditorTest, StaleForgedAndForeignDatagramsDoNotLead) {
  Stream s;
  s.change_speed(kFast);
  s.link = false;
  const std::uint64_t old = s.number - 3;
  for (int i = 0; i < 20; ++i) {
    s.auditor.delivered({old, Origin::kReplay, s.now});
    s.auditor.delivered({s.number, Origin::kCorrupt, s.now});
    s.auditor.delivered({1'000'000, Origin::kGenuine, s.now});  // never sent
    s.coast(1);
  }
  EXPECT_GT(s.report().of(Breach::kLateStop), 0u);
}

TEST(AuditorTest, ARestartedMasterDoesNotLeadTheOldEngagement) {
  Stream s;
  s.change_speed(kFast);
  ++s.incarnation;
  s.coast(30);
  EXPECT_GT(s.report().of(Breach::kLateStop), 0u);
}

TEST(AuditorTest, AStopIsDueWhenTheMasterSaysSoOrTheRowDoes) {
  for (const bool by_row : {false, true}) {
    Stream s;
    s.change_speed(kFast);
    if (by_row) {
      s.auditor.must_stop(s.now);
    } else {
      s.state.stop_epoch = 1;
    }
    s.coast(1);
    s.change_speed(0.0);
    s.coast(5);
    s.auditor.finish();
    EXPECT_EQ(s.report().total(), 0u);
    EXPECT_EQ(s.report().stops, 1u);
    EXPECT_LT(to_seconds(s.report().worst.allowed), 0.0091 + 0.1);
    s.change_speed(kFast);
    EXPECT_GT(s.report().of(Breach::kUnled), 0u);
  }
}

// A row knows that the arm has so long to find something out: until then it is led.
TEST(AuditorTest, AStopThatIsDueLaterLeavesAnArmAtRestFreeUntilThen) {
  Stream s;
  s.coast(3);
  s.auditor.must_stop(s.now + 100 * kMillisecond);
  s.change_speed(kFast);
  s.change_speed(0.0);
  s.coast(3);
  EXPECT_EQ(s.report().total(), 0u);
  s.coast(20);
  s.change_speed(kFast);
  EXPECT_GT(s.report().of(Breach::kUnled), 0u);
}

TEST(AuditorTest, ATipOutsideTheWorkspaceIsFound) {
  AuditLimits limited = limits();
  Stream inside(limited);
  limited.high.y() = inside.state.X_SU.p.y() + 0.010;
  Stream s(limited);
  s.change_speed(kFast);
  EXPECT_EQ(s.report().of(Breach::kWorkspace), 0u);
  s.coast(20);
  EXPECT_GT(s.report().of(Breach::kWorkspace), 0u);
}

TEST(AuditorTest, AForceOnTheHandIsFiniteAndNoLargerThanTheDevices) {
  AuditLimits limited = limits();
  limited.force = 3.3;
  Auditor auditor(limited);
  auditor.felt({Vec3(0.0, 3.3, 0.0), Vec3::Zero()});
  EXPECT_EQ(auditor.report().total(), 0u);
  auditor.felt({Vec3(2.4, 2.4, 0.0), Vec3::Zero()});
  auditor.felt({Vec3::Zero(), Vec3(0.0, std::numeric_limits<double>::quiet_NaN(), 0.0)});
  EXPECT_EQ(auditor.report().of(Breach::kForce), 2u);
}

TEST(AuditorTest, TheAppliedSequenceRisesUntilAnotherMasterBeginsAnew) {
  Stream s;
  s.auditor.reported(5);
  s.auditor.reported(9);
  s.auditor.reported(9);
  EXPECT_EQ(s.report().total(), 0u);
  s.auditor.reported(8);
  EXPECT_EQ(s.report().of(Breach::kBackward), 1u);
  s.auditor.reported(0);  // the slave began anew
  s.link = false;
  s.coast(40);
  s.link = true;
  ++s.incarnation;
  s.auditor.reported(100);
  s.coast(1);
  s.auditor.reported(1);
  EXPECT_EQ(s.report().of(Breach::kBackward), 1u);
}

}  // namespace
}  // namespace handrail
