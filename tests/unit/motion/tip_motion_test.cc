#include "server/motion/tip_motion.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/arm_samples.h"
#include "tests/unit/motion/motion_rig.h"

namespace handrail {
namespace {

using test::between;
using test::joints_deg;
using test::kHome;
using test::MotionRig;
using test::normal;

TipSpace space_of(int free, const Vec3& p, Random& random) {
  const Vec3 d = normal(random).normalized();
  if (free == 0) return point_space(p);
  if (free == 1) return line_space(p, d);
  if (free == 2) return plane_space(p, d);
  return {};
}

// How many directions are free, and whether the tip is mounted aside of the flange's axis and
// turned.
struct Way {
  int free;
  bool mounted;
};
class TipMotionIn : public testing::TestWithParam<Way> {};

// Targets that jump, wave and shake, in and out of reach; stops asked for at any time.
TEST_P(TipMotionIn, ItsSpaceStaysThereAndWithinEveryLimitAndStopsInTimeWithoutTheGuard) {
  Random random(3);
  int stops = 0;
  ArmGeometry arm;
  if (GetParam().mounted) arm.X_AT = test::bent();
  for (int run = 0; run < 12; ++run) {
    JointVector q = kHome;
    for (int i = 0; i < kJoints; ++i) q[i] += between(random, -0.4, 0.4);
    MotionRig rig(q, arm);
    const Pose start = rig.state.X_ST;
    rig.space = space_of(GetParam().free, start.p, random);
    const Vec3 direction = normal(random).normalized();
    Pose aim = start;
    int mode = 0, left = 0;
    for (int k = 0; k < 600; ++k) {
      if (left-- <= 0) {
        mode = static_cast<int>(between(random, 0, 4));
        left = 30 + static_cast<int>(between(random, 0, 60));
        aim.p = start.p + 0.15 * normal(random);
        aim.q = (rotation_exp(0.5 * normal(random)) * start.q).normalized();
      }
      Pose target = aim;
      if (mode == 1) target.p = start.p + 0.1 * std::sin(0.0446 * k) * direction;
      if (mode == 2) target.p += 0.02 * normal(random);
      if (k % 75 == 74) {
        ASSERT_LE(rig.cycles_to_stop(), rig.stop_bound()) << "run " << run << " cycle " << k;
        ++stops;
      }
      rig.follow(target);
    }
    ASSERT_TRUE(rig.watch.kept()) << run;
    ASSERT_EQ(rig.guarded, 0) << run;
    ASSERT_LT(rig.off_space, 1e-8) << run;
    ASSERT_LT(rig.off_rest, 1e-8) << run;
  }
  EXPECT_EQ(stops, 12 * 8);
}

INSTANTIATE_TEST_SUITE_P(PointLinePlaneAndFree, TipMotionIn,
                         testing::Values(Way{0, false}, Way{1, false}, Way{2, false}, Way{3, false},
                                         Way{0, true}, Way{1, true}, Way{2, true}, Way{3, true}));

// Delay and shape error of the tip behind a sine of 1 Hz, best fit.
struct Lag {
  double delay = 0.0;  // [s]
  double shape = 0.0;  // [m] rms
};

Lag lag_of(double amplitude) {
  MotionRig rig(kHome);
  const Pose start = rig.state.X_ST;
  std::vector<double> tip, when;
  for (int k = 0; k < 1500; ++k) {
    const double t = k * rig.settings.dt;
    rig.follow({start.p + Vec3(0, amplitude * std::sin(2.0 * std::numbers::pi * t), 0), start.q});
    if (k < 300) continue;
    tip.push_back(rig.state.X_ST.p.y() - start.p.y());
    when.push_back(t);
  }
  EXPECT_EQ(rig.guarded, 0);
  EXPECT_TRUE(rig.watch.kept());
  Lag best{0.0, 1e9};
  for (double delay = 0.0; delay < 0.15; delay += 0.0005) {
    double sum = 0.0;
    for (std::size_t k = 0; k < tip.size(); ++k) {
      const double wanted = amplitude * std::sin(2.0 * std::numbers::pi * (when[k] - delay));
      sum += (tip[k] - wanted) * (tip[k] - wanted);
    }
    const double rms = std::sqrt(sum / static_cast<double>(tip.size()));
    if (rms < best.shape) best = {delay, rms};
  }
  return best;
}

// What stopping on the command wherever it may end costs: v/2a + a/2j.
TEST(TipMotion, FollowsAHandAtOneHertzWithTheLagOfItsLimitsAndNoMore) {
  const Lag small = lag_of(0.025), middle = lag_of(0.05), large = lag_of(0.1);
  RecordProperty("lag_25mm_ms", std::to_string(1e3 * small.delay));
  RecordProperty("lag_50mm_ms", std::to_string(1e3 * middle.delay));
  RecordProperty("lag_100mm_ms", std::to_string(1e3 * large.delay));
  EXPECT_LT(small.delay, 0.021);
  EXPECT_LT(middle.delay, 0.033);
  EXPECT_LT(large.delay, 0.055);
  EXPECT_LT(small.shape, 0.4e-3);
  EXPECT_LT(middle.shape, 1.3e-3);
}

// A tip that holds its place, give or take, still turns as fast as it can, free or on a line.
TEST(TipMotion, ATurnIsNotHeldUpByAPlaceThatIsAllButReached) {
  for (const bool on_line : {false, true}) {
    MotionRig rig(kHome);
    const Pose start = rig.state.X_ST;
    if (on_line) rig.space = line_space(start.p, Vec3::UnitY());
    Random random(8);
    double behind = 0.0;
    for (int k = 0; k < 1500; ++k) {
      const double t = k * rig.settings.dt;
      const Vec3 turn(0.1 * std::sin(3.0 * t), 0.1 * std::sin(3.7 * t), 0.1 * std::sin(2.3 * t));
      rig.follow({start.p + 2e-5 * normal(random), (rotation_exp(turn) * start.q).normalized()});
      if (k > 100) {
        behind = std::max(behind, angle_between(rig.state.X_ST.q, rotation_exp(turn) * start.q));
      }
    }
    EXPECT_LT(behind, 0.06) << on_line;
    EXPECT_EQ(rig.guarded, 0);
  }
}

// A fifth of what the joints can do: three axes of place and of turn at 0.65 to 1 Hz.
TEST(TipMotion, FollowsAHandThatMovesAndTurnsInEveryAxis) {
  for (const bool wide : {false, true}) {
    MotionRig rig(kHome);
    const Pose start = rig.state.X_ST;
    double place = 0.0, turn = 0.0;
    for (int k = 0; k < 3000; ++k) {
      const double t = k * rig.settings.dt;
      const Vec3 way(std::sin(4.1 * t), std::sin(5.3 * t), std::sin(6.1 * t));
      const Pose target{start.p + (wide ? 0.025 : 0.01) * way,
                        (rotation_exp(0.1 * way) * start.q).normalized()};
      rig.follow(target);
      if (k < 200) continue;
      place = std::max(place, (rig.state.X_ST.p - target.p).norm());
      turn = std::max(turn, angle_between(rig.state.X_ST.q, target.q));
    }
    EXPECT_LT(place, wide ? 0.018 : 0.0025);
    EXPECT_LT(turn, wide ? 0.18 : 0.04);
    EXPECT_EQ(rig.guarded, 0);
    EXPECT_TRUE(rig.watch.kept());
  }
}

TEST(TipMotion, KeepsOffTheFacesOfTheWorkspaceMovesAlongThemAndComesBack) {
  constexpr double kRoom = 0.05;  // to the face [m]
  for (int face = 0; face < 6; ++face) {
    MotionRig rig(kHome);
    const Pose start = rig.state.X_ST;
    const int k = face / 2;
    Vec3 out = Vec3::Zero();
    out[k] = face % 2 == 0 ? 1.0 : -1.0;
    Workspace& box = rig.settings.workspace;
    (face % 2 == 0 ? box.high : box.low)[k] = start.p[k] + kRoom * out[k];
    const Vec3 a = out.unitOrthogonal(), b = out.cross(a);
    double furthest = 0.0, behind = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const double t = i * rig.settings.dt;
      const double far = 0.075 * (1.0 - std::cos(0.6 * t));
      const Vec3 along = 0.03 * (std::sin(2.0 * t) * a + std::cos(2.0 * t) * b);
      rig.follow({start.p + far * out + along, start.q});
      const Vec3 way = rig.state.X_ST.p - start.p;
      furthest = std::max(furthest, way.dot(out));
      // Where the hand is beyond the face the tip follows it along, elsewhere everywhere.
      Vec3 off = start.p + far * out + along - rig.state.X_ST.p;
      if (far > kRoom - 0.01) off -= off.dot(out) * out;
      if (i > 200) behind = std::max(behind, off.norm());
    }
    EXPECT_LT(furthest, kRoom) << face;
    EXPECT_GT(furthest, kRoom - 0.006) << face;
    EXPECT_LT(behind, 0.003) << face;
    EXPECT_EQ(rig.frozen, 0) << face;
    EXPECT_EQ(rig.guarded, 0) << face;
  }
}

// On its way as three commands left it, with a stop planned.
MotionRig moving(const JointVector& q, const JointVector& step, const JointVector& change) {
  MotionRig rig(q);
  const auto tip = [&](const JointVector& at) { return forward(rig.settings.arm, at); };
  MotionState& state = rig.state;
  state.joints.step = step;
  state.joints.change = change;
  const Pose before = tip(q - step), first = tip(q - step - (step - change));
  state.tip_step = handrail::between(before, state.X_ST);
  const Twist last = handrail::between(first, before);
  state.tip_change = state.tip_step - last;
  Verdict why;
  EXPECT_TRUE(plan_stop(rig.motion().limits(), rig.space, state, TipPlace(rig.settings.arm, q),
                        Stopping::kAsOne, state.stop, why));
  return rig;
}

// Cycles until the tip moves no more.
int cycles_to_rest(MotionRig& rig, const Pose& target) {
  constexpr double kStill = 1e-6;  // a cycle [m]
  int last = 0;
  for (int k = 1; k <= 200; ++k) {
    rig.follow(target);
    if (rig.state.tip_step.linear.norm() > kStill) last = k;
  }
  return last;
}

// A tip that passes its place at 60 mm/s, 0.8 mm beside it. To stop and to go back, half of the way
// faster and half of it slower, takes no longer than three stops.
TEST(TipMotion, ComesToRestOnATargetThatStandsBesideItsWayInsteadOfOrbitingIt) {
  JointVector q, step, change;
  q << 0.0772123, -0.1044514, 1.6750691, -0.0938873, 1.5114434, 0.0799931;
  step << -1.02417e-3, 1.06782e-3, -1.39033e-3, 6.25e-5, 2.2504e-4, -1.05175e-3;
  change << -3.8664e-4, -1.5517e-4, 3.0971e-4, 2.191e-5, -1.9008e-4, -3.7119e-4;
  MotionRig rig = moving(q, step, change);
  const double bound = 3.0 * rig.stop_bound();
  const Pose target{Vec3(0.34247676, -0.00205152, 0.42904866), rig.state.X_ST.q};
  EXPECT_LT(cycles_to_rest(rig, target), bound);
  EXPECT_LT((rig.state.X_ST.p - target.p).norm(), 1e-6);
  EXPECT_EQ(rig.guarded, 0);
}

// Up to 3 mm to any side of a tip that moves at up to 0.15 m/s, all over the arm's reach.
TEST(TipMotion, IsAtRestWithinHalfASecondWhereverBesideItsWayTheTargetStands) {
  Random random(5);
  for (int run = 0; run < 400; ++run) {
    JointVector q = joints_deg(0, 0, 90, 0, 60, 0);
    for (int i = 0; i < kJoints; ++i) q[i] += between(random, -0.3, 0.3);
    MotionRig rig(q);
    const Pose start = rig.state.X_ST;
    const Vec3 way = between(random, 0.02, 0.15) * rig.settings.dt * normal(random).normalized();
    for (int k = 0; k < 40; ++k) rig.follow({start.p + k * way, start.q});
    const Vec3 beside = between(random, 0.0002, 0.003) * normal(random).normalized();
    const Pose target{rig.state.X_ST.p + beside, start.q};
    ASSERT_LT(cycles_to_rest(rig, target) * rig.settings.dt, 0.5) << run;
    ASSERT_LT((rig.state.X_ST.p - target.p).norm(), 1e-6) << run;
  }
}

// Where no tool holds the tip its stop is only led along its way: third order is left out.
TEST(TipMotion, AStopThatNoToolHoldsStaysBesideItsWay) {
  constexpr double kUnheld = 2e-3;  // [m]
  Random random(17);
  double worst = 0.0, fastest = 0.0;
  for (int run = 0; run < 300; ++run) {
    JointVector q = kHome;
    for (int i = 0; i < kJoints; ++i) q[i] += between(random, -0.5, 0.5);
    MotionRig rig(q);
    const Pose start = rig.state.X_ST;
    const Vec3 way = between(random, 0.05, 0.4) * normal(random).normalized();
    const int cycles = static_cast<int>(between(random, 5, 60));
    for (int k = 0; k < cycles; ++k) rig.follow({start.p + way, start.q});
    const double speed = rig.state.tip_step.linear.norm() / rig.settings.dt;
    if (speed < 0.01) continue;
    fastest = std::max(fastest, speed);
    const Vec3 from = rig.state.X_ST.p, along = rig.state.tip_step.linear.normalized();
    for (int k = 0; k < 64; ++k) {
      rig.stop();
      const Vec3 d = rig.state.X_ST.p - from;
      worst = std::max(worst, (d - along.dot(d) * along).norm());
    }
  }
  std::printf("[ measured ] %.3f mm beside at up to %.2f m/s\n", 1e3 * worst, fastest);
  EXPECT_GT(fastest, 0.5);
  EXPECT_LT(worst, kUnheld);
}

// Below two cycles of a/j nearly every stop was refused, as too long by the landing on cycles: the
// same way took seven times as long. A sixth more is what a shorter stop costs.
TEST(TipMotion, ALargerJerkHardlyMakesItSlower) {
  int fewest = 1000;
  for (const double per_second : {20.0, 50.0, 100.0, 200.0, 1000.0, 10000.0}) {
    MotionRig rig(kHome);
    rig.settings.limits.max_acceleration = JointVector::Constant(30.0 * kDeg);
    rig.settings.limits.max_jerk = per_second * rig.settings.limits.max_acceleration;
    const Pose start = rig.state.X_ST;
    const Pose target{start.p + Vec3(0.02, 0.05, -0.02),
                      rotation_exp(14.0 * kDeg * Vec3(0.0, 0.6, 0.8)) * start.q};
    int cycles = 0;
    while (cycles < 1000 && ((rig.state.X_ST.p - target.p).norm() > 1e-4 ||
                             angle_between(rig.state.X_ST.q, target.q) > 1e-3)) {
      ++cycles;
      rig.follow(target);
    }
    fewest = std::min(fewest, cycles);
    EXPECT_LE(cycles, 1.25 * fewest) << per_second;
    EXPECT_EQ(rig.guarded, 0) << per_second;
    EXPECT_TRUE(rig.watch.kept()) << per_second;
  }
}

// A poor link stops the arm again and again, between a few cycles of following. What it sets out
// with leads to the target all the same: joints each on their own way took the tip 12 mm off.
TEST(TipMotion, StaysAmongItsTargetsHoweverOftenItIsStopped) {
  const JointVector home(0.0, 0.1, 1.4, 0.0, 1.64, 0.0);
  double furthest = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Random random(seed);
    MotionRig rig(home);
    const Pose start = rig.state.X_ST;
    Vec3 low = start.p, high = start.p;
    int follows = 0, stops = 0;
    for (int k = 0; k < 8450; ++k) {
      const double t = k * rig.settings.dt;
      Pose target = start;
      for (int i = 0; i < 3; ++i) {
        target.p[i] += 0.03 * std::sin(2.0 * std::numbers::pi * (0.5 + 0.1 * i) * t);
      }
      target.q = rotation_exp(0.15 * std::sin(4.4 * t) * Vec3::UnitY()) * start.q;
      low = low.cwiseMin(target.p);
      high = high.cwiseMax(target.p);
      if (follows == 0 && stops == 0) {
        follows = 1 + static_cast<int>(5.0 * random.uniform());
        stops = 1 + static_cast<int>(4.0 * random.uniform());
      }
      if (follows > 0) {
        --follows;
        rig.follow(target);
      } else {
        --stops;
        rig.stop();
      }
      const Vec3& p = rig.state.X_ST.p;
      furthest = std::max({furthest, (low - p).maxCoeff(), (p - high).maxCoeff()});
    }
    EXPECT_TRUE(rig.watch.kept());
  }
  EXPECT_LT(furthest, 0.008);  // 5 mm, and 3 mm of a stop at 60 mm/s in 0.1 s
}

}  // namespace
}  // namespace handrail
