// The cell over the daemons' own peers and datagrams: it engages, repeats itself bit for bit, and
// its programs can be stopped, stalled and killed.
#include "server/lab/cell/cell_net.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "devices/omni/omni_data.h"
#include "server/base/fnv.h"
#include "server/lab/cell/cell.h"
#include "server/master/haptic_settings.h"
#include "server/slave/follow_settings.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

std::unique_ptr<Cell> make_net_cell(const CellNetOptions& net = {}) {
  Scene scene;
  scene.name = "test";
  scene.limits.joints = rv2a_limits();
  CellOptions options;
  options.haptic = haptic_settings(scene, omni_capabilities(false));
  options.follow = follow_settings(scene, options.rig.controller.period, true, 1000.0);
  options.rig.controller.arm.geometry.d6 = scene.tip_length;
  options.net = net;
  return std::make_unique<Cell>(options);
}

// The hand swings 30 mm to each side, once a second.
void tick(Cell& cell, OrderKind kind = OrderKind::kNone) {
  HandReading hand;
  hand.X_MH.p = Vec3(0.03 * std::sin(2.0 * M_PI * to_seconds(cell.now())), 0.0, 0.0);
  hand.valid = true;
  HapticOrder order;
  order.kind = kind;
  cell.tick(hand, order);
}

void run(Cell& cell, Nanos span) {
  for (const Nanos end = cell.now() + span; cell.now() < end;) tick(cell);
}

bool engage(Cell& cell) {
  for (int i = 0; i < 5000 && cell.slave().state != SessionState::kEngaged; ++i) {
    tick(cell, OrderKind::kEngage);
  }
  return cell.slave().state == SessionState::kEngaged;
}

double speed_of(Cell& cell) {
  const Vec3 before = cell.slave().X_ST_command.p;
  run(cell, 8 * kMillisecond);
  return (cell.slave().X_ST_command.p - before).norm() / 0.008;
}

std::uint64_t fingerprint(const CellNetOptions& net, double loss) {
  const auto cell = make_net_cell(net);
  cell->net()->link().to_slave().faults.delay = 2 * kMillisecond;
  EXPECT_TRUE(engage(*cell));
  cell->net()->link().to_slave().faults.loss = loss;
  Fnv fnv;
  for (int i = 0; i < 2000; ++i) {
    tick(*cell);
    for (int j = 0; j < kJoints; ++j) fnv.f64(cell->follow().q_target[j]);
  }
  return fnv.value();
}

TEST(CellNetTest, TheArmFollowsTheHandOverDatagrams) {
  const auto cell = make_net_cell();
  ASSERT_TRUE(engage(*cell));
  run(*cell, kSecond);
  double furthest = 0.0;
  const Vec3 start = cell->slave().X_ST_command.p;
  for (int i = 0; i < 1000; ++i) {
    tick(*cell);
    furthest = std::max(furthest, (cell->slave().X_ST_command.p - start).norm());
  }
  EXPECT_GT(furthest, 0.05);
  EXPECT_EQ(cell->net()->slave().snapshot().rejected, 0u);
  EXPECT_GT(cell->net()->slave().snapshot().accepted, 1900u);
}

TEST(CellNetTest, TheSameSeedGivesTheSameBitsAndAnotherOnesOthers) {
  EXPECT_EQ(fingerprint({1, 0, 0}, 0.4), fingerprint({1, 0, 0}, 0.4));
  EXPECT_NE(fingerprint({1, 0, 0}, 0.4), fingerprint({2, 0, 0}, 0.4));
}

TEST(CellNetTest, ClocksThatDifferChangeNothing) {
  const std::uint64_t same = fingerprint({1, 0, 0}, 0.4);
  EXPECT_EQ(fingerprint({1, 5000 * kSecond, 0}, 0.4), same);
  EXPECT_EQ(fingerprint({1, 0, 5000 * kSecond}, 0.4), same);
}

TEST(CellNetTest, AStoppedMasterIsHeldAndWhatWaitedInItsSocketIsDropped) {
  const auto cell = make_net_cell();
  ASSERT_TRUE(engage(*cell));
  run(*cell, kSecond);
  cell->net()->stop_master(true);
  run(*cell, 150 * kMillisecond);
  EXPECT_EQ(cell->slave().state, SessionState::kHold);
  cell->net()->stop_master(false);
  run(*cell, 100 * kMillisecond);
  EXPECT_EQ(cell->slave().state, SessionState::kEngaged);
  EXPECT_GT(cell->net()->master().rejects()[static_cast<std::size_t>(Reject::kAfterStall)], 100u);
}

TEST(CellNetTest, AKilledMasterComesBackAsAnotherSessionThatDrivesNothing) {
  const auto cell = make_net_cell();
  ASSERT_TRUE(engage(*cell));
  run(*cell, kSecond);
  cell->net()->stop_master(true);
  run(*cell, 300 * kMillisecond);
  cell->restart_master();
  cell->net()->stop_master(false);
  run(*cell, kSecond);
  EXPECT_EQ(cell->net()->slave().snapshot().peer_epoch, 2u);
  EXPECT_NE(cell->slave().state, SessionState::kEngaged);
  EXPECT_EQ(speed_of(*cell), 0.0);
}

TEST(CellNetTest, AKilledSlaveComesBackOff) {
  const auto cell = make_net_cell();
  ASSERT_TRUE(engage(*cell));
  run(*cell, kSecond);
  cell->restart_slave();
  run(*cell, kSecond);
  EXPECT_EQ(cell->slave().state, SessionState::kOff);
  EXPECT_EQ(cell->master_state().lead.session, SessionState::kFault);
}

class Liar final : public CellTap {
 public:
  void on_force(Nanos, Wrench& f, bool& valid) noexcept override {
    f.force = Vec3(1.0, 2.0, 3.0);
    valid = true;
  }
  void on_reply(Nanos, RobotReply& reply) noexcept override { reply.q_measured[5] = 0.25; }
};

TEST(CellNetTest, ATapFalsifiesWhatTheSlaveReads) {
  const auto cell = make_net_cell();
  Liar liar;
  cell->set_tap(&liar);
  run(*cell, 50 * kMillisecond);
  EXPECT_EQ(cell->slave().q_measured[5], 0.25);
  EXPECT_NEAR(cell->slave().f_E_S.force.norm(), std::sqrt(14.0), 1e-12);
}

TEST(CellNetTest, TargetsAreWhatIsSentBeforeItIsRounded) {
  const auto cell = make_net_cell();
  ASSERT_TRUE(engage(*cell));
  for (int i = 0; i < 1000; ++i) {
    tick(*cell);
    ASSERT_EQ(cell->targets().size(), cell->sent().size());
    for (std::size_t k = 0; k < cell->sent().size(); ++k) {
      EXPECT_LT((cell->targets()[k] - cell->sent()[k]).cwiseAbs().maxCoeff(), 2e-7);
    }
  }
}

TEST(CellNetTest, TicksWithoutTouchingTheHeap) {
  const auto cell = make_net_cell();
  ASSERT_TRUE(engage(*cell));
  cell->net()->link().to_slave().faults.loss = 0.2;
  test::NoAllocation guard("a tick of the cell over datagrams");
  run(*cell, kSecond);
}

}  // namespace
}  // namespace handrail
