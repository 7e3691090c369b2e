#include "devices/rig/world/hex_socket.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/rig/world/screw.h"
#include "devices/rig/world/world.h"
#include "server/base/units.h"
#include "tests/unit/rig/probe.h"

namespace handrail {
namespace {

using test::kStep;

constexpr double kAxial = 1.0 / (1.0 / 60e3 + 1.0 / 60e3 + 1e-6);  // of arm, key and wall [N/m]

// Opens upward at the origin: 6.05 mm for a key of 6, 5 mm deep, chamfer to 0.8, guide to 1.3 mm;
// the mouth reaches 0.925 mm from the axis.
Simulate workpiece(double friction = 0.0) {
  HexSocketSpec socket;
  socket.surface = {1e6, 0.0, friction};
  return {{ArmComplianceSpec{60e3}, ToolComplianceSpec{60e3, 8e3, 20.0}, socket,
           ScrewThreadSpec{0.15, 360 * kDeg, 0.9, 0.8}}};
}

// A key that points down and is moved by hand.
class Key {
 public:
  explicit Key(const Simulate& list) : world_(list, ArmGeometry(), JointVector::Zero()) {
    at_ = Vec3(0, 0, 10e-3);
    world_.lead(pose(), kStep);
    world_.lead(pose(), kStep);
  }
  // Straight to `p`, at 20 um a step, then waits.
  void to(const Vec3& p) {
    const Vec3 from = at_;
    const int count = static_cast<int>((p - from).norm() / 20e-6) + 1;
    for (int i = 1; i <= count; ++i) {
      at_ = from + (p - from) * i / count;
      world_.lead(pose(), kStep);
    }
    for (int i = 0; i < 50; ++i) world_.lead(pose(), kStep);
  }
  // By `angle` clockwise as one looks down, at 0.5 degrees a step.
  void turn(double angle) {
    const int count = static_cast<int>(std::abs(angle) / (0.5 * kDeg)) + 1;
    for (int i = 0; i < count; ++i) {
      turned_ += angle / count;
      world_.lead(pose(), kStep);
    }
  }
  void tilt(double angle) {
    for (int i = 0; i < 100; ++i) {
      tilt_ += angle / 100;
      world_.lead(pose(), kStep);
    }
  }
  void wait() {
    for (int i = 0; i < 100; ++i) world_.lead(pose(), kStep);
  }
  double depth() const { return world_.depth(); }
  const Vec3& force() const { return world_.on_tip().force; }
  // What the screw exerts on the key, against turning it clockwise.
  double torque() const { return world_.on_tip().torque.z(); }
  const World& world() const { return world_; }

