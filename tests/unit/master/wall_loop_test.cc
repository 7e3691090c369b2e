// A scene of walls in the haptic loop.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "server/master/status_report.h"
#include "server/master/wall_runs.h"
#include "tests/support/no_allocation.h"
#include "tests/unit/master/loop_bench.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

// A square room of 40 mm, drawn; in its second stage it lies 20 mm further to the right.
Scene room() {
  auto walls = std::make_shared<Walls>();
  WallRegion wall;
  wall.name = "brick";
  wall.kind = RegionKind::kWall;
  walls->method = WallMethod::kExact;
  walls->regions = {WallRegion(), wall};
  walls->outside = 1;
  WallShape shape;
  shape.half = Vec2(0.02, 0.02);
  walls->shapes = {shape};
  walls->start = Vec2(0.012, -0.007);
  walls->stages.resize(2);
  walls->stages[1].pose.p = Vec2(0.02, 0.0);
  Scene scene;
  scene.name = "room";
  scene.walls = walls;
  EffectSpec effect;
  effect.kind = EffectKind::kWall;
  scene.effects = {effect};
  return scene;
}

HapticCapabilities joystick() {
  HapticCapabilities c;
  c.name = "stick";
  c.max_force = 25.3;
  c.continuous_force = 8.5;
  return c;
}

class WallLoop : public LoopBench {
 protected:
  WallLoop() {
    boxes.scene.publish(with_walls());
    device.sample.X_MH.p = Vec3::Zero();
    ticks(2);
  }
  LoopScene with_walls() {
    LoopScene out{settings, runs.make(room(), joystick())};
    out.haptic.scene = scene_name("room");
    out.haptic.has_arm = false;
    return out;
  }
  void go_to(double x) {
    while (std::abs(device.sample.X_MH.p.x() - x) > 1e-9) {
      const double left = x - device.sample.X_MH.p.x();
      device.sample.X_MH.p.x() += std::clamp(left, -1e-4, 1e-4);
      tick();
    }
    ticks(10);
  }
  std::optional<Reason> order(OrderKind kind, int stage = 0, double screw_c = 0.0) {
    OrderTicket ticket;
    ticket.order.screw_c = screw_c;
    ticket.id = ++id_;
    ticket.order.kind = kind;
    ticket.order.stage = stage;
    EXPECT_TRUE(boxes.orders.push(ticket));
    tick();
    return answer(id_);
  }
  WallRuns runs;

 private:
  std::uint64_t id_ = 100;
};

TEST_F(WallLoop, TheWallIsFeltWithTheSessionOff) {
  slave_talks = false;
  go_to(0.022);
  EXPECT_EQ(report.out.link.state, SessionState::kOff);
  EXPECT_NEAR(device.written.force.x(), -10.0, 0.01);
  EXPECT_TRUE(report.walls.present);
  EXPECT_TRUE(report.walls.contact.touching);
  EXPECT_NEAR(report.walls.penetration, 2e-3, 1e-6);
  EXPECT_NEAR(report.out.force.walls.x(), -10.0, 0.01) << "why says what pushes";
  EXPECT_EQ(report.out.force.device, device.written.force);
  go_to(0.0);
  EXPECT_EQ(device.written.force.norm(), 0.0);
  EXPECT_FALSE(report.walls.contact.touching);
}

TEST_F(WallLoop, TheScrewsCIsWhatWasOrderedUntilTheSceneComesAnew) {
  EXPECT_FALSE(report.walls.has_screw);
  Scene scene = room();
  EffectSpec screw;
  screw.kind = EffectKind::kProgressive;
  screw.c = 5.0;
  scene.effects.push_back(screw);
  LoopScene with_screw{settings, runs.make(scene, joystick())};
  with_screw.haptic.has_arm = false;
  boxes.scene.publish(with_screw);
  ticks(2);
  EXPECT_TRUE(report.walls.has_screw);
  EXPECT_EQ(report.walls.screw_c, 5.0);
  EXPECT_EQ(order(OrderKind::kScrew, 0, 15.0), Reason::kNone);
  EXPECT_LT(report.walls.screw_c, 5.1);
  ticks(600);
  EXPECT_EQ(report.walls.screw_c, 15.0);
  LoopScene anew{settings, runs.make(scene, joystick())};
  anew.haptic.has_arm = false;
  boxes.scene.publish(anew);
  ticks(2);
  EXPECT_EQ(report.walls.screw_c, 5.0);
}

TEST_F(WallLoop, WhoeverLeadsByACursorFeelsItWhileTheDeadManIsHeld) {
  device.set_led_by_cursor();
  LoopScene led = with_walls();
  led.haptic.presence = Presence::kButton;
  boxes.scene.publish(led);
  device.sample.buttons = 4;
  go_to(0.022);
  EXPECT_NEAR(device.written.force.x(), -10.0, 0.01);
  EXPECT_NEAR(report.walls.hand.x(), 0.022, 1e-9);
  EXPECT_NEAR(report.walls.force.x(), -10.0, 0.01);
  device.sample.buttons = 0;
  ticks(500);
  EXPECT_EQ(device.written.force.norm(), 0.0);
  device.sample.buttons = 4;
  ticks(500);
  EXPECT_NEAR(device.written.force.x(), -10.0, 0.01);
}

