// One cell in virtual time: engages, follows, repeats bit for bit, at several transit times and
// haptic rates.
#include "server/lab/cell/cell.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "devices/omni/omni_data.h"
#include "devices/omni/sim_omni.h"
#include "server/base/fnv.h"
#include "server/kinematics/rv2a.h"
#include "server/master/haptic_settings.h"
#include "server/slave/follow_settings.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

std::unique_ptr<Cell> make_cell(Nanos transit, std::uint64_t seed = 1, Nanos tick = kMillisecond,
                                double catch_up = Scene::Guidance().catch_up) {
  Scene scene;
  scene.name = "test";
  scene.limits.joints = rv2a_limits();
  scene.guidance.catch_up = catch_up;
  CellOptions options;
  options.haptic = haptic_settings(scene, omni_capabilities(false));
  options.follow = follow_settings(scene, options.rig.controller.period, true, 1000.0);
  options.rig.controller.arm.seed = seed;
  options.rig.controller.arm.geometry.d6 = scene.tip_length;
  options.transit = transit;
  options.tick = tick;
  return std::make_unique<Cell>(options);
}

HandReading hand_at(const Vec3& p) {
  HandReading hand;
  hand.X_MH.p = p;
  hand.valid = true;
  return hand;
}

HapticOrder order_of(OrderKind kind) {
  HapticOrder order;
  order.kind = kind;
  return order;
}

// Ticks with an engage order until engaged, at most three seconds; how long it took.
Nanos engaged_after(Cell& cell) {
  const Nanos start = cell.now();
  while (cell.master_state().lead.session != SessionState::kEngaged &&
         cell.now() - start < 3 * kSecond) {
    cell.tick(hand_at(Vec3::Zero()), order_of(OrderKind::kEngage));
  }
  return cell.now() - start;
}

// Brings the hand 20 mm to the right within a second, then waits; the cell stays engaged.
void drive_right(Cell& cell, Nanos tick, Nanos duration) {
  const Nanos start = cell.now();
  while (cell.now() - start < duration) {
    const double way = std::min(1.0, to_seconds(cell.now() - start)) * 0.02;
    cell.tick(hand_at(Vec3(way, 0, 0)));
    ASSERT_EQ(cell.slave().state, SessionState::kEngaged) << "tick " << tick;
  }
}

class CellTransit : public ::testing::TestWithParam<int> {};

TEST_P(CellTransit, EngagesWithoutMotionAndBringsTheTipToTheHand) {
  const auto cell = make_cell(GetParam() * kMillisecond);
  const JointVector before = cell->rig().controller().arm().target();
  EXPECT_LT(engaged_after(*cell), 3 * kSecond);
  EXPECT_EQ(cell->slave().state, SessionState::kEngaged);
  EXPECT_LT((cell->rig().controller().arm().target() - before).cwiseAbs().maxCoeff(), 1e-6);
  const Vec3 start = cell->master().link.X_SU.p;
  drive_right(*cell, kMillisecond, 4 * kSecond);
  const Vec3 wanted = start - 0.04 * Vec3::UnitY();
  EXPECT_LT((cell->master().link.X_SU.p - wanted).norm(), 1e-6);
  EXPECT_LT((cell->slave().X_ST_command.p - wanted).norm(), 1e-6);
  EXPECT_LT((cell->slave().X_ST.p - wanted).norm(), 0.5e-3);
}

INSTANTIATE_TEST_SUITE_P(Milliseconds, CellTransit, ::testing::Values(0, 3, 30, 400));

// Master and slave ease alike: neither pulls the arm faster to a tool than the scene says.
TEST(CellTool, BesideTheTipIsRiddenToAtTheScenesPace) {
  for (const double pace : {0.005, 0.02}) {
    const auto cell = make_cell(3 * kMillisecond, 1, kMillisecond, pace);
    engaged_after(*cell);
    const double start = cell->slave().X_ST_command.p.z();
    HapticOrder plane = order_of(OrderKind::kTool);
    plane.tool.kind = ToolKind::kPlane;
    plane.tool.normal_S = Vec3::UnitZ();
    plane.tool.at_present = false;
    plane.tool.p_SA.z() = start - 0.015;
    cell->tick(hand_at(Vec3::Zero()), plane);
    ASSERT_EQ(cell->master().order_result, Reason::kNone);
    const Nanos half = from_seconds(0.0075 / pace);
    for (const Nanos end = cell->now() + half; cell->now() < end;) {
      cell->tick(hand_at(Vec3::Zero()));
    }
    // A tenth of a second of that way is what transit and arm may be late.
    EXPECT_NEAR(cell->slave().X_ST_command.p.z(), start - 0.0075, 0.1 * pace) << pace;
  }
}