 private:
  Pose pose() const {
    const Quat down(0.0, 1.0, 0.0, 0.0);
    return {at_, rotation_exp(Vec3(tilt_, 0, 0)) * rotation_exp(Vec3(0, 0, -turned_)) * down};
  }
  World world_;
  Vec3 at_;
  double turned_ = 0.0;
  double tilt_ = 0.0;
};

TEST(HexSocket, AKeyAboveTheMiddleGoesInToTheBottom) {
  Key key(workpiece());
  EXPECT_NEAR(key.depth(), -10e-3, 1e-12) << "over the mouth, above it";
  key.to(Vec3(0, 0, -4.9e-3));
  EXPECT_NEAR(key.depth(), 4.9e-3, 1e-9);
  EXPECT_NEAR(key.force().norm(), 0.0, 1e-9);
  key.to(Vec3(0, 0, -6e-3));
  EXPECT_NEAR(key.force().z(), kAxial * 1e-3, 0.1);
  EXPECT_NEAR(key.depth(), 5e-3, 0.1e-3);
}

TEST(HexSocket, AKeyBesideTheMouthStandsOnTheRim) {
  Key key(workpiece(0.3));
  key.to(Vec3(1.5e-3, 0, 10e-3));
  EXPECT_EQ(key.depth(), -std::numeric_limits<double>::infinity());
  key.to(Vec3(1.5e-3, 0, -1e-3));
  EXPECT_NEAR(key.force().z(), kAxial * 1e-3, 0.1);
  EXPECT_EQ(key.depth(), -std::numeric_limits<double>::infinity());
}

TEST(HexSocket, TheChamferLeadsAKeyInFromHalfAMillimetre) {
  for (int i = 0; i < 12; ++i) {
    const double a = 30 * kDeg * i;
    const Vec3 aside(0.5e-3 * std::cos(a), 0.5e-3 * std::sin(a), 0);
    Key key(workpiece(0.3));
    key.to(aside + Vec3(0, 0, 1e-3));
    key.to(aside + Vec3(0, 0, -4.9e-3));
    EXPECT_GT(key.depth(), 4.5e-3) << i;
    EXPECT_LT(key.force().head<2>().dot(aside.head<2>()), 0.0) << "the walls push to the middle";
    const double bent = 0.5e-3 - 0.025e-3;
    EXPECT_NEAR(key.force().head<2>().norm(), bent / (1.0 / 8e3 + 1.0 / 60e3 + 1e-6), 0.6) << i;
  }
}

TEST(HexSocket, TheChamferSlopesFromItsMouthAtHalfARightAngle) {
  Key key(workpiece());
  const Vec3 aside(0.5e-3 * std::cos(30 * kDeg), 0.5e-3 * std::sin(30 * kDeg), 0);  // over a flat
  key.to(aside + Vec3(0, 0, 1e-3));
  key.to(aside + Vec3(0, 0, -0.42e-3));
  EXPECT_EQ(key.force(), Vec3::Zero()) << "0.925 mm wide at the rim, it is 0.425 deep here";
  key.to(aside + Vec3(0, 0, -0.45e-3));
  EXPECT_GT(key.force().z(), 0.1);
  EXPECT_NEAR(key.force().head<2>().norm(), key.force().z(), 1e-6);
  key.to(aside + Vec3(0, 0, 1e-3));
  key.to(1.9 * aside + Vec3(0, 0, 1e-3));
  key.to(1.9 * aside + Vec3(0, 0, -0.1e-3));
  EXPECT_EQ(key.depth(), -std::numeric_limits<double>::infinity()) << "0.95 mm aside";
  EXPECT_NEAR(key.force().head<2>().norm(), 0.0, 1e-9);
}

TEST(HexSocket, AKeyPulledAsideInTheSocketStaysInIt) {
  Key key(workpiece(0.3));
  key.to(Vec3(0, 0, -4e-3));
  for (int i = 0; i <= 24; ++i) {
    const double a = 15 * kDeg * i;
    key.to(Vec3(3e-3 * std::cos(a), 3e-3 * std::sin(a), -4e-3));
    EXPECT_NEAR(key.depth(), 4e-3, 0.5e-3) << i;
    EXPECT_LT(key.world().tip().p.head<2>().norm(), 0.06e-3) << i;
  }
  key.to(Vec3(0, 0, 10e-3));
  EXPECT_NEAR(key.force().norm(), 0.0, 1e-9) << "and comes out again";
}

TEST(HexSocket, AKeyTurnedOutOfTheHexagonDropsInWhenTurned) {
  Key key(workpiece());
  key.turn(30 * kDeg);
  key.to(Vec3(0, 0, -2e-3));
  EXPECT_NEAR(key.depth(), 0.8e-3, 0.1e-3) << "its corners stand at the chamfer's end";
  EXPECT_GT(key.force().z(), 20.0);
  key.turn(27 * kDeg);
  EXPECT_LT(key.depth(), 0.9e-3) << "57 degrees: 3 off, the play is 2 either way";
  key.turn(1.5 * kDeg);
  key.wait();
  EXPECT_NEAR(key.depth(), 2e-3, 1e-6);
  EXPECT_NEAR(key.world().screw_angle(), 0.0, 1e-12) << "nothing turned the screw";
}

TEST(HexSocket, ATiltedKeyJams) {
  Key straight(workpiece(0.3)), tilted(workpiece(0.3));
  for (Key* key : {&straight, &tilted}) key->to(Vec3(0, 0, -4e-3));
  tilted.tilt(20 * kDeg);
  // 20 N m/rad over 8 degrees, with 3.2 of 4.2 mm inside, on both sides.
  const double grip = 2.0 * 0.3 * 20.0 * 8 * kDeg * 3.2e-3 / (4.2e-3 * 4.2e-3);
  for (Key* key : {&straight, &tilted}) key->to(Vec3(0, 0, -3.5e-3));
  EXPECT_NEAR(straight.force().z(), 0.0, 1e-6);
  // Between a key free to bend aside and one that is not.
  EXPECT_LT(tilted.force().z(), -0.7 * kAxial * 0.5e-3);
  EXPECT_GT(tilted.force().z(), -kAxial * 0.5e-3);
  EXPECT_NEAR(tilted.depth(), 4e-3, 0.1e-3);
  tilted.to(Vec3(0, 0, -4e-3 + 0.9 * grip / 30e3));
  EXPECT_GT(tilted.depth(), 3.5e-3);
  tilted.to(Vec3(0, 0, -4e-3 + 1.2 * grip / 30e3));
  EXPECT_LT(tilted.depth(), 0.0) << "pulled harder than the walls rub it comes out";
}

TEST(HexSocket, BacklashIsCrossedBeforeTheScrewFollows) {
  Key key(workpiece());
  key.to(Vec3(0, 0, -4.9e-3));
  key.turn(1.9 * kDeg);
  EXPECT_NEAR(key.torque(), 0.0, 1e-12);
  key.turn(0.3 * kDeg);
  EXPECT_NEAR(key.torque(), 20.0 * 0.2 * kDeg, 1e-9) << "half of 4 degrees, then the key twists";
  EXPECT_EQ(key.world().screw_angle(), 0.0);
}

TEST(HexSocket, TheScrewTurnsOnlyPastItsTorqueAndGrowsTighter) {
  Key key(workpiece());
  key.to(Vec3(0, 0, -4.9e-3));
  key.turn(180 * kDeg);
  const double wind = 0.15 / 20.0;
  EXPECT_NEAR(key.world().screw_angle(), 178 * kDeg - wind, 1e-9);
  EXPECT_NEAR(key.torque(), 0.15, 1e-9);
  key.turn(352 * kDeg);
  const double past = 170 * kDeg * 20.0 / 20.9 - wind * 20.0 / 20.9;
  EXPECT_NEAR(key.world().screw_angle(), 360 * kDeg + past, 1e-6);
  EXPECT_NEAR(key.torque(), 0.15 + 0.9 * past, 1e-6);
  EXPECT_FALSE(key.world().slipped());
}

TEST(HexSocket, AScrewIsLetGoAndTakenUpAgainASixthOfATurnFurther) {
  Key key(workpiece());
  key.to(Vec3(0, 0, -4.9e-3));
  key.turn(92 * kDeg + 0.15 / 20.0);
  const double angle = key.world().screw_angle();
  EXPECT_NEAR(angle, 90 * kDeg, 1e-9);
  key.to(Vec3(0, 0, 10e-3));
  EXPECT_EQ(key.torque(), 0.0);
  key.turn(-182 * kDeg);
  EXPECT_EQ(key.world().screw_angle(), angle) << "nobody holds it";
  key.to(Vec3(0, 0, -4.9e-3));
  EXPECT_GT(key.depth(), 4.5e-3);
  key.turn(62 * kDeg);
  EXPECT_GT(key.world().screw_angle(), angle + 55 * kDeg);
}

TEST(HexSocket, TurningBackInTheSocketLoosensTheScrew) {
  Key key(workpiece());
  key.to(Vec3(0, 0, -4.9e-3));
  key.turn(90 * kDeg);
  key.turn(-90 * kDeg);
  EXPECT_NEAR(key.world().screw_angle(), 2 * kDeg + 0.8 * 0.15 / 20.0, 1e-9);
  EXPECT_NEAR(key.torque(), -0.8 * 0.15, 1e-9);
}

TEST(HexSocket, AKeyHardlyInsideIsLostUnderLoad) {
  Key key(workpiece());
  key.to(Vec3(0, 0, -1.5e-3));
  key.turn(10 * kDeg);
  EXPECT_TRUE(key.world().slipped());
  EXPECT_EQ(key.torque(), 0.0);
  const double angle = key.world().screw_angle();
  key.turn(40 * kDeg);
  EXPECT_EQ(key.world().screw_angle(), angle) << "it turns in vain";
  key.to(Vec3(0, 0, 1e-3));
  EXPECT_FALSE(key.world().slipped()) << "lifted, it may be put in again";
}

TEST(HexSocket, ALostKeyFindsTheFlatsAgainWhenItIsTurnedOn) {
  Key key(workpiece());
  key.to(Vec3(0, 0, -1.5e-3));
  key.turn(10 * kDeg);
  ASSERT_TRUE(key.world().slipped());
  EXPECT_GT(std::abs(key.world().off_flats()), 2 * kDeg);
  key.to(Vec3(0, 0, -6e-3));
  EXPECT_LT(key.depth(), 1e-3) << "its corners stand on the chamfer's end";
  key.turn(key.world().off_flats());
  key.wait();
  EXPECT_FALSE(key.world().slipped());
  EXPECT_GT(key.depth(), 4.9e-3);
  EXPECT_NEAR(key.world().off_flats(), 0.0, 1e-9);
}

TEST(HexSocket, AKeyTiltedFarIsLost) {
  Key key(workpiece());
  key.to(Vec3(0, 0, -4e-3));
  key.tilt(29 * kDeg);
  EXPECT_FALSE(key.world().slipped());
  key.tilt(2 * kDeg);
  EXPECT_TRUE(key.world().slipped());
}

TEST(HexSocket, AScrewWithoutAThreadIsFast) {
  Simulate fast = workpiece();
  fast.effects.pop_back();
  Key key(fast);
  key.to(Vec3(0, 0, -4.9e-3));
  key.turn(20 * kDeg);
  EXPECT_EQ(key.world().screw_angle(), 0.0);
  EXPECT_NEAR(key.torque(), 20.0 * 18 * kDeg, 1e-9);
}

TEST(Screw, LoosensAlongItsTorqueAlsoWhereItFallsFasterThanTheKeyUnwinds) {
  const ScrewThreadSpec steep{0.2, 1.0, 50.0, 1.0};
  Screw screw(&steep, 10.0);
  for (int i = 0; i <= 100; ++i) screw.turn(0.02 * i, 0.0);
  const double tight = screw.angle();
  EXPECT_NEAR(10.0 * (2.0 - tight), 0.2 + 50.0 * (tight - 1.0), 1e-9);
  double torque = 0.0;
  for (int i = 100; i >= 0; --i) torque = screw.turn(0.02 * i, 0.0);
  EXPECT_NEAR(torque, -0.2, 1e-12) << "it has sprung loose to below its seat";
  EXPECT_NEAR(screw.angle(), 0.02, 1e-12);
}

}  // namespace
}  // namespace handrail
