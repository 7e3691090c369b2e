// Targets at the end of reach and beside what is in the way.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/motion/tip_motion.h"
#include "tests/support/arm_samples.h"
#include "tests/unit/motion/motion_rig.h"

namespace handrail {
namespace {

using test::between;
using test::joints_deg;
using test::kHome;
using test::MotionRig;
using test::normal;

JointVector somewhere(Random& random) {
  return joints_deg(between(random, -30, 30), between(random, -20, 20), between(random, 70, 110),
                    between(random, -20, 20), between(random, 70, 110), between(random, -30, 30));
}

// Towards the end of reach the joints may go each by its own way. It must not begin with a detour.
TEST(TipReach, TowardsATargetOutOfReachItGoesAwayByNoMoreThanAWaver) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    MotionRig rig(somewhere(random));
    const Pose target{rig.state.X_ST.p + 0.7 * normal(random).normalized() + Vec3(0.4, 0.0, 0.4),
                      rotation_exp(0.8 * normal(random)) * rig.state.X_ST.q};
    double nearest = 1e9, away = 0.0;
    for (int k = 0; k < 140; ++k) {
      const double now = (rig.state.X_ST.p - target.p).norm();
      nearest = std::min(nearest, now);
      away = std::max(away, now - nearest);
      rig.follow(target);
    }
    EXPECT_LT(away, 5e-3) << "seed " << seed;  // the room that the fault matrix gives
  }
}

// How the tip ends up with a hand that goes far out, turns and then stands [m].
struct Stood {
  double nearest = 1e9;
  double away = 0.0;    // the furthest from it after that
  bool beyond = false;  // it is out of reach
};

// `settles` cycles after the hand came to stand the tip is judged.
Stood behind_a_hand_that_goes_far_out(int seed, double far, int settles) {
  constexpr int kGoes = 200, kStands = 1000;  // cycles
  Random random(static_cast<std::uint64_t>(seed));
  MotionRig rig(somewhere(random));
  const Pose start = rig.state.X_ST;
  const Vec3 way = between(random, 0.1, far) * normal(random).normalized();
  const Vec3 turn = between(random, 0.0, 1.5) * normal(random).normalized();
  Stood stood;
  for (int k = 0; k < kGoes + kStands; ++k) {
    const double done = std::min(1.0, k / static_cast<double>(kGoes));
    const Pose target{start.p + done * way, rotation_exp(done * turn) * start.q};
    rig.follow(target);
    const double now = (rig.state.X_ST.p - target.p).norm();
    if (k < kGoes + settles) continue;
    stood.nearest = std::min(stood.nearest, now);
    stood.away = std::max(stood.away, now - stood.nearest);
  }
  EXPECT_EQ(rig.guarded, 0) << "seed " << seed;
  stood.beyond = rig.state.asked->beyond;
  return stood;
}

// As the arm still turns, the place that it gets to may lie elsewhere at every cycle; it must not
// follow it.
TEST(TipReach, OutOfReachItGoesNoFurtherAwayWhileTheTargetStands) {
  int beyond = 0;
  for (const int seed : {4, 55, 86, 137, 209, 285, 359, 509, 596, 982, 1301, 1785, 2328, 2507}) {
    const Stood stood = behind_a_hand_that_goes_far_out(seed, 0.35, 0);
    beyond += stood.beyond;
    EXPECT_LT(stood.away, 5e-3) << "seed " << seed;  // the room that the fault matrix gives
  }
  EXPECT_EQ(beyond, 14);
}

// The wrist over the base axis, at the end of J2's range: places far apart are as near to the
// target. It went round among them for ever, by up to half a radian a second and 2.7 mm.
TEST(TipReach, OverTheBaseAxisAtTheEndOfARangeItComesToRest) {
  const Vec3 back(-0.06, 0.0, 0.0);  // from where the wrist stands to the axis
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    MotionRig rig(joints_deg(0, -40, 92.9, 0, 90, 0));
    const Pose start = rig.state.X_ST;
    const Vec3 beside(between(random, -1e-3, 1e-3), between(random, -1e-3, 1e-3), 0.0);
    const Vec3 kick(between(random, -3e-3, 3e-3), between(random, -10e-3, 10e-3), 0.0);
    JointVector low = JointVector::Constant(1e9), high = -low;
    Vec3 nearest = Vec3::Constant(1e9), furthest = -nearest;
    constexpr int kGoes = 85, kRings = 280, kStands = 700, kLast = 140;  // cycles
    for (int k = 0; k < kGoes + kRings + kStands; ++k) {
      const double done = std::min(1.0, k / static_cast<double>(kGoes));
      const int rings = k - kGoes;
      const double swing =
          rings > 0 && rings < kRings ? std::exp(-0.047 * rings) * std::sin(0.142 * rings) : 0.0;
      rig.follow({start.p + done * (back + beside) + swing * kick, start.q});
      if (k < kGoes + kRings + kStands - kLast) continue;
      low = low.cwiseMin(rig.state.joints.q), high = high.cwiseMax(rig.state.joints.q);
      nearest = nearest.cwiseMin(rig.state.X_ST.p), furthest = furthest.cwiseMax(rig.state.X_ST.p);
    }
    EXPECT_LT((furthest - nearest).norm(), 1e-5) << "seed " << seed;
    EXPECT_LT((high - low).maxCoeff(), 1e-3) << "seed " << seed;
  }
}

