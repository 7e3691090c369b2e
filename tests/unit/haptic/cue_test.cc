// Cues: each pattern by itself, when they come, and what the hand feels in the whole step.
#include "server/haptic/cue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/base/units.h"
#include "tests/unit/haptic/loop_rig.h"

namespace handrail {
namespace {

using test::HapticRig;

constexpr double kCueTick = 1e-3;
constexpr Cue kAll[] = {Cue::kHold, Cue::kLost, Cue::kLimit, Cue::kSingularity};

MotionLedger kept_back(MotionStage stage, double by, Reason why) {
  MotionLedger ledger;
  ledger.known = true;
  ledger.off_S.col(static_cast<int>(stage)) = Vec3(0.6 * by, 0, 0.8 * by);
  ledger.why[static_cast<std::size_t>(stage)] = why;
  return ledger;
}

// Stretches of force with at least 20 ms of none before them.
int trembles_of(Cue cue) {
  int trembles = 0, quiet = 100;
  for (int ms = 0; ms < 500; ++ms) {
    const bool loud = std::abs(cue_force(cue, ms * kCueTick)) > 0.01;
    trembles += loud && quiet > 20 ? 1 : 0;
    quiet = loud ? 0 : quiet + 1;
  }
  return trembles;
}

TEST(CueForce, PushesNowhereAndStaysWithinTheStepLimit) {
  for (const Cue cue : kAll) {
    double last = 0.0, sum = 0.0, travel = 0.0, most_travel = 0.0, largest = 0.0;
    for (int ms = 0; ms < 1000; ++ms) {
      const double f = cue_force(cue, ms * kCueTick);
      EXPECT_LT(std::abs(f - last), 0.05);
      largest = std::max(largest, std::abs(f));
      sum += f * kCueTick;
      travel += sum * kCueTick;  // of a kilogram
      most_travel = std::max(most_travel, std::abs(travel));
      last = f;
    }
    EXPECT_NEAR(sum, 0.0, 1e-6);
    EXPECT_LT(most_travel, 2e-4) << "0.2 mm";
    EXPECT_GT(largest, 0.1);
    EXPECT_LE(largest, kLargestCue);
  }
}

TEST(CueForce, ThoseOfTheLinkBeginWhenTheForceHasLeft) {
  for (int ms = 0; ms <= 50; ++ms) {
    EXPECT_EQ(cue_force(Cue::kHold, ms * kCueTick), 0.0);
    EXPECT_EQ(cue_force(Cue::kLost, ms * kCueTick), 0.0);
  }
}

TEST(CueForce, NoTwoCausesFeelTheSame) {
  EXPECT_EQ(trembles_of(Cue::kNone), 0);
  EXPECT_EQ(trembles_of(Cue::kLimit), 1);
  EXPECT_EQ(trembles_of(Cue::kHold), 2);
  EXPECT_EQ(trembles_of(Cue::kLost), 3);
  EXPECT_EQ(trembles_of(Cue::kSingularity), 4);
}

TEST(KeptBack, NeedsTwoMillimetresForATenthOfASecondAndEndsBelowOne) {
  KeptBack watch;
  const auto far = [&](double mm, int ticks) {
    Cue cue = Cue::kNone;
    const MotionLedger ledger = kept_back(MotionStage::kLimits, mm * kMm, Reason::kJointSpeed);
    for (int i = 0; i < ticks; ++i) cue = watch.step(ledger, Vec3::Zero(), kCueTick);
    return cue;
  };
  EXPECT_EQ(far(1.9, 1000), Cue::kNone);
  EXPECT_EQ(far(2.1, 99), Cue::kNone);
  EXPECT_EQ(far(1.9, 1), Cue::kNone);
  EXPECT_EQ(far(2.1, 99), Cue::kNone);
  EXPECT_EQ(far(2.1, 3), Cue::kLimit);
  EXPECT_EQ(far(1.1, 1000), Cue::kLimit);
  EXPECT_EQ(far(0.9, 1), Cue::kNone);
  EXPECT_EQ(far(1.5, 1000), Cue::kNone);
}

TEST(KeptBack, TellsLimitsFromSingularitiesAndOnlyThose) {
  const auto cue_of = [](const MotionLedger& ledger) {
    KeptBack watch;
    Cue cue = Cue::kNone;
    for (int i = 0; i < 200; ++i) cue = watch.step(ledger, Vec3::Zero(), kCueTick);
    return cue;
  };
  const double far = 5.0 * kMm;
  EXPECT_EQ(cue_of(kept_back(MotionStage::kReach, far, Reason::kOutOfReach)), Cue::kLimit);
  EXPECT_EQ(cue_of(kept_back(MotionStage::kLimits, far, Reason::kJointRange)), Cue::kLimit);
  EXPECT_EQ(cue_of(kept_back(MotionStage::kSingularity, far, Reason::kSingularity)),
            Cue::kSingularity);
  EXPECT_EQ(cue_of(kept_back(MotionStage::kLimits, far, Reason::kNone)), Cue::kNone)
      << "the lag of any motion";
  for (const MotionStage stage : {MotionStage::kTool, MotionStage::kSmoother, MotionStage::kLink,
                                  MotionStage::kTube, MotionStage::kBumper}) {
    EXPECT_EQ(cue_of(kept_back(stage, far, Reason::kBumper)), Cue::kNone);
  }
  MotionLedger unknown = kept_back(MotionStage::kLimits, far, Reason::kJointRange);
  unknown.known = false;
  EXPECT_EQ(cue_of(unknown), Cue::kNone);
}

TEST(KeptBack, AnArmThatMovesMayLagByATenthOfASecondOfItsWay) {
  for (const double speed : {0.05, 0.5}) {  // [m/s]
    const auto cue_of = [speed](double lag) {
      KeptBack watch;
      Cue cue = Cue::kNone;
      const auto ledger = kept_back(MotionStage::kLimits, lag, Reason::kJointAcceleration);
      Vec3 p(0.3, 0, 0.4);
      (void)watch.step(MotionLedger(), p, kCueTick);
      for (int i = 0; i < 1000; ++i) {
        if (i % 7 == 0) p.y() += speed * 7 * kCueTick;
        cue = watch.step(i < 300 ? MotionLedger() : ledger, p, kCueTick);
      }
      return cue;
    };
    EXPECT_EQ(cue_of(0.09 * speed), Cue::kNone);
    EXPECT_EQ(cue_of(0.11 * speed + 0.0025), Cue::kLimit);
  }
}

TEST(CuePlayer, RepeatsWhileItLastsAndNeverCutsATrembleOff) {
  // Lasting causes that come, go and change at any moment, and news between.
  for (int seed = 0; seed < 50; ++seed) {
    CuePlayer player;
    double sum = 0.0, last = 0.0;
    for (int ms = 0; ms < 4000; ++ms) {
      const int phase = (ms * (7 + seed) / 900) % 3;
      const Cue lasting = ms >= 3000   ? Cue::kNone
                          : phase == 0 ? Cue::kLimit
                          : phase == 1 ? Cue::kSingularity
                                       : Cue::kNone;
      const Cue news = ms == 1000 + 3 * seed ? Cue::kHold : Cue::kNone;
      const double f = player.step(news, lasting, kCueTick);
      EXPECT_LT(std::abs(f - last), 0.05) << ms;
      sum += f * kCueTick;
      last = f;
    }
    EXPECT_EQ(last, 0.0);
    EXPECT_NEAR(sum, 0.0, 1e-6) << seed;
  }
  CuePlayer player;
  int loud = 0;
  for (int ms = 0; ms < 2000; ++ms) {
    loud += std::abs(player.step(Cue::kNone, Cue::kLimit, kCueTick)) > 0.1 ? 1 : 0;
  }
  EXPECT_GT(loud, 4 * 20) << "twice a second";
}

TEST(CuePlayer, ATrembleThatIsCutIsOverAndNewsIsPlayedAfterwards) {
  CuePlayer player;
  for (int ms = 0; ms < 7; ++ms) player.step(Cue::kNone, Cue::kLimit, kCueTick);
  EXPECT_GT(player.step(Cue::kNone, Cue::kLimit, kCueTick), 0.1) << "or this says nothing";
  player.cut(Cue::kHold);
  player.cut(Cue::kNone);
  double largest = 0.0, last = 0.0;
  for (int ms = 0; ms < 350; ++ms) {
    const double f = player.step(Cue::kNone, Cue::kNone, kCueTick);
    EXPECT_LT(std::abs(f - last), 0.05) << ms;
    largest = std::max(largest, std::abs(f));
    last = f;
  }
  EXPECT_GT(largest, 0.1);
}

// The slave is kept back by `by` from the command, for the reason it gives.
class CueOfTheStep : public ::testing::Test {
 protected:
  CueOfTheStep() {
    rig.spring_slack = true;
    rig.engage();
    rig.play_slave = false;
  }
  void keep_back(double by, Reason why) {
    const Vec3 off(by, 0, 0);
    constexpr auto kLimits = static_cast<std::size_t>(FollowStage::kLimits);
    rig.in.slave.ledger.off_S.col(kLimits) = off.cast<float>();
    rig.in.slave.ledger.why[kLimits] = why;
    rig.in.slave.X_ST_command = rig.command();
    rig.in.slave.X_ST_command.p += off;
  }
  // Largest cue and its mean over `ticks`.
  double largest(int ticks) {
    double most = 0.0;
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < ticks; ++i) {
      rig.tick();
      most = std::max(most, rig.out.force.cue.norm());
      sum += rig.out.force.cue;
      EXPECT_LE(rig.out.f_H_M.force.norm(), rig.settings.force.peak + 1e-12);
      EXPECT_EQ(rig.out.force.device, rig.out.f_H_M.force);
    }
    EXPECT_LT(sum.norm() / ticks, 1e-3);
    return most;
  }
  HapticRig rig;
};

TEST_F(CueOfTheStep, AnArmThatIsReallyKeptBackIsFeltWithoutPushing) {
  for (const Reason why : {Reason::kJointRange, Reason::kSingularity}) {
    keep_back(0.003, why);
    EXPECT_EQ(largest(99), 0.0);
    EXPECT_GT(largest(1000), 0.1);
    keep_back(0.0005, Reason::kJointSpeed);
    largest(500);
    EXPECT_EQ(largest(500), 0.0);
  }
}

TEST_F(CueOfTheStep, OrdinaryFollowingIsNotFelt) {
  for (int i = 0; i < 3000; ++i) {
    const double lag = 0.0015 + 0.001 * std::sin(0.05 * i);  // over 2 mm now and then
    keep_back(lag, i % 100 < 90 ? Reason::kJointAcceleration : Reason::kNone);
    rig.tick();
    ASSERT_EQ(rig.out.force.cue, Vec3(Vec3::Zero())) << i;
  }
}

// The whole loop, with a slave that plans: what a hand ordinarily does is never felt.
TEST(HapticCueLoop, AHandThatWorksFeelsNothingAndOneThatReachesTooFarDoes) {
  test::LoopRig loop;
  loop.master.order(OrderKind::kEngage);
  for (int i = 0; i < 200; ++i) loop.tick();
  ASSERT_EQ(loop.master.session(), SessionState::kEngaged);
  const Pose start = loop.master.in.hand.X_MH;
  double back = 0.0;
  for (int i = 0; i < 10'000; ++i) {
    const double t = i * kCueTick;
    const Vec3 way(std::sin(4.1 * t), std::sin(5.3 * t), std::sin(6.1 * t));
    loop.master.in.hand.X_MH.p = start.p + 10.0 * kMm * way;
    loop.master.in.hand.X_MH.q = rotation_exp(0.1 * way) * start.q;
    loop.tick();
    back = std::max(back, loop.stage(MotionStage::kLimits).norm());
    ASSERT_EQ(loop.master.out.force.cue, Vec3(Vec3::Zero())) << i;
  }
  EXPECT_GT(back, 2.0 * kMm) << "or this says nothing";
  const Vec3 outward = loop.master.state->command.engagement.to_hand({0.2, 0, 0});
  double felt = 0.0;
  for (int i = 0; i < 6000; ++i) {
    loop.master.in.hand.X_MH.p += kCueTick / 2.0 * outward;
    loop.tick();
    felt = std::max(felt, loop.master.out.force.cue.norm());
  }
  EXPECT_GT(felt, 0.1);
}

TEST_F(CueOfTheStep, BesideAForceAtTheDevicesPeakThereIsNoRoomForACue) {
  rig.settings.spring_stiffness = 4000.0;
  rig.in.slave.X_ST.p += Vec3(0, 0, 0.02);
  keep_back(0.02, Reason::kJointSpeed);
  largest(3000);
  EXPECT_GT(rig.most_force, 0.99 * rig.settings.force.peak);
}

TEST_F(CueOfTheStep, ACueDoesNotComeBackInTheMiddleWhenTheHandIsHeardAgain) {
  keep_back(0.003, Reason::kJointSpeed);
  double before = 0.0;
  for (int i = 0; i < 2000; ++i) {
    // One reading in every eight is missing, wherever the tremble stands.
    rig.in.hand.valid = i % 8 != 0;
    rig.tick();
    if (rig.in.hand.valid) {
      ASSERT_LT(rig.force_step, 0.05) << i;
    } else {
      before = std::max(before, rig.force_step);
    }
  }
  EXPECT_GT(before, 0.1) << "a tremble was cut, or this says nothing";
}

TEST(HapticCueLink, ALostLinkIsFeltOnceAndThenThereIsNoForce) {
  HapticRig rig;
  rig.engage();
  double hold = 0.0, lost = 0.0, after = 0.0;
  for (int ms = 1; ms <= 2000; ++ms) {
    rig.in.slave_age = ms * kMillisecond;
    rig.tick();
    const double f = rig.out.f_H_M.force.norm();
    double& most = ms <= 200 ? hold : ms <= 900 ? lost : after;
    most = std::max(most, f);
    if (ms == 71) {
      EXPECT_LT(f, 1e-9);
    }
  }
  EXPECT_GT(hold, 0.1);
  EXPECT_GT(lost, 0.1);
  EXPECT_EQ(after, 0.0);
}

}  // namespace
}  // namespace handrail
