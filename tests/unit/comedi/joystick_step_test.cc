// The joystick at the master's step.
#include "tests/unit/comedi/joystick_bench.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::ComediState;

class JoystickStepTest : public test::JoystickBench {
 protected:
  // Reads and steps, about once a millisecond, for so many of them.
  void steps(int count) {
    for (int i = 0; i < count; ++i) {
      const HapticSample sample = read();
      rig.in.hand.valid = sample.valid;
      rig.in.hand.X_MH = sample.X_MH;
      rig.in.hand.v_MH = sample.v_MH;
      rig.tick();
      most = std::max(most, (rig.command().p - from.p).norm());
      sleep_until(monotonic_now() + kMillisecond);
    }
  }
  // The way of the command is looked at from here on.
  void look() {
    from = rig.command();
    most = 0.0;
  }

  test::HapticRig rig;
  Pose from;
  double most = 0.0;
};

// With `homing: CENTRE` its middle is wherever it stands as the card is back.
TEST_F(JoystickStepTest, ACardThatIsBackWithAnotherMiddleMovesNothing) {
  options.homing = StickHoming::kCentre;
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  rig.settings.guide.smoother_length = 1;
  steps(1);
  rig.engage();
  ASSERT_EQ(rig.session(), SessionState::kEngaged);
  look();
  turn(0, 600);
  steps(50);
  EXPECT_NEAR(read().X_MH.p.x(), 0.0565, 1e-4);
  EXPECT_NEAR(most, 0.113, 1e-3) << "twice that, so far";
  look();
  card([](ComediState& s) { s.read_error = EIO; });
  ASSERT_TRUE(valid(false));
  steps(30);
  card([](ComediState& s) { s.read_error = 0; });
  ASSERT_TRUE(valid());
  EXPECT_LT(read().X_MH.p.norm(), 1e-4) << "where it stands";
  steps(300);
  EXPECT_LT(most, 1e-4) << "neither while it was away nor as it is back";
  turn(0, 700);
  steps(50);
  EXPECT_NEAR(most, 0.0188, 1e-3) << "from there it leads";
}

}  // namespace
}  // namespace handrail
