#include "devices/rig/world/world.h"

#include <gtest/gtest.h>

#include "devices/melfa/mxt_client.h"
#include "devices/net_ft/rdt_client.h"
#include "devices/rig/rig.h"
#include "server/base/fnv.h"
#include "server/kinematics/rv2a.h"
#include "server/scene/scene_io.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

constexpr double kWorldStep = 1e-3;  // [s]
constexpr PeerId kWorldPc = 1;

Scene scene_of(const std::string& simulate) {
  const auto scene = parse_scene("/x/a.scene", "name: 'a'\nsimulate { " + simulate + " }");
  EXPECT_TRUE(scene.is_ok()) << scene.message();
  return scene ? *scene : Scene();
}

// The arm that starts tool down at (350, 0, 429) mm.
const JointVector kWorldHome = ServoArmOptions::default_start();
JointVector joints_at(const Vec3& p_S) {
  JointVector q = kWorldHome;
  const Pose X{p_S, forward(ArmGeometry(), kWorldHome).q};
  EXPECT_EQ(inverse_near(ArmGeometry(), X, kWorldHome, q), InverseStatus::kOk);
  return q;
}

// A floor 10 mm below the tip's start.
const char kFloor[] =
    "effect { plane { at_mm: [0, 0, 419] normal: [0, 0, 1] surface { friction: 0.2 } } }";

struct Arm {
  explicit Arm(const std::string& list)
      : world(*scene_of(list).simulate, ArmGeometry(), kWorldHome), p(world.tip().p) {}
  void to(const Vec3& target) {
    for (int i = 0; i < 200; ++i)
      world.step(joints_at(p + (target - p) * (i + 1) / 200), kWorldStep);
    p = target;
    for (int i = 0; i < 100; ++i) world.step(joints_at(p), kWorldStep);
  }
  World world;
  Vec3 p;  // where the servos hold the tip
};

TEST(World, StartsWhereTheArmIsAndTouchesNothing) {
  Arm arm(kFloor);
  EXPECT_LT((arm.p - Vec3(0.350, 0, 0.429)).norm(), 1e-9) << "the tests below rely on it";
  arm.world.step(kWorldHome, kWorldStep);
  EXPECT_EQ(arm.world.tip().p, forward(ArmGeometry(), kWorldHome).p);
  EXPECT_EQ(arm.world.on_tip().force, Vec3::Zero());
}

TEST(World, ArmAndToolGiveWayInSeries) {
  Arm arm(std::string(kFloor) + "effect { arm_compliance { n_mm: 60 } }" +
          "effect { tool_compliance { axial_n_mm: 30 lateral_n_mm: 8 } }");
  arm.to(Vec3(0.350, 0, 0.418));
  const double k = 1.0 / (1.0 / 60e3 + 1.0 / 30e3 + 1.0 / 1e6);
  EXPECT_NEAR(arm.world.on_tip().force.z(), k * 1e-3, 1e-3);
  EXPECT_NEAR(arm.world.tip().p.z(), 0.419 - k * 1e-3 / 1e6, 1e-8);
  arm.to(Vec3(0.3502, 0, 0.418));
  const double across = 1.0 / (1.0 / 60e3 + 1.0 / 8e3 + 1.0 / 1e6);
  EXPECT_NEAR(arm.world.on_tip().force.x(), -across * 0.2e-3, 1e-3) << "held by friction";
}

TEST(World, WithoutComplianceTheArmIsRigid) {
  Arm arm(kFloor);
  arm.to(Vec3(0.350, 0, 0.4189));
  EXPECT_NEAR(arm.world.on_tip().force.z(), 1e6 * 0.1e-3, 1e-3);
  EXPECT_NEAR(arm.world.tip().p.z(), 0.4189, 1e-9);
}

TEST(World, TheSensorFeelsTheForceInTheTipsAxes) {
  Arm arm(std::string(kFloor) + "effect { arm_compliance {} }");
  arm.to(Vec3(0.350, 0, 0.418));
  const Wrench f_E_T = arm.world.on_sensor();
  EXPECT_NEAR(f_E_T.force.z(), -arm.world.on_tip().force.z(), 1e-9) << "the tool points down";
  EXPECT_NEAR(f_E_T.force.head<2>().norm(), 0.0, 1e-9);
}

TEST(World, TheOrderOfTheListDoesNotMatter) {
  const std::string wall = "effect { plane { at_mm: [351, 0, 0] normal: [-1, 0, 0] } }";
  const std::string arm = "effect { arm_compliance {} }";
  Arm first(kFloor + wall + arm), second(arm + wall + kFloor);
  for (Arm* a : {&first, &second}) a->to(Vec3(0.352, 0.001, 0.418));
  EXPECT_LT((first.world.on_tip().force - second.world.on_tip().force).norm(), 0.1);
  EXPECT_LT(first.world.on_tip().force.x(), -10.0);
  EXPECT_GT(first.world.on_tip().force.z(), 10.0);
}

TEST(World, IsNeededOnlyForWhatCanBeTouched) {
  EXPECT_FALSE(World::is_needed(Simulate()));
  EXPECT_FALSE(World::is_needed(
      *scene_of("effect { servo_lag {} } effect { arm_compliance {} } effect { sensor_noise {} }")
           .simulate));
  EXPECT_TRUE(World::is_needed(*scene_of(kFloor).simulate));
}