class CellRate : public ::testing::TestWithParam<int> {};

TEST_P(CellRate, EngagesAndBringsTheTipToTheHand) {
  const Nanos tick = GetParam() * kMicrosecond;
  const auto cell = make_cell(3 * kMillisecond, 1, tick);
  EXPECT_LT(engaged_after(*cell), kSecond);
  const Vec3 start = cell->master().link.X_SU.p;
  drive_right(*cell, tick, 4 * kSecond);
  const Vec3 wanted = start - 0.04 * Vec3::UnitY();
  EXPECT_LT((cell->master().link.X_SU.p - wanted).norm(), 1e-6);
  EXPECT_LT((cell->slave().X_ST_command.p - wanted).norm(), 1e-6);
  EXPECT_LT((cell->slave().X_ST.p - wanted).norm(), 0.5e-3);
}

// How far the command moves when the hand comes back 5 mm from where it was lost.
double jump_after_losing_the_hand(Nanos tick, Nanos lost_for) {
  const auto cell = make_cell(0, 1, tick);
  engaged_after(*cell);
  for (int i = 0; i < 300; ++i) cell->tick(hand_at(Vec3::Zero()));
  const Vec3 before = cell->master().link.X_SU.p;
  HandReading lost;
  for (Nanos t = 0; t < lost_for; t += tick) cell->tick(lost);
  for (int i = 0; i < 300; ++i) cell->tick(hand_at(Vec3(0.005, 0, 0)));
  return (cell->master().link.X_SU.p - before).norm();
}