TEST_F(WallLoop, TheSimulatedHandBeginsAtTheScenesStart) {
  EXPECT_EQ(device.simulations, 2) << "at the start, and once for the scene";
  EXPECT_EQ(device.simulated_from, Vec3(0.012, -0.007, 0.0));
  boxes.scene.publish({settings});
  ticks(2);
  EXPECT_EQ(device.simulations, 3);
  EXPECT_EQ(device.simulated_from, Vec3::Zero()) << "without walls";
}

TEST_F(WallLoop, NothingEngagesAndTheReasonIsGiven) {
  EXPECT_EQ(order(OrderKind::kEngage), Reason::kNoArmInScene);
  ticks(20);
  EXPECT_EQ(report.out.link.desired, Desired::kOff);
}

TEST_F(WallLoop, StagesChangeOnOrderAndWrongOnesAreRefused) {
  go_to(0.022);
  EXPECT_EQ(order(OrderKind::kStage, 1), Reason::kNone);
  ticks(100);
  EXPECT_EQ(report.walls.stage, 1);
  EXPECT_EQ(device.written.force.norm(), 0.0);
  EXPECT_EQ(order(OrderKind::kStage, 2), Reason::kNoSuchStage);
  EXPECT_EQ(order(OrderKind::kStage, -1), Reason::kNoSuchStage);
  EXPECT_EQ(report.walls.stage, 1);
}

TEST_F(WallLoop, AnOrderForAStageThatWasLeftByItselfGoesBackToIt) {
  Scene scene = room();
  auto walls = std::make_shared<Walls>(*scene.walls);
  walls->stages[1].when.kind = StageCondition::Kind::kInside;
  scene.walls = walls;
  LoopScene led = with_walls();
  led.walls = runs.make(scene, joystick());
  boxes.scene.publish(led);
  ticks(200);
  EXPECT_EQ(report.walls.stage, 1);
  EXPECT_EQ(order(OrderKind::kStage, 0), Reason::kNone);
  ticks(200);
  EXPECT_EQ(report.walls.stage, 0);
}

TEST_F(WallLoop, AStopTakesTheForceUntilReset) {
  go_to(0.022);
  ASSERT_GT(device.written.force.norm(), 5.0);
  EXPECT_EQ(order(OrderKind::kStop), Reason::kNone);
  ticks(60);
  EXPECT_EQ(device.written.force.norm(), 0.0);
  EXPECT_EQ(order(OrderKind::kReset), Reason::kNone);
  ticks(200);
  EXPECT_NEAR(device.written.force.norm(), 10.0, 0.1);
}

TEST_F(WallLoop, ASceneWithoutWallsTakesOverWithoutAStepOfTheForce) {
  go_to(0.022);
  settings.force.peak = joystick().max_force;
  boxes.scene.publish({settings});
  double last = device.written.force.norm();
  for (int i = 0; i < 1000; ++i) {
    tick();
    EXPECT_LE(std::abs(device.written.force.norm() - last), 0.4) << i;
    last = device.written.force.norm();
  }
  EXPECT_EQ(last, 0.0);
  EXPECT_FALSE(report.walls.present);
  EXPECT_EQ(order(OrderKind::kStage, 0), Reason::kNoSuchStage);
  engage();
}

TEST_F(WallLoop, TheLoopDoesNotAllocateEvenWhenScenesChange) {
  boxes.scene.publish(with_walls());
  test::NoAllocation guard("haptic loop with walls");
  for (int i = 0; i < 500; ++i) {
    device.sample.X_MH.p.x() = 0.03 * std::sin(0.02 * i);
    tick();
  }
}

TEST_F(WallLoop, StatusShowsTheHandAmongTheWalls) {
  go_to(0.022);
  MasterIdentity identity;
  const pb::Status s = status_report(identity, report, SlaveState(), LinkSnapshot(), now);
  ASSERT_TRUE(s.has_walls());
  EXPECT_TRUE(s.walls().touching());
  EXPECT_NEAR(s.walls().penetration_mm(), 2.0, 1e-3);
  EXPECT_NEAR(s.walls().proxy_mm(0), 20.0, 1e-3);
  EXPECT_NEAR(s.device_force().magnitude_n(), 10.0, 0.01);
  report.walls = WallReport();
  EXPECT_FALSE(status_report(identity, report, SlaveState(), LinkSnapshot(), now).has_walls());
}

TEST(WallRuns, ASceneWithoutWallsHasNone) {
  WallRuns runs;
  EXPECT_EQ(runs.make(Scene(), joystick()), nullptr);
}

}  // namespace
}  // namespace handrail