// A target out of reach that moves on may be left as far as it moves itself, and as its turn takes
// the place in reach along. Beside the base axis the tip went 12 mm further away.
TEST(TipReach, OutOfReachATargetThatMovesIsLeftNoFurtherThanItMoves) {
  constexpr int kGoes = 200;  // cycles
  Random random(1148);
  MotionRig rig(somewhere(random));
  const Pose start = rig.state.X_ST;
  const Vec3 way = between(random, 0.1, 0.5) * normal(random).normalized();
  const Vec3 turn = between(random, 0.0, 1.5) * normal(random).normalized();
  double least = 0.0, away = 0.0;
  int beyond = 0;
  for (int k = 0; k < kGoes; ++k) {
    const double done = k / static_cast<double>(kGoes);
    const Pose target{start.p + done * way, rotation_exp(done * turn) * start.q};
    const std::optional<TipTarget> before = rig.state.asked;
    rig.follow(target);
    const double now = (rig.state.X_ST.p - target.p).norm();
    if (before && before->beyond) {
      ++beyond;
      const double went = (target.p - before->X.p).norm() +
                          rig.settings.arm.d6 * angle_between(target.q, before->X.q);
      least = std::min(least + went, now);
    } else {
      least = now;
    }
    away = std::max(away, now - least);
  }
  EXPECT_GT(beyond, 50);
  EXPECT_LT(away, 5e-3);  // the room that the fault matrix gives
}

// Nor where the target is in reach: an arm that turns beside a singular pose, or goes round what
// is in its way, waits until the hand moves on. What it did before the hand stood takes it to a
// stop within 0.4 s.
TEST(TipReach, FromATargetThatStandsItGoesNoFurtherAwayWhereverThatIs) {
  for (const int seed : {13142, 14314, 17917, 20926, 24868, 10534}) {
    const Stood stood = behind_a_hand_that_goes_far_out(seed, 0.5, 56);
    EXPECT_LT(stood.away, 3e-3) << "seed " << seed;
  }
}

// The way out of the one is toward the base, of the other away from it.
TEST(TipReach, TooFarIsOutOfReachAndTooNearIsAJointsRange) {
  for (const bool far : {true, false}) {
    MotionRig rig(kHome);
    const Pose start = rig.state.X_ST;
    const Vec3 p = far ? Vec3(1.2, 0.0, 0.4) : Vec3(0.142, -0.131, 0.117);
    for (int k = 0; k < 300; ++k)
      rig.follow({start.p + std::min(1.0, k / 200.0) * (p - start.p), start.q});
    EXPECT_EQ(rig.verdict.reason, far ? Reason::kOutOfReach : Reason::kJointRange);
    EXPECT_EQ(rig.verdict.joint, 2);
  }
}

struct Push {
  const char* name;
  JointVector q;     // where it starts
  JointVector past;  // whose orientation the far end has; and whose place, if `away` is zero
  Vec3 away;         // the far end from the start [m]
};

class PushedFor60Seconds : public testing::TestWithParam<int> {
 public:
  static Push push() {
    switch (GetParam()) {
      case 0:
        return {"turned through a straight wrist", joints_deg(0, 0, 90, 20, 40, 0),
                joints_deg(0, 0, 90, -40, -29, 0), Vec3::Zero()};
      case 1:
        return {"a millimetre beside a straight wrist", joints_deg(0, 0, 90, 0, 30, 0),
                joints_deg(0, 0, 90, 0, 30, 0), Vec3(0.03, 0.001, 0.16)};
      case 2:
        return {"the wrist over the base axis", joints_deg(0, -30, 150, 0, 60, 0),
                joints_deg(0, -30, 150, 0, 60, 0), Vec3(-0.6, 0.02, 0.2)};
      default: return {"out of reach", kHome, kHome, Vec3(1.5, 0.3, 0.3)};
    }
  }
};

// Of 400 phases of the small circle the longest stand was 19 cycles, 0.135 s, the longest way back
// 322 cycles, 2.3 s.
constexpr double kLongestStand = 0.2;    // [s]
constexpr double kLongestWayBack = 2.5;  // [s]
constexpr int kPhases = 8;

struct Pushed {
  MotionRig rig;
  double way_back = 0.0;  // [s]
};

Pushed push_for_60_seconds(const Push& push, double phase) {
  Pushed out{MotionRig(push.q)};
  MotionRig& rig = out.rig;
  const Pose start = rig.state.X_ST;
  const Quat q_far = forward(rig.settings.arm, push.past).q;
  for (int k = 0; k < 8450; ++k) {
    const double t = k * rig.settings.dt;
    const double far = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * 0.1 * t);
    const double around = 2.0 * std::numbers::pi * 0.25 * t + phase;
    rig.follow({start.p + far * push.away + 0.01 * Vec3(std::sin(around), std::cos(around), 0.0),
                start.q.slerp(far, q_far)});
  }
  int cycles = 0;
  while (cycles < 1000 && ((rig.state.X_ST.p - start.p).norm() > 1e-4 ||
                           angle_between(rig.state.X_ST.q, start.q) > 1e-3)) {
    rig.follow(start);
    ++cycles;
  }
  out.way_back = cycles * rig.settings.dt;
  return out;
}

TEST_P(PushedFor60Seconds, TheArmGoesOnWithoutTheGuardAndComesBack) {
  for (int i = 0; i < kPhases; ++i) {
    const Pushed pushed = push_for_60_seconds(push(), 2.0 * std::numbers::pi * i / kPhases);
    const MotionRig& rig = pushed.rig;
    EXPECT_LT(rig.frozen * rig.settings.dt, kLongestStand) << push().name << ", phase " << i;
    EXPECT_EQ(rig.guarded, 0) << push().name << ", phase " << i;
    EXPECT_TRUE(rig.watch.kept()) << push().name << ", phase " << i;
    EXPECT_LT(pushed.way_back, kLongestWayBack) << push().name << ", phase " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(WristBesideShoulderAndReach, PushedFor60Seconds, testing::Range(0, 4));

}  // namespace
}  // namespace handrail
