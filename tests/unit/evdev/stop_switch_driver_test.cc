// Foot switches as `handrail devices` sees them, in a folder of the test's own.
#include "devices/evdev/stop_switch_driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"
#include "tests/unit/evdev/fake_switch.h"

namespace handrail {
namespace {

using test::FakeSwitch;
using ::testing::HasSubstr;

class StopSwitchDriverTest : public ::testing::Test {
 protected:
  StopSwitchDriver driver() { return StopSwitchDriver(options, folder.path(), kernel); }
  void start() {
    auto started = driver().test({});
    ASSERT_TRUE(started) << started.message();
    trial = std::move(*started);
  }
  // For `seconds`; true: it has ended.
  bool pass(double seconds) {
    for (const Nanos until = now + from_seconds(seconds); now < until; now += 10 * kMillisecond) {
      if (!trial->turn(now)) return true;
    }
    return false;
  }
  TestItem item(const std::string& check) const {
    for (const TestItem& one : trial->items()) {
      if (one.check == check) return one;
    }
    ADD_FAILURE() << "no item " << check;
    return {};
  }

  TempFolder folder;
  StopSwitchOptions options;
  FakeSwitch kernel;
  std::unique_ptr<SelfTest> trial;
  Nanos now = kSecond;
};

TEST_F(StopSwitchDriverTest, KeyboardsAreFoundByTheNamesThatStay) {
  folder.write("event0", "");
  EXPECT_THAT(driver().probe().at(0).place, HasSubstr("/event0"));
  const std::string kept = folder.write("by-id/usb-Foot-event-kbd", "");
  folder.write("by-id/usb-Mouse-event-mouse", "");
  const std::vector<Sighting> seen = driver().probe();
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].place, kept);
  EXPECT_EQ(seen[0].readiness, Readiness::kReady);
  EXPECT_EQ(seen[0].fact, "Foot switch has 2 keys");
}

TEST_F(StopSwitchDriverTest, WithoutPermissionItIsUnfinishedAndTheLineIsSaid) {
  folder.write("by-id/usb-Foot-event-kbd", "");
  kernel.refuse(EACCES);
  const Sighting seen = driver().probe().at(0);
  EXPECT_EQ(seen.readiness, Readiness::kUnfinished);
  EXPECT_THAT(seen.next, HasSubstr("usermod -aG input"));
  EXPECT_THAT(driver().test({}).message(), HasSubstr("usermod -aG input"));
}

TEST_F(StopSwitchDriverTest, TheConfiguredOneIsLookedAtAlone) {
  folder.write("by-id/usb-Keyboard-event-kbd", "");
  options.path = folder.path() + "/by-id/usb-Foot-event-kbd";
  kernel.refuse(ENOENT);
  EXPECT_EQ(driver().probe().at(0).readiness, Readiness::kAbsent);
  EXPECT_EQ(driver().probe().at(0).place, options.path);
  kernel.refuse(0);
  options.key = KEY_F;
  EXPECT_EQ(driver().probe().at(0).readiness, Readiness::kUnfinished);
  EXPECT_THAT(driver().probe().at(0).fact, HasSubstr("has no key 33"));
  options.key = KEY_A;
  EXPECT_EQ(driver().probe().at(0).readiness, Readiness::kReady);
}

TEST_F(StopSwitchDriverTest, WhichOfSeveralIsMeantHasToBeSaid) {
  EXPECT_THAT(driver().test({}).message(), HasSubstr("no input device in " + folder.path()));
  folder.write("by-id/a-event-kbd", "");
  folder.write("by-id/b-event-kbd", "");
  EXPECT_THAT(driver().test({}).message(),
              HasSubstr("2 devices may be meant; say which: --device"));
  options.path = folder.path() + "/by-id/b-event-kbd";
  EXPECT_TRUE(driver().test({}));
  EXPECT_THAT(driver().test({.alone = true}).message(), HasSubstr("leave out --alone"));
  // Who types at it goes on typing.
  EXPECT_EQ(kernel.grabbed(), 0);
}

TEST_F(StopSwitchDriverTest, PressedAndLetGoOfItsKeyIsLearned) {
  options.path = folder.path() + "/event7";
  start();
  EXPECT_EQ(trial->asks(), "leave the switch alone");
  ASSERT_FALSE(pass(0.6));
  EXPECT_EQ(trial->asks(), "press the switch");
  EXPECT_EQ(trial->block(), "");
  kernel.key(KEY_B, 1);
  ASSERT_FALSE(pass(0.1));
  EXPECT_EQ(trial->asks(), "let go of it");
  kernel.key(KEY_B, 0);
  ASSERT_TRUE(pass(0.1));
  EXPECT_EQ(trial->block(), "stop_switch { device: \"" + options.path + "\" key: 48 }");
  ASSERT_EQ(trial->items().size(), 3u);
  for (const TestItem& one : trial->items()) EXPECT_EQ(one.verdict, Verdict::kOk) << one.fact;
}

TEST_F(StopSwitchDriverTest, APressBetweenTwoTurnsIsSeen) {
  options.path = folder.path() + "/event7";
  start();
  ASSERT_FALSE(pass(0.6));
  kernel.key(KEY_B, 1);
  kernel.key(KEY_B, 0);
  ASSERT_TRUE(pass(0.1));
  EXPECT_EQ(item("press").verdict, Verdict::kOk);
}

TEST_F(StopSwitchDriverTest, AnotherKeyThanConfiguredIsBadAndCalibrationTakesAny) {
  options = {folder.path() + "/event7", KEY_A};
  start();
  ASSERT_FALSE(pass(0.6));
  kernel.key(KEY_B, 1);
  ASSERT_FALSE(pass(0.1));
  EXPECT_EQ(item("press").verdict, Verdict::kBad);
  EXPECT_EQ(item("press").fact, "key 48 went down, expected key 30");
  auto calibration = driver().calibrate();
  ASSERT_TRUE(calibration);
  trial = std::move(*calibration);
  ASSERT_FALSE(pass(0.6));
  kernel.key(KEY_B, 1);
  ASSERT_FALSE(pass(0.1));
  EXPECT_EQ(item("press").verdict, Verdict::kOk);
}

TEST_F(StopSwitchDriverTest, OneThatNobodyPressesOrThatIsDownAllTheTimeIsSaid) {
  options.path = folder.path() + "/event7";
  start();
  EXPECT_FALSE(pass(15.0));
  EXPECT_TRUE(pass(1.0));
  EXPECT_EQ(item("press").verdict, Verdict::kNotSeen);
  kernel.hold(true);
  start();
  EXPECT_TRUE(pass(16.0));
  EXPECT_EQ(item("alone").verdict, Verdict::kBad);
  EXPECT_THAT(item("alone").fact, HasSubstr("key 30 is down"));
}

TEST_F(StopSwitchDriverTest, UnpluggedItEnds) {
  options.path = folder.path() + "/event7";
  start();
  kernel.unplug();
  EXPECT_TRUE(pass(0.1));
  EXPECT_EQ(item("events").verdict, Verdict::kBad);
}

}  // namespace
}  // namespace handrail
