// The simulated operator against facts about people.
#include "devices/hand/operator_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "server/base/units.h"
#include "tests/support/no_allocation.h"
#include "tests/unit/hand/desk.h"

namespace handrail {
namespace {

using test::Desk;
using test::kTick;
using test::steady;

TEST(OperatorModel, SeesADisturbanceOnlyAfterTheVisionDelay) {
  const OperatorParameters p = steady();
  for (int phase = 0; phase < 30; ++phase) {
    Desk desk(p);
    desk.reach(Vec3::Zero());
    for (int i = 0; i < 1000 + 10 * phase; ++i) desk.tick();
    ASSERT_EQ(desk.hand_steered_.orders, 0) << "nothing to correct yet";
    desk.pushed_ = Vec3(0.02, 0.0, 0.0);
    const double pushed_at = desk.now_;
    while (desk.hand_steered_.orders == 0 && desk.now_ - pushed_at < 2.0) desk.tick();
    const double reaction = desk.now_ - pushed_at;
    EXPECT_GE(reaction, p.vision_delay - 1e-9);
    EXPECT_LE(reaction, p.vision_delay + p.plan_interval + 0.01);
  }
}

TEST(OperatorModel, ASingleSubmovementIsMinimumJerk) {
  OperatorParameters p = steady();
  p.gain = 1.0;
  Desk desk(p);
  constexpr double kDistance = 0.02;
  desk.reach(Vec3(kDistance, 0.0, 0.0));
  double fastest = 0.0, fastest_at = 0.0, started = -1.0, ended = 0.0;
  for (int i = 0; i < 2000; ++i) {
    desk.tick();
    const double speed = desk.hand_.position().v.norm();
    if (speed > 1e-6 && started < 0.0) started = desk.now_;
    if (speed > 1e-6) ended = desk.now_;
    if (speed > fastest) {
      fastest = speed;
      fastest_at = desk.now_;
    }
  }
  EXPECT_EQ(desk.hand_steered_.orders, 1) << "what is under way is not asked for again";
  EXPECT_NEAR(fastest, 1.875 * kDistance / p.submovement, 1e-4);
  EXPECT_NEAR(ended - started, p.submovement, 0.02);
  EXPECT_NEAR(fastest_at, 0.5 * (started + ended), 0.01) << "symmetric";
}

TEST(OperatorModel, AimingTakesTimeAfterFittsLaw) {
  // Movement time over the index of difficulty log2(2 D / W), W = 2 tolerances.
  std::vector<double> difficulty, time;
  for (const double distance : {0.02, 0.04, 0.08, 0.16}) {
    for (const double tolerance : {1e-3, 2e-3, 4e-3, 8e-3}) {
      OperatorParameters p = steady();
      p.motor_noise = 0.15;
      p.tolerance = tolerance;
      double sum = 0.0;
      constexpr int kReaches = 40;
      for (int seed = 1; seed <= kReaches; ++seed) {
        Desk desk(p, static_cast<std::uint64_t>(seed));
        desk.reach(Vec3(0.6 * distance, 0.8 * distance, 0.0));
        sum += desk.until_arrived();
      }
      difficulty.push_back(std::log2(distance / tolerance));
      time.push_back(sum / kReaches);
    }
  }
  const auto n = static_cast<double>(time.size());
  double sx = 0.0, sy = 0.0, sxx = 0.0, syy = 0.0, sxy = 0.0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    sx += difficulty[i];
    sy += time[i];
    sxx += difficulty[i] * difficulty[i];
    syy += time[i] * time[i];
    sxy += difficulty[i] * time[i];
  }
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  const double fit = std::pow(n * sxy - sx * sy, 2) / ((n * sxx - sx * sx) * (n * syy - sy * sy));
  EXPECT_GT(slope, 0.1) << "s/bit; direct stylus about 0.1";
  EXPECT_LT(slope, 0.5) << "s/bit; tele-operation 0.2 to 0.5";
  EXPECT_GT(fit, 0.9) << "r^2 of the straight line";
}

TEST(OperatorModel, TheEndOfASubmovementScattersWithItsSize) {
  for (const double distance : {0.01, 0.04}) {
    OperatorParameters p = steady();
    p.gain = 1.0;
    p.motor_noise = 0.15;
    p.plan_interval = 5.0;  // one submovement alone
    double square = 0.0;
    constexpr int kReaches = 1000;
    for (int seed = 1; seed <= kReaches; ++seed) {
      Desk desk(p, static_cast<std::uint64_t>(seed));
      desk.reach(Vec3(distance, 0.0, 0.0));
      for (int i = 0; i < 700; ++i) desk.tick();
      square += (desk.hand_.position().p - Vec3(distance, 0.0, 0.0)).squaredNorm();
    }
    EXPECT_NEAR(std::sqrt(square / kReaches) / distance, 0.15, 0.01);
  }
}

TEST(OperatorModel, JudgesDepthWorseThanWhatLiesAcrossTheLineOfSight) {
  OperatorParameters p = steady();
  p.gain = 1.0;
  p.plan_interval = 5.0;
  p.tolerance = p.threshold = 1e-9;
  p.vision_noise_lateral = 1.4e-3;
  p.vision_noise_depth = 2.6e-3;
  Vec3 square = Vec3::Zero();
  constexpr int kLooks = 2000;
  for (int seed = 1; seed <= kLooks; ++seed) {
    Desk desk(p, static_cast<std::uint64_t>(seed));
    desk.reach(Vec3::Zero());
    for (int i = 0; i < 700; ++i) desk.tick();
    square += desk.hand_.position().p.cwiseAbs2();  // it "corrects" what it misjudged
  }
  const Vec3 rms = (square / kLooks).cwiseSqrt();
  EXPECT_NEAR(rms.x(), 1.4e-3, 0.1e-3);
  EXPECT_NEAR(rms.y(), 1.4e-3, 0.1e-3);
  EXPECT_NEAR(rms.z(), 2.6e-3, 0.15e-3);
}

TEST(OperatorModel, KeepsToItsSpeedOnAPathAndToThePath) {
  OperatorParameters p = steady();
  p.speed = 0.04;
  Desk desk(p);
  OperatorAim aim;
  aim.X_SG.p = Vec3(0.15, 0.0, 0.0);
  aim.path = true;
  desk.aim(aim);
  double at_start = 0.0, at_end = 0.0;
  while (desk.tip_.p.x() < 0.05) desk.tick();
  at_start = desk.now_;
  while (desk.tip_.p.x() < 0.12) desk.tick();
  at_end = desk.now_;
  EXPECT_NEAR(0.07 / (at_end - at_start), 0.04, 0.002);
  EXPECT_LT(desk.until_arrived(), 10.0);
  EXPECT_LT((desk.tip_.p - aim.X_SG.p).norm(), p.tolerance);
}

TEST(OperatorModel, BringsATipPushedOffThePathBack) {
  OperatorParameters p = steady();
  Desk desk(p);
  OperatorAim aim;
  aim.X_SG.p = Vec3(0.15, 0.0, 0.0);
  aim.path = true;
  desk.aim(aim);
  desk.pushed_ = Vec3(0.0, 0.01, 0.0);
  double last = 0.0;
  while (desk.tip_.p.x() < 0.12) {
    desk.tick();
    last = std::abs(desk.tip_.p.y());
  }
  EXPECT_LT(last, p.threshold);
}

TEST(OperatorModel, ComesBackToAnEndItWasPushedFarPast) {
  const OperatorParameters p = steady();
  Desk desk(p);
  OperatorAim aim;
  aim.X_SG.p = Vec3(0.05, 0.0, 0.0);
  aim.path = true;
  desk.pushed_ = Vec3(0.12, 0.0, 0.0);
  desk.aim(aim);
  EXPECT_LT(desk.until_arrived(20.0), 20.0);
  EXPECT_LT((desk.tip_.p - aim.X_SG.p).norm(), p.tolerance);
}

TEST(OperatorModel, TurnsAtItsSpeedAndCallsItDoneOnlyNearTheAim) {
  OperatorParameters p = steady();
  p.turn_speed = 0.6;
  Desk desk(p);
  const Quat aim = rotation_exp({0.0, 0.0, 0.8});
  desk.reach(Vec3::Zero(), aim);
  const double time = desk.until_arrived();
  EXPECT_GT(time, 0.8 / 0.6);
  EXPECT_LT(time, 0.8 / 0.6 + 3.0);
  EXPECT_LT(angle_between(desk.tip_.q, aim), p.angle_threshold);
}

TEST(OperatorModel, PushesOnToAStopUntilItIsFeltAndThenLetsGo) {
  OperatorParameters p = steady();
  Desk desk(p);
  OperatorAim aim;
  aim.X_SG.p = Vec3(0.05, 0.0, 0.0);
  aim.path = aim.stop = true;
  desk.aim(aim);
  constexpr double kStiffness = 800.0;  // of the stop, felt at the hand
  double felt_at = -1.0, most = 0.0;
  while (!desk.mind_->arrived() && desk.now_ < 20.0) {
    desk.tick();
    const double past = std::max(0.0, desk.hand_.position().p.x() - 0.05);
    desk.force_ = Vec3(-kStiffness * past, 0.0, 0.0);
    if (felt_at < 0.0 && -desk.force_.x() > p.stop_force) felt_at = desk.now_;
    most = std::max(most, -desk.force_.x());
  }
  ASSERT_GT(felt_at, 0.0);
  const double called = desk.now_ - felt_at;
  EXPECT_GE(called, std::max(p.touch_delay, p.vision_delay)) << "it looks whether the tip stands";
  EXPECT_LE(called, p.touch_delay + p.submovement + p.vision_delay + 2.0 * p.plan_interval);
  for (int i = 0; i < 1000; ++i) {
    desk.tick();
    desk.force_.x() = -kStiffness * std::max(0.0, desk.hand_.position().p.x() - 0.05);
  }
  EXPECT_LT(-desk.force_.x(), 0.3 * most) << "what was pushed into the stop is let go";
  EXPECT_TRUE(desk.mind_->arrived());
}

OperatorAim by_hand(double way) {
  OperatorAim aim;
  aim.X_SG.p = Vec3(way, 0.0, 0.0);
  aim.path = aim.by_hand = true;
  return aim;
}

TEST(OperatorModel, ByHandGoesAsFarAsMeantWhereverTheTipIsSeen) {
  for (const bool held : {false, true}) {
    for (const double way : {0.05, 0.004}) {
      Desk desk(steady());
      desk.tick();
      desk.held_ = held;
      desk.aim(by_hand(way));
      EXPECT_LT(desk.until_arrived(), 10.0) << held;
      EXPECT_NEAR(desk.hand_.position().p.x(), way, 1e-6) << held;
      EXPECT_NEAR(desk.mind_->meant().x(), way, 1e-12) << held;
    }
  }
}

TEST(OperatorModel, APushByHandEndsWhereItIsFeltAndIsKeptUp) {
  const OperatorParameters p = steady();
  Desk desk(p);
  desk.aim(by_hand(0.1));
  while (desk.hand_.position().p.x() < 0.04) desk.tick();
  desk.force_ = Vec3(-2.0 * p.stop_force, 0.0, 0.0);
  const double felt_at = desk.now_;
  while (!desk.mind_->felt() && desk.now_ - felt_at < 2.0) desk.tick();
  EXPECT_NEAR(desk.now_ - felt_at, p.touch_delay, 5e-3);
  const double there = desk.hand_.position().p.x();
  desk.until_arrived();
  EXPECT_GE(desk.hand_.position().p.x(), there - 1e-6);
  EXPECT_LT(desk.hand_.position().p.x(), 0.06);
}

TEST(OperatorModel, GoesGentlyOnTheLastOfAWayByHand) {
  const OperatorParameters p = steady();
  const auto time = [&](double gentle) {
    Desk desk(p);
    OperatorAim aim = by_hand(0.1);
    aim.speed = 0.5 * p.speed;
    aim.gentle = gentle;
    desk.aim(aim);
    return desk.until_arrived();
  };
  EXPECT_NEAR(time(1.0) - time(0.02), 0.08 / (0.5 * p.speed) - 0.08 / p.speed,
              2.0 * p.plan_interval);
}

TEST(OperatorModel, LeavesToAToolWhatTheToolHolds) {
  const OperatorParameters p = steady();
  const Vec3 axis = Vec3::UnitX();
  OperatorAim aim;
  aim.X_SG = {Vec3(0.03, 0.01, 0.02), rotation_exp({0.5, 0.2, -0.3})};
  aim.minds_place = axis * axis.transpose();
  aim.minds_turn.setZero();
  Desk desk(p);
  desk.aim(aim);
  EXPECT_LT(desk.until_arrived(), 10.0);
  EXPECT_NEAR(desk.hand_.position().p.x(), 0.03, p.tolerance);
  EXPECT_EQ(desk.hand_.position().p.tail<2>().norm(), 0.0);
  EXPECT_EQ(angle_between(desk.hand_.orientation(), Quat::Identity()), 0.0);
}

// The errors that matter are those of one axis of three: a third of the variance, as much care.
TEST(OperatorModel, WhoMindsOneAxisOnlyIsTheMorePrecise) {
  OperatorParameters p = steady();
  p.patience = 1e9;
  OperatorAim aim;
  aim.X_SG.q = rotation_exp(Vec3(0.8 * p.angle_threshold, 0.0, 0.0));
  for (const bool one : {false, true}) {
    if (one) aim.minds_turn = Vec3::UnitX() * Vec3::UnitX().transpose();
    Desk desk(p);
    desk.aim(aim);
    EXPECT_LT(desk.until_arrived(), 10.0);
    EXPECT_EQ(desk.hand_steered_.orders > 0, one);
  }
}

TEST(OperatorModel, TurnsTheLongerWayRoundWhereItIsTold) {
  for (const double sign : {1.0, -1.0}) {
    Desk desk(steady());
    OperatorAim aim;
    aim.X_SG.q = rotation_exp(Vec3(0.0, 0.0, -sign * 150 * kDeg));  // the same as 210 the other way
    aim.way_round = Vec3(0.0, 0.0, sign);
    desk.aim(aim);
    double turned = 0.0;
    Quat last = desk.hand_.orientation();
    for (int i = 0; i < 20000 && !desk.mind_->arrived(); ++i) {
      desk.tick();
      turned += rotation_log(desk.hand_.orientation() * last.conjugate()).z();
      last = desk.hand_.orientation();
    }
    EXPECT_NEAR(turned, sign * 210 * kDeg, 5 * kDeg);
  }
}

TEST(OperatorModel, SeesATipThatIsHeldAtTheStopEvenWithoutForce) {
  OperatorParameters p = steady();
  Desk desk(p);
  OperatorAim aim;
  aim.X_SG.p = Vec3(0.05, 0.0, 0.0);
  aim.path = aim.stop = true;
  desk.aim(aim);
  while (desk.tip_.p.x() < 0.05 && desk.now_ < 10.0) desk.tick();
  desk.held_ = true;
  EXPECT_LT(desk.until_arrived(), 2.0);
}

TEST(OperatorModel, DoesNotCallAStandingTipFarFromTheStopArrived) {
  Desk desk(steady());
  OperatorAim aim;
  aim.X_SG.p = Vec3(0.05, 0.0, 0.0);
  aim.path = aim.stop = true;
  desk.held_ = true;
  desk.aim(aim);
  EXPECT_GE(desk.until_arrived(5.0), 5.0);
}

TEST(OperatorModel, ToleratesMoreTheLongerItTakes) {
  OperatorParameters p = steady();
  p.tolerance = 2e-3;
  p.patience = 2.0;
  Desk desk(p);
  desk.held_ = true;
  desk.tip_.p = Vec3(5e-3, 0.0, 0.0);
  desk.reach(Vec3::Zero());
  // Nothing it does helps: it gives in when 5 mm is tolerated, less what it believes on the way.
  const double time = desk.until_arrived();
  EXPECT_GT(time, 1.0);
  EXPECT_LT(time, 60.0);
}

TEST(OperatorModel, IsTheSameForTheSameSeedAndAllocatesNothing) {
  const OperatorParameters p;
  Desk a(p, 7), b(p, 7), c(p, 8);
  for (Desk* desk : {&a, &b, &c}) desk->reach(Vec3(0.05, 0.0, 0.02));
  {
    const test::NoAllocation guard("OperatorModel::step");
    for (int i = 0; i < 5000; ++i) a.tick();
  }
  for (int i = 0; i < 5000; ++i) b.tick();
  for (int i = 0; i < 5000; ++i) c.tick();
  EXPECT_EQ(a.tip_.p, b.tip_.p);
  EXPECT_NE(a.tip_.p, c.tip_.p);
}

}  // namespace
}  // namespace handrail
