// Gamepads as `handrail devices` sees them.
#include "devices/evdev/gamepad_driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <thread>

#include "tests/support/fake_gamepad.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using test::FakeGamepad;
using ::testing::HasSubstr;

class GamepadDriverTest : public ::testing::Test {
 protected:
  GamepadDriverTest() {
    kernel.make_pad();
    options.input_folder = folder.path();
  }
  std::vector<Sighting> probe() { return GamepadDriver(options, kernel).probe(); }

  TempFolder folder;
  FakeGamepad kernel;
  GamepadOptions options;
};

TEST_F(GamepadDriverTest, EveryGamepadIsFoundAndNothingElse) {
  EXPECT_EQ(probe().at(0).readiness, Readiness::kAbsent);
  EXPECT_EQ(probe().at(0).next, "plug one in");
  folder.write("event0", "");
  folder.write("event1", "");
  ASSERT_EQ(probe().size(), 2u);
  EXPECT_EQ(probe()[1].fact, "Made-up pad, a gamepad");
  EXPECT_EQ(probe()[1].readiness, Readiness::kReady);
  kernel.make({KEY_A}, {});
  ASSERT_EQ(probe().size(), 1u);
  EXPECT_EQ(probe()[0].readiness, Readiness::kAbsent);
  options.path = folder.path() + "/event0";
  EXPECT_EQ(probe()[0].readiness, Readiness::kUnfinished);
}

TEST_F(GamepadDriverTest, WithoutPermissionOnlyWhatUdevNamesIsOne) {
  kernel.refuse(EACCES);
  folder.write("event0", "");
  EXPECT_EQ(probe().at(0).readiness, Readiness::kAbsent);
  folder.write("by-id/usb-Pad-event-joystick", "");
  EXPECT_EQ(probe().at(0).readiness, Readiness::kUnfinished);
  EXPECT_THAT(probe().at(0).next, HasSubstr("usermod -aG input"));
}

TEST_F(GamepadDriverTest, PushedAndPressedAsAskedItIsAllRight) {
  options.path = folder.write("event0", "");
  auto test = GamepadDriver(options, kernel).test({});
  ASSERT_TRUE(test) << test.message();
  struct Do {
    unsigned type, code;
    int value;
  };
  const std::map<std::string, Do> does = {
      {"move it right", {EV_ABS, ABS_X, 32767}},
      {"move it up", {EV_ABS, ABS_RY, -32768}},
      {"move it toward you", {EV_ABS, ABS_Y, 32767}},
      {"turn it counter-clockwise as seen from above", {EV_ABS, ABS_RX, -32768}},
      {"press button 1 (clutch)", {EV_KEY, BTN_TL, 1}},
      {"press button 2 (drops the tool)", {EV_KEY, BTN_SOUTH, 1}},
      {"press button 3 (dead-man)", {EV_KEY, BTN_TR, 1}}};
  std::string asked;
  const Do* doing = nullptr;
  Nanos now = kSecond, since = now;
  for (int i = 0; i < 200'000; ++i, now += kMillisecond) {
    // The device is opened by a thread of its own.
    if (i < 50) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if ((*test)->asks() != asked) {
      asked = (*test)->asks();
      since = now;
      const auto release = [&](unsigned type, unsigned code) {
        if (type == EV_ABS) kernel.axis(code, 0);
        if (type == EV_KEY) kernel.key(code, 0);
      };
      if (doing != nullptr) release(doing->type, doing->code);
      doing = nullptr;
    }
    if (doing == nullptr && does.count(asked) != 0 && now - since > kSecond / 2) {
      doing = &does.at(asked);
      if (doing->type == EV_ABS) kernel.axis(doing->code, doing->value);
      if (doing->type == EV_KEY) kernel.key(doing->code, doing->value);
    }
    if (!(*test)->turn(now)) break;
  }
  std::vector<std::string> checks;
  for (const TestItem& item : (*test)->items()) {
    if (item.check == "readings") continue;
    checks.push_back(item.check);
    EXPECT_EQ(item.verdict, Verdict::kOk) << item.check << ": " << item.fact;
  }
  EXPECT_EQ(checks,
            (std::vector<std::string>{"rate", "still", "move.right", "move.up", "move.toward",
                                      "turn.up", "button.1", "button.2", "button.3"}));
  EXPECT_THAT((*test)->block(), HasSubstr("kind: GAMEPAD gamepad { device: \"" + options.path));
  EXPECT_THAT(GamepadDriver(options, kernel).calibrate().message(), HasSubstr("dead_share"));
}

}  // namespace
}  // namespace handrail
