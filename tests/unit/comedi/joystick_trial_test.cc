// `handrail devices test joystick` and `calibrate`, over a stand-in for libcomedi.
#include <gmock/gmock.h>

#include <functional>
#include <utility>

#include "devices/comedi/comedi_joystick_driver.h"
#include "tests/unit/comedi/joystick_bench.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class JoystickTrialTest : public test::JoystickBench {
 protected:
  TestItem item(const std::string& check) const {
    for (const TestItem& one : test->items()) {
      if (one.check == check) return one;
    }
    return {"", Verdict::kNotSeen, "", ""};
  }
  // Time runs ahead of the thread's: a turn each millisecond is `pace`, or three where it pushes.
  bool run(const std::function<bool()>& what, Nanos pace = 10 * kMillisecond) {
    for (int i = 0; i < 20'000; ++i) {
      const bool pushes = test->asks().starts_with("hold it loosely");
      if (!test->turn(now += pushes ? 3 * kMillisecond : pace)) return true;
      if (what()) return false;
      sleep_until(monotonic_now() + kMillisecond);
    }
    ADD_FAILURE() << "it does not end: " << test->asks();
    return true;
  }
  Nanos now = kSecond;
};

TEST_F(JoystickTrialTest, ItIsHomedByHandAndThenLookedAtWithAForce) {
  options.homing = StickHoming::kStops;
  auto started = ComediJoystickDriver(options).test({.alone = false, .force = 2.0});
  ASSERT_TRUE(started) << started.message();
  opened = true;
  test = std::move(*started);
  EXPECT_THAT(test->asks(), HasSubstr("both of its stops, right-left"));
  int step = 0;
  EXPECT_FALSE(run([&] {
    ++step;
    turn(0, step < 30 ? -1070 : step < 60 ? 1070 : 0);
    turn(1, step < 90 ? 0 : step < 120 ? -1070 : step < 150 ? 1070 : 0);
    return step > 180;
  }));
  EXPECT_EQ(item("homing").verdict, Verdict::kOk) << item("homing").fact;
  double x = 0.0, y = 0.0;  // [counts]
  std::string asked;
  run([&] {
    if (test->asks() == "move it right") x += 2.0;
    if (test->asks() == "move it up") y += 2.0;
    // A hand of 10 counts a volt gives way.
    turn(0, static_cast<int>(x + 100.0 * volts(0)));
    turn(1, static_cast<int>(y + 100.0 * volts(1)));
    return false;
  });
  for (const char* check : {"move.right", "move.up", "force.right", "force.up"}) {
    EXPECT_EQ(item(check).verdict, Verdict::kOk) << check << ": " << item(check).fact;
  }
  EXPECT_EQ(item("move.toward").check, "");
  EXPECT_EQ(item("card").verdict, Verdict::kOk);
  EXPECT_THAT(test->block(), HasSubstr("device { kind: JOYSTICK joystick { library: "));
}

TEST_F(JoystickTrialTest, OneThatNobodyHomesIsSaid) {
  options.homing = StickHoming::kStops;
  auto started = ComediJoystickDriver(options).test({});
  ASSERT_TRUE(started) << started.message();
  opened = true;
  test = std::move(*started);
  EXPECT_TRUE(run([] { return false; }, kSecond));
  EXPECT_EQ(item("homing").verdict, Verdict::kBad);
  EXPECT_THAT(item("homing").fact, HasSubstr("it went 0 by 0 mm of the 200"));
}

TEST_F(JoystickTrialTest, CalibrationFindsTheTravel) {
  options.homing = StickHoming::kStops;
  options.button_channels = {1};
  options.encoder_subdevice = {3, 3};
  auto started = ComediJoystickDriver(options).calibrate();
  ASSERT_TRUE(started) << started.message();
  opened = true;
  test = std::move(*started);
  int step = 0;
  EXPECT_TRUE(run([&] {
    ++step;
    turn(0, step < 30 ? -1100 : step < 60 ? 1100 : 0);
    turn(1, step < 90 ? 0 : step < 120 ? -1130 : step < 150 ? 1130 : 0);
    return false;
  }));
  EXPECT_EQ(item("travel.right").verdict, Verdict::kOk);
  EXPECT_THAT(item("travel.up").fact, HasSubstr("from stop to stop 213.0 mm"));
  // 2200 counts are 207.3 mm.
  EXPECT_THAT(test->block(), HasSubstr("encoder_subdevice: [3, 3] button_channel: [1] travel_mm: "
                                       "207 } }"));
}

// 2460 counts are 231.8 mm, more than there is room for where it is homed: that is what is found.
TEST_F(JoystickTrialTest, CalibrationFindsATravelThatIsTooLong) {
  options.homing = StickHoming::kStops;
  auto started = ComediJoystickDriver(options).calibrate();
  ASSERT_TRUE(started) << started.message();
  opened = true;
  test = std::move(*started);
  int step = 0;
  EXPECT_TRUE(run([&] {
    ++step;
    turn(0, step < 30 ? -1230 : step < 60 ? 1230 : 0);
    turn(1, step < 90 ? 0 : step < 120 ? -1060 : step < 150 ? 1060 : 0);
    return false;
  }));
  EXPECT_EQ(item("travel.right").verdict, Verdict::kBad);
  EXPECT_THAT(item("travel.right").fact, HasSubstr("from stop to stop 231.8 mm"));
  EXPECT_THAT(item("card").fact, HasSubstr("it was gone 0 times"));
}

}  // namespace
}  // namespace handrail