TEST(World, DoesNotAllocate) {
  Arm arm(std::string(kFloor) + "effect { arm_compliance {} }");
  const JointVector q = joints_at(Vec3(0.350, 0, 0.418));
  test::NoAllocation guard("World::step");
  for (int i = 0; i < 10; ++i) arm.world.step(q, kWorldStep);
  const World copy = arm.world;
  EXPECT_GT(copy.on_tip().force.z(), 10.0);
}

// Drives a rig with the two real clients, down by `speed` metres a cycle for a second.
struct WorldSession {
  explicit WorldSession(const RigOptions& options) : rig(options, 0) {
    rig.controller().on_datagram(robot.start(0), kWorldPc);
    rig.sensor().on_datagram(sensor.start(0), kWorldPc);
  }
  void run(Nanos until, double speed) {
    RobotReply reply;
    while (rig.next() <= until) {
      if (robot.opening() && robot.deadline() < rig.next()) {
        if (robot.poll(robot.deadline(), reply)) {
          rig.controller().on_datagram(robot.packet(), kWorldPc);
        }
        continue;
      }
      const Nanos now = rig.next();
      if (rig.step(now) == RigEvent::kSensor) {
        if (const auto& record = rig.sensor().record()) {
          for (const std::uint8_t byte : record->bytes) hash.byte(byte);
          sensor.on_datagram(record->bytes, now, sample);
        }
        continue;
      }
      for (const auto& out : rig.controller().replies()) {
        for (const std::uint8_t byte : out.bytes()) hash.byte(byte);
        if (robot.on_datagram(out.bytes(), now, reply) != RobotEvent::kReply) continue;
        p.z() -= speed;
        rig.controller().on_datagram(robot.send(joints_at(p), now), kWorldPc);
      }
    }
  }

  Rig rig;
  MxtClient robot{MxtClientOptions{}};
  RdtClient sensor{RdtClientOptions{}};
  FtSample sample;
  Vec3 p = forward(ArmGeometry(), kWorldHome).p;
  Fnv hash;
};

RigOptions listed(const std::string& simulate) {
  RigOptions options;
  run_only_listed(scene_of(simulate), options);
  return options;
}

const char kAsConfigured[] =
    "effect { servo_lag {} } effect { encoder_offsets {} } effect { sensor_noise {} }"
    "effect { sensor_saturation {} }";

TEST(RigWorld, AListOfWhatARigDoesByItselfChangesNoBit) {
  WorldSession plain{RigOptions{}}, same(listed(kAsConfigured));
  for (WorldSession* s : {&plain, &same}) s->run(kSecond, 1e-4);
  EXPECT_EQ(plain.hash.value(), same.hash.value());
  EXPECT_EQ(same.rig.world(), nullptr);
}

TEST(RigWorld, ASceneWithoutAListLeavesTheRigAlone) {
  RigOptions options;
  options.sensor.noise_n = 7.0;
  options.controller.arm.lag = 0.05;
  run_only_listed(Scene(), options);
  EXPECT_EQ(options.sensor.noise_n, 7.0);
  EXPECT_EQ(options.controller.arm.lag, 0.05);
  EXPECT_FALSE(options.world);
}

TEST(RigWorld, WhatIsNotListedDoesNotRun) {
  WorldSession ideal(listed(""));
  ideal.run(kSecond, 1e-4);
  ideal.rig.controller().pass(2 * kSecond);
  const ServoArm& arm = ideal.rig.controller().arm();
  EXPECT_EQ(arm.joints(), arm.target()) << "no lag";
  EXPECT_EQ(arm.joints(), arm.measured()) << "no offsets";
  EXPECT_EQ(ideal.sample.wrench.force, Vec3::Zero()) << "no noise";
}

TEST(RigWorld, SomethingOutOfReachMovesTheArmAsBefore) {
  const std::string far = "effect { plane { at_mm: [0, 0, -5000] normal: [0, 0, 1] } }";
  WorldSession without(listed(kAsConfigured)), with(listed(kAsConfigured + far));
  for (WorldSession* s : {&without, &with}) s->run(kSecond, 1e-4);
  ASSERT_NE(with.rig.world(), nullptr);
  const JointVector& q = without.rig.controller().arm().joints();
  without.rig.controller().pass(kSecond);
  EXPECT_LT((with.rig.controller().arm().joints() - q).norm(), 1e-12);
  EXPECT_EQ(with.rig.world()->on_tip().force, Vec3::Zero());
}

TEST(RigWorld, TheSensorStreamsWhatTheArmTouches) {
  WorldSession session(listed(std::string(kFloor) + "effect { arm_compliance {} }"));
  session.run(kSecond, 1e-4);
  const double depth = 0.419 - session.p.z();
  ASSERT_GT(depth, 1e-3);
  session.run(2 * kSecond, 0.0);
  EXPECT_NEAR(session.sample.wrench.force.z(), -depth / (1.0 / 60e3 + 1e-6), 0.01);
  EXPECT_GT(session.rig.true_tip().p.z(), 0.418);
}

TEST(RigWorld, AfterALongPauseTheWorldGoesOnWhereItWas) {
  WorldSession session(listed(std::string(kFloor) + "effect { arm_compliance {} }"));
  session.run(kSecond, 1e-4);
  session.run(kSecond + 100 * kMillisecond, 0.0);
  const Vec3 before = session.rig.world()->on_tip().force;
  while (session.rig.step(60 * kSecond) != RigEvent::kNone) continue;
  EXPECT_GT(session.rig.skipped(), 1000u);
  EXPECT_LT((session.rig.world()->on_tip().force - before).norm(), 1e-3);
}

}  // namespace
}  // namespace handrail
