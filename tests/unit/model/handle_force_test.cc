// Frames, lever and share of the handle's sensor, by hand.
#include "server/model/handle_force.h"

#include <gtest/gtest.h>

#include "server/base/units.h"

namespace handrail {
namespace {

HandleReading pushed(const Vec3& force, const Vec3& torque = Vec3::Zero()) {
  return {HandleState::kSound, {force, torque}};
}

TEST(HandleForce, TwoNewtonsSidewaysAtTheEndOfTheStickAreThreeTenthsOfANewtonMetre) {
  // The hand pushes with 2 N to the right: the handle pushes it to the left.
  const HandleForce felt =
      handle_force(pushed(Vec3(2.0, 0.0, 0.0)), Quat::Identity(), Vec3(0.0, 0.0, 0.15));
  EXPECT_TRUE(felt.f_H_M.force.isApprox(Vec3(-2.0, 0.0, 0.0)));
  ASSERT_TRUE(felt.has_stick);
  EXPECT_TRUE(felt.stick_torque_M.isApprox(Vec3(0.0, -0.3, 0.0)));
  // Along the stick there is no lever.
  EXPECT_TRUE(handle_force(pushed(Vec3(0.0, 0.0, 5.0)), Quat::Identity(), Vec3(0.0, 0.0, 0.15))
                  .stick_torque_M.isZero(1e-15));
}

TEST(HandleForce, TurnsWithTheHandle) {
  // A quarter turn about Z: the handle's X is M's Y.
  const Quat q_MH = rotation_exp(Vec3(0.0, 0.0, 90.0 * kDeg));
  const HandleForce felt =
      handle_force(pushed(Vec3(2.0, 0.0, 0.0), Vec3(0.0, 0.1, 0.0)), q_MH, Vec3::Zero());
  EXPECT_TRUE(felt.f_H_M.force.isApprox(Vec3(0.0, -2.0, 0.0), 1e-12));
  EXPECT_TRUE(felt.f_H_M.torque.isApprox(Vec3(0.1, 0.0, 0.0), 1e-12));
  EXPECT_FALSE(felt.has_stick);
}

TEST(HandleForce, HasNoForceWithoutASoundReading) {
  for (const HandleState state :
       {HandleState::kNone, HandleState::kWaiting, HandleState::kZeroing, HandleState::kSilent,
        HandleState::kFaulty, HandleState::kBeyond}) {
    const HandleForce felt = handle_force({state, {Vec3(2.0, 0.0, 0.0), Vec3::Zero()}},
                                          Quat::Identity(), Vec3(0.0, 0.0, 0.15));
    EXPECT_FALSE(felt.sound());
    EXPECT_EQ(felt.state, state);
    EXPECT_EQ(felt.f_H_M.force, Vec3::Zero());
    EXPECT_EQ(felt.stick_torque_M, Vec3::Zero());
  }
}

class FeltShareTest : public ::testing::Test {
 protected:
  void second(const Vec3& asked, const Vec3& measured) {
    for (int i = 0; i < 1000; ++i) share.step(asked, &measured, 1e-3);
  }
  FeltShare share;
};

TEST_F(FeltShareTest, IsWhatIsMeasuredAlongTheForceThatIsAskedFor) {
  second(Vec3(5.0, 0.0, 0.0), Vec3(4.0, 9.0, 0.0));
  EXPECT_NEAR(share.value().value_or(0.0), 0.8, 1e-9);
}

TEST_F(FeltShareTest, SaysWhenTheSensorSitsTheOtherWayRound) {
  second(Vec3(5.0, 0.0, 0.0), Vec3(-5.0, 0.0, 0.0));
  EXPECT_NEAR(share.value().value_or(0.0), -1.0, 1e-9);
}

TEST_F(FeltShareTest, IsNotKnownOfLittleForceNorOfShortForceNorWithoutASensor) {
  second(Vec3(0.99, 0.0, 0.0), Vec3(0.5, 0.0, 0.0));
  EXPECT_FALSE(share.value());
  const Vec3 asked(5.0, 0.0, 0.0);
  for (int i = 0; i < 1000; ++i) share.step(asked, nullptr, 1e-3);
  EXPECT_FALSE(share.value());
  // 0.5 of a window that fades: ln 2 of a second.
  for (int i = 0; i < 690; ++i) share.step(asked, &asked, 1e-3);
  EXPECT_FALSE(share.value());
  for (int i = 0; i < 10; ++i) share.step(asked, &asked, 1e-3);
  EXPECT_TRUE(share.value());
}

TEST_F(FeltShareTest, ForgetsWhatWas) {
  second(Vec3(5.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.0));
  for (int i = 0; i < 5; ++i) second(Vec3(5.0, 0.0, 0.0), Vec3(5.0, 0.0, 0.0));
  EXPECT_GT(share.value().value_or(0.0), 0.99);
  for (int i = 0; i < 2; ++i) second(Vec3::Zero(), Vec3::Zero());
  EXPECT_FALSE(share.value());
}

}  // namespace
}  // namespace handrail
