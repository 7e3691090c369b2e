// One cell in virtual time: engages, follows, repeats bit for bit, at several transit times.
#include "server/lab/cell.h"

#include <gtest/gtest.h>

#include <memory>

#include "devices/omni/omni_data.h"
#include "server/base/fnv.h"
#include "server/kinematics/rv2a.h"
#include "server/master/haptic_settings.h"
#include "server/slave/follow_settings.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

std::unique_ptr<Cell> make_cell(Nanos transit, std::uint64_t seed = 1) {
  Scene scene;
  scene.name = "test";
  scene.limits.joints = rv2a_limits();
  CellOptions options;
  options.haptic = haptic_settings(scene, omni_capabilities(false));
  options.follow = follow_settings(scene, options.rig.controller.period, true, 1000.0);
  options.rig.controller.arm.seed = seed;
  options.rig.controller.arm.geometry.d6 = scene.tip_length;
  options.transit = transit;
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

// Ticks with an engage order until engaged, at most a second; how many it took.
int engage(Cell& cell) {
  int ticks = 0;
  while (cell.master_state().session != SessionState::kEngaged && ticks < 1000) {
    cell.tick(hand_at(Vec3::Zero()), order_of(OrderKind::kEngage));
    ++ticks;
  }
  return ticks;
}

class CellTransit : public ::testing::TestWithParam<int> {};

TEST_P(CellTransit, EngagesWithoutMotionAndBringsTheTipToTheHand) {
  const auto cell = make_cell(GetParam() * kMillisecond);
  const JointVector before = cell->rig().controller().arm().target();
  EXPECT_LT(engage(*cell), 1000);
  EXPECT_EQ(cell->slave().state, SessionState::kEngaged);
  EXPECT_LT((cell->rig().controller().arm().target() - before).cwiseAbs().maxCoeff(), 1e-6);
  const Vec3 start = cell->master().link.X_SU.p;
  for (int i = 0; i < 3000; ++i) {
    const double way = std::min(1.0, i * 1e-3) * 0.02;  // hand 20 mm to the right
    cell->tick(hand_at(Vec3(way, 0, 0)));
    ASSERT_EQ(cell->slave().state, SessionState::kEngaged);
  }
  const Vec3 wanted = start - 0.04 * Vec3::UnitY();
  EXPECT_LT((cell->master().link.X_SU.p - wanted).norm(), 1e-6);
  EXPECT_LT((cell->slave().X_ST_command.p - wanted).norm(), 1e-6);
  EXPECT_LT((cell->slave().X_ST.p - wanted).norm(), 0.5e-3);
}

INSTANTIATE_TEST_SUITE_P(Milliseconds, CellTransit, ::testing::Values(0, 3, 30));

// Ticks from the hand's first motion to the first step of the slave's command.
int ticks_to_react(Nanos transit) {
  const auto cell = make_cell(transit);
  engage(*cell);
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
  engage(*cell);
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
  engage(*cell);
  test::NoAllocation guard("a tick of the cell");
  for (int i = 0; i < 500; ++i) cell->tick(hand_at(Vec3(1e-5 * i, 0, 0)));
}

std::uint64_t fingerprint(std::uint64_t seed) {
  const auto cell = make_cell(3 * kMillisecond, seed);
  engage(*cell);
  Fnv fnv;
  for (int i = 0; i < 1000; ++i) {
    cell->tick(hand_at(Vec3(2e-5 * i, 1e-5 * i, 0)));
    for (int j = 0; j < kJoints; ++j) {
      fnv.f64(cell->slave().q_measured[j]);
    }
    for (int k = 0; k < 3; ++k) {
      fnv.f64(cell->master().f_H_M.force[k]);
    }
  }
  return fnv.value();
}

TEST(CellTest, TheSameSeedGivesTheSameBitsAndAnotherOneOthers) {
  EXPECT_EQ(fingerprint(1), fingerprint(1));
  EXPECT_NE(fingerprint(1), fingerprint(2));
}

}  // namespace
}  // namespace handrail