// The master lets go of a hand it has not seen for 20 ms.
TEST_P(CellRate, TheMasterKnowsHowLongItsTicksAre) {
  const Nanos tick = GetParam() * kMicrosecond;
  EXPECT_GT(jump_after_losing_the_hand(tick, 10 * kMillisecond), 0.005);
  EXPECT_LT(jump_after_losing_the_hand(tick, 40 * kMillisecond), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Microseconds, CellRate, ::testing::Values(100, 250, 1000, 4000, 10'000));

// The master of a slow loop hears of the slave's newest millisecond: to ask and to be answered
// takes a tick, plus the wait for the controller's cycle.
TEST(CellTest, TheSlaveRepeatsItselfWhateverTheMastersRate) {
  EXPECT_EQ(engaged_after(*make_cell(0, 1, 10 * kMillisecond)), 50 * kMillisecond);
}

TEST(CellTest, SaysWhenTheControllerRanACycle) {
  const auto cell = make_cell(3 * kMillisecond);
  constexpr Nanos kPeriod = 7'100 * kMicrosecond;
  engaged_after(*cell);
  while (cell->now() % (10 * kPeriod) != 0) cell->tick(hand_at(Vec3::Zero()));
  int cycles = 0;
  int moved = 0;
  Vec3 tip = cell->rig().controller().arm().true_tip().p;
  for (int i = 0; i < 7100; ++i) {
    cell->tick(hand_at(Vec3(2e-6 * i, 0, 0)));
    const Vec3 now = cell->rig().controller().arm().true_tip().p;
    if (cell->robot_cycle()) {
      ++cycles;
      EXPECT_EQ(cell->robot_cycle_at() % kPeriod, 0);
      EXPECT_GT(cell->robot_cycle_at(), cell->now() - kMillisecond);
      EXPECT_LE(cell->robot_cycle_at(), cell->now());
    } else {
      EXPECT_EQ(now, tip) << i;
    }
    moved += now == tip ? 0 : 1;
    tip = now;
  }
  EXPECT_EQ(cycles, 1000);  // 140.8 a second
  EXPECT_GT(moved, 950);
}

TEST(CellTest, ALongTickTellsOfItsNewestCycle) {
  const auto cell = make_cell(0, 1, 10 * kMillisecond);
  EXPECT_EQ(cell->robot_cycle_at(), 0);
  for (const int tenths : {71, 142, 284, 355, 497}) {
    cell->tick(hand_at(Vec3::Zero()));
    EXPECT_TRUE(cell->robot_cycle());
    EXPECT_EQ(cell->robot_cycle_at(), tenths * 100 * kMicrosecond);
  }
}

// Ticks from the hand's first motion to the first step of the slave's command.
int ticks_to_react(Nanos transit) {
  const auto cell = make_cell(transit);
  engaged_after(*cell);
  for (int i = 0; i < 300; ++i) cell->tick(hand_at(Vec3::Zero()));
  const Vec3 before = cell->slave().X_ST_command.p;
  for (int i = 1; i < 500; ++i) {
    cell->tick(hand_at(Vec3(0.0005 * i, 0, 0)));
    if ((cell->slave().X_ST_command.p - before).norm() > 1e-6) return i;
  }
  return 500;
}

TEST(CellTest, TheLinkTakesItsTime) {
  const int at_once = ticks_to_react(0);
  EXPECT_LE(at_once, 10);
  EXPECT_GE(ticks_to_react(30 * kMillisecond), at_once + 22);
  EXPECT_LE(ticks_to_react(30 * kMillisecond), at_once + 38);
}

TEST(CellTest, ShowsWhatIsSentToTheController) {
  const auto cell = make_cell(3 * kMillisecond);
  engaged_after(*cell);
  int packets = 0;
  for (int i = 0; i < 710; ++i) {
    cell->tick(hand_at(Vec3::Zero()));
    packets += static_cast<int>(cell->sent().size());
    for (const JointVector& q : cell->sent()) {
      EXPECT_LT((q - cell->rig().controller().arm().target()).cwiseAbs().maxCoeff(), 1e-5);
    }
  }
  EXPECT_NEAR(packets, 100, 1);  // one a controller cycle of 7.1 ms
}

TEST(CellTest, TicksWithoutTouchingTheHeap) {
  const auto cell = make_cell(3 * kMillisecond);
  engaged_after(*cell);
  test::NoAllocation guard("a tick of the cell");
  for (int i = 0; i < 500; ++i) cell->tick(hand_at(Vec3(1e-5 * i, 0, 0)));
}

// Of a simulated hand that pushes against the cell's force, device and arm.
std::uint64_t fingerprint(std::uint64_t seed, std::uint64_t hand_seed, Nanos tick) {
  const auto cell = make_cell(3 * kMillisecond, seed, tick);
  HandOptions hand;
  hand.seed = hand_seed;
  SimOmni omni(hand, false);
  EXPECT_TRUE(omni.open().is_ok());
  HandIntent intent;
  intent.displacement_M = Vec3(0.02, 0.01, 0.0);
  intent.rotation_M = Vec3(0.0, 0.0, 0.3);
  intent.duration = 0.8;
  omni.hand()->steer(intent);
  Fnv fnv;
  while (cell->now() < kSecond) {
    const HapticSample sample = omni.read(cell->now());
    HandReading reading;
    reading.X_MH = sample.X_MH;
    reading.v_MH = sample.v_MH;
    reading.valid = sample.valid;
    cell->tick(reading, cell->now() < kSecond / 5 ? order_of(OrderKind::kEngage) : HapticOrder());
    omni.write(cell->master().f_H_M);
    for (int j = 0; j < kJoints; ++j) fnv.f64(cell->slave().q_measured[j]);
    for (int k = 0; k < 3; ++k) {
      fnv.f64(cell->master().f_H_M.force[k]);
      fnv.f64(sample.X_MH.p[k]);
    }
  }
  EXPECT_EQ(cell->slave().state, SessionState::kEngaged);
  return fnv.value();
}

TEST(CellTest, TheSameSeedsGiveTheSameBitsAndOtherOnesOthers) {
  for (const Nanos tick : {kMillisecond / 4, kMillisecond, 4 * kMillisecond}) {
    EXPECT_EQ(fingerprint(1, 1, tick), fingerprint(1, 1, tick));
    EXPECT_NE(fingerprint(1, 1, tick), fingerprint(2, 1, tick));
    EXPECT_NE(fingerprint(1, 1, tick), fingerprint(1, 2, tick));
  }
}

}  // namespace
}  // namespace handrail
