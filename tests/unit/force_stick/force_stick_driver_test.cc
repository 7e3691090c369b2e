// Force-feedback joysticks as `handrail devices` sees them.
#include "devices/force_stick/force_stick_driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "devices/config/device_config_io.h"
#include "server/base/clock.h"
#include "server/scene/config_io.h"
#include "tests/support/fake_force_stick.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using test::FakeForceStick;
using ::testing::HasSubstr;

class ForceStickDriverTest : public ::testing::Test {
 protected:
  ForceStickDriverTest() {
    options.path = folder.write("event0", "");
    options.input_folder = folder.path();
  }
  ForceStickOptions configured(const std::string& block) {
    const auto config = load_master_config(folder.write("m.conf", block), "", "");
    EXPECT_TRUE(config) << config.message();
    return haptic_options(config->device()).force_stick;
  }
  // Somebody who does as asked, and whose hand gives way to a force.
  void person(const std::string& asked) {
    const auto push = kernel.push();
    int x = 512, y = 512;
    if (asked == "move it right") x = 850;
    if (asked == "move it up") y = 200;
    if (asked.starts_with("hold it loosely")) {
      x += static_cast<int>(gives_way * 200 * push[0]);
      y -= static_cast<int>(gives_way * 200 * push[1]);
    }
    const auto follow = [](int& at, int to) {
      return std::exchange(at, at + std::clamp(to - at, -2, 2)) != at;
    };
    if (follow(x_, x)) kernel.axis(ABS_X, x_);
    if (follow(y_, y)) kernel.axis(ABS_Y, y_);
    for (const auto& [text, key] : {std::pair("press button 1 (clutch)", BTN_THUMB),
                                    std::pair("press button 2 (drops the tool)", BTN_THUMB2),
                                    std::pair("press button 3 (dead-man)", BTN_TRIGGER)}) {
      if (asked == text && asked != asked_) kernel.key(static_cast<unsigned>(key), 1);
    }
    asked_ = asked;
  }
  std::map<std::string, TestItem> tried(const TestWishes& wishes) {
    auto test = ForceStickDriver(options, kernel).test(wishes);
    EXPECT_TRUE(test) << test.message();
    // The trial's time runs ahead of the motors', and less where it pushes with them.
    for (Nanos now = monotonic_now(); (*test)->turn(now);) {
      const std::string asked = (*test)->asks();
      person(asked);
      now += (asked.starts_with("hold it loosely") ? 3 : 10) * kMillisecond;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::map<std::string, TestItem> out;
    for (const TestItem& item : (*test)->items()) out[item.check] = item;
    return out;
  }

  TempFolder folder;
  FakeForceStick kernel;
  ForceStickOptions options;
  double gives_way = 1.0;

 private:
  int x_ = 512, y_ = 512;
  std::string asked_;
};

TEST_F(ForceStickDriverTest, WhatTakesConstantForcesIsFoundAndNothingElse) {
  options.path.clear();
  const auto probe = [this] { return ForceStickDriver(options, kernel).probe().at(0); };
  EXPECT_EQ(probe().readiness, Readiness::kReady);
  EXPECT_EQ(probe().fact, "Made-up pad, takes constant forces; 1023 counts from end to end");
  kernel.give_effect(FF_RUMBLE);
  EXPECT_EQ(probe().readiness, Readiness::kAbsent);
  EXPECT_EQ(probe().fact, "no force-feedback joystick");
  options.path = folder.path() + "/event0";
  EXPECT_EQ(probe().readiness, Readiness::kUnfinished);
  EXPECT_THAT(probe().next, HasSubstr("device.force_stick.device"));
  options.axes = ForceStickAxes::kWheel;
  EXPECT_THAT(probe().fact, HasSubstr("has no axis X with a constant force"));
}

TEST_F(ForceStickDriverTest, PushedAndPressedAsAskedAndGivingWayItIsAllRight) {
  options.full = {4.0, 4.0};
  options.most_upload = 10.0;
  const auto items = tried({.alone = false, .force = 2.0});
  for (const char* check :
       {"force", "uploads", "readings", "rate", "still", "move.right", "move.up", "button.1",
        "button.2", "button.3", "force.right", "force.up"}) {
    ASSERT_TRUE(items.contains(check)) << check;
    EXPECT_EQ(items.at(check).verdict, Verdict::kOk) << check << ": " << items.at(check).fact;
  }
  EXPECT_EQ(items.size(), 12u);
  EXPECT_THAT(items.at("uploads").fact, HasSubstr(" 0 of them late and 0 refused"));
  EXPECT_TRUE(kernel.effects().empty());
}

TEST_F(ForceStickDriverTest, OneThatPushesTheOtherWayIsCalledReversed) {
  options.full = {4.0, -4.0};
  const auto items = tried({.alone = false, .force = 2.0});
  EXPECT_EQ(items.at("force.right").verdict, Verdict::kOk) << items.at("force.right").fact;
  EXPECT_EQ(items.at("force.up").verdict, Verdict::kBad);
  EXPECT_THAT(items.at("force.up").next, HasSubstr("the force is reversed"));
}

TEST_F(ForceStickDriverTest, WithoutAForceOrPermissionItSaysSo) {
  auto items = tried({.alone = true});
  EXPECT_EQ(items.at("force").verdict, Verdict::kNotSeen);
  EXPECT_THAT(items.at("force").next, HasSubstr("device.force_stick.full_force_n"));
  EXPECT_FALSE(items.contains("uploads"));
  options.full = {4.0, 4.0};
  items = tried({.alone = true});
  EXPECT_EQ(items.at("uploads").verdict, Verdict::kNotSeen) << "nobody asked for a force";
  options.full = {4.0, 4.0};
  kernel.make_motors(false);
  items = tried({.alone = true});
  EXPECT_EQ(items.at("uploads").verdict, Verdict::kBad);
  EXPECT_THAT(items.at("uploads").next, HasSubstr("usermod -aG input"));
}

TEST_F(ForceStickDriverTest, CalibrationFindsHowLongAnUploadTakesAndIsNotFelt) {
  options.full = {4.0, 4.0};
  kernel.slow(std::chrono::milliseconds(1));  // of each of the two axes
  auto timing = ForceStickDriver(options, kernel).calibrate();
  ASSERT_TRUE(timing) << timing.message();
  while ((*timing)->turn(monotonic_now())) {
    for (const auto& [id, effect] : kernel.effects()) {
      ASSERT_FALSE(effect.on);
      ASSERT_LE(effect.level, 1);
    }
  }
  EXPECT_EQ((*timing)->items().at(0).verdict, Verdict::kOk) << (*timing)->items().at(0).fact;
  const ForceStickOptions found = configured((*timing)->block());
  EXPECT_GE(found.most_upload, 2.5e-3);
  EXPECT_LE(found.most_upload, 10e-3);
  EXPECT_EQ(found.full, options.full);
  (*timing).reset();
  EXPECT_TRUE(kernel.effects().empty()) << "its slots are given back";
  // One that is too slow to be pushed with.
  kernel.slow(std::chrono::milliseconds(6));
  auto slow = ForceStickDriver(options, kernel).calibrate();
  ASSERT_TRUE(slow);
  EXPECT_EQ((*slow)->items().at(0).verdict, Verdict::kNotSeen) << "it was not run";
  while ((*slow)->turn(monotonic_now())) {
  }
  EXPECT_EQ((*slow)->items().at(0).verdict, Verdict::kBad);
  kernel.slots(0);
  auto refused = ForceStickDriver(options, kernel).calibrate();
  ASSERT_TRUE(refused);
  while ((*refused)->turn(monotonic_now())) {
  }
  EXPECT_THAT((*refused)->items().at(0).fact, HasSubstr("did not take a constant force"));
}

TEST_F(ForceStickDriverTest, WhatABlockSaysIsWhatTheDriverWritesAgain) {
  const std::string text = "device { kind: FORCE_STICK force_stick { device: \"" + options.path +
                           "\" axes: WHEEL reach_mm: 150 full_force_n: [7.5, 0] upload_hz: 500 "
                           "upload_ms: 2 delay_ms: 8 axis_counts: 900 mass_kg: 0.5 damping_n_s_m: "
                           "2 friction_n: 0.3 } }";
  const ForceStickOptions o = configured(text);
  EXPECT_EQ(o.axes, ForceStickAxes::kWheel);
  EXPECT_NEAR(o.reach, 0.15, 1e-12);
  EXPECT_EQ(o.full, (std::array<double, 2>{7.5, 0.0}));
  EXPECT_NEAR(o.upload_period, 2e-3, 1e-12);
  EXPECT_NEAR(o.most_upload, 2e-3, 1e-12);
  EXPECT_NEAR(o.delay, 8e-3, 1e-12);
  EXPECT_EQ(o.axis_counts, 900);
  EXPECT_EQ(o.mass, 0.5);
  EXPECT_EQ(o.damping, 2.0);
  EXPECT_EQ(o.friction, 0.3);
  const auto test = ForceStickDriver(o, kernel).test({.alone = true});
  ASSERT_TRUE(test) << test.message();
  EXPECT_EQ((*test)->block(), text);
  // Nothing said: as the options are.
  const ForceStickOptions usual = configured("device { kind: FORCE_STICK }"), fresh;
  EXPECT_EQ(usual.axes, fresh.axes);
  EXPECT_NEAR(usual.reach, fresh.reach, 1e-12);
  EXPECT_EQ(usual.full, fresh.full);
  EXPECT_NEAR(usual.upload_period, fresh.upload_period, 1e-12);
  EXPECT_NEAR(usual.most_upload, fresh.most_upload, 1e-12);
  EXPECT_NEAR(usual.delay, fresh.delay, 1e-12);
  EXPECT_EQ(usual.axis_counts, fresh.axis_counts);
  EXPECT_EQ(usual.mass, 0.0);
}

}  // namespace
}  // namespace handrail
