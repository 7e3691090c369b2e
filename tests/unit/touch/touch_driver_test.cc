// The Touch as `handrail devices` sees it.
#include "devices/touch/touch_driver.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/support/temp_folder.h"
#include "tests/unit/touch/touch_bench.h"

namespace handrail {
namespace {

using test::HdState;
using ::testing::HasSubstr;

class TouchDriverTest : public test::TouchBench {
 protected:
  TouchDriver driver() {
    return TouchDriver(options, folder.path() + "/usb", folder.path() + "/dev");
  }
  void plug() {
    folder.write("usb/1-2/idVendor", "2988\n");
    folder.write("usb/1-2/idProduct", "0302\n");
    folder.write("usb/1-2/product", "Touch\n");
  }
  // Until the test ends, or `what` holds after a turn. The test's time runs ahead of the
  // stand-in's, and less where it pushes.
  bool run(const std::function<bool()>& what = [] { return false; }) {
    for (Nanos now = monotonic_now();;) {
      const bool pushes = test->asks().starts_with("hold it loosely");
      if (!test->turn(now += (pushes ? 3 : 10) * kMillisecond)) return true;
      if (what()) return false;
      sleep_until(monotonic_now() + kMillisecond);
    }
  }
  // The person moves the stylus where it is asked to go.
  void obey() {
    const std::string asked = test->asks();
    const int axis = asked == "move it right"        ? 0
                     : asked == "move it up"         ? 1
                     : asked == "move it toward you" ? 2
                                                     : -1;
    if (asked != asked_) turned_ = 0.0;
    hd([&](HdState& s) {
      if (axis >= 0) s.target[static_cast<std::size_t>(axis)] += 0.15;  // 150 mm/s
      const double angle = 0.5 * std::min(1.0, turned_);
      if (asked == "hold it still") s.turn = {1.0, 0.0, 0.0, 0.0};
      if (asked.starts_with("tip its top toward"))
        s.turn = {std::cos(angle), std::sin(angle), 0, 0};
      if (asked.starts_with("turn it")) s.turn = {std::cos(angle), 0, std::sin(angle), 0};
      if (asked.starts_with("tip its top to the"))
        s.turn = {std::cos(angle), 0, 0, std::sin(angle)};
      s.buttons = asked.starts_with("press button 1")   ? 1
                  : asked.starts_with("press button 2") ? 2
                                                        : 0;
    });
    asked_ = asked;
    turned_ += 0.002;
  }
  TestItem item(const std::string& check) const {
    for (const TestItem& one : test->items()) {
      if (one.check == check) return one;
    }
    ADD_FAILURE() << "no item " << check;
    return {};
  }
  void TearDown() override {
    test.reset();
    TouchBench::TearDown();
  }

  TempFolder folder;
  std::unique_ptr<SelfTest> test;

 private:
  std::string asked_;
  double turned_ = 0.0;
};

TEST_F(TouchDriverTest, WhatIsMissingIsSaidOfCablePortAndLibrary) {
  options.library = "/nowhere/libHD.so";
  EXPECT_EQ(driver().probe().at(0).readiness, Readiness::kAbsent);
  EXPECT_EQ(driver().probe().at(1).readiness, Readiness::kAbsent);
  options.library = HANDRAIL_HD_STAND_IN;
  EXPECT_EQ(driver().probe().at(0).readiness, Readiness::kReady);
  EXPECT_THAT(driver().probe().at(0).fact, HasSubstr("no Touch on USB; libHD may have one"));
  options.library = "/nowhere/libHD.so";
  plug();
  EXPECT_EQ(driver().probe().at(0).fact, "2988:0302 Touch");
  EXPECT_EQ(driver().probe().at(1).readiness, Readiness::kUnfinished);
  EXPECT_THAT(driver().probe().at(1).next, HasSubstr("install TouchDriver"));
  options.library = "libm.so.6";
  EXPECT_THAT(driver().probe().at(1).fact, HasSubstr("has no hdInitDevice"));
  options.library = HANDRAIL_HD_STAND_IN;
  EXPECT_EQ(driver().probe().at(1).readiness, Readiness::kReady);
  const std::string port = folder.write("dev/ttyACM0", "");
  ASSERT_EQ(::chmod(port.c_str(), 0), 0);
  if (::access(port.c_str(), R_OK) == 0) return;  // root may use everything
  EXPECT_EQ(driver().probe().at(0).readiness, Readiness::kUnfinished);
  EXPECT_THAT(driver().probe().at(0).next, HasSubstr("usermod -aG dialout"));
}

TEST_F(TouchDriverTest, CalibrationHomesItAndSaysHow) {
  hd([](HdState& s) { s.calibration = kHdNeedsManual; });
  options.name = "Default PHANToM";
  auto started = driver().calibrate();
  ASSERT_TRUE(started) << started.message();
  test = std::move(*started);
  ASSERT_FALSE(run([&] { return !test->asks().empty(); }));
  EXPECT_EQ(test->asks(), "put the stylus into the inkwell, all the way");
  EXPECT_EQ(item("homing").verdict, Verdict::kNotSeen);
  hd([](HdState& s) { s.calibration = kHdNeedsUpdate; });
  ASSERT_TRUE(run());
  EXPECT_EQ(item("homing").verdict, Verdict::kOk);
  EXPECT_EQ(item("device").fact, "PHANTOM Omni, serial number 1234, driver 4.2.122");
  EXPECT_EQ(item("errors").verdict, Verdict::kOk);
  EXPECT_THAT(test->block(), HasSubstr("kind: TOUCH touch { name: \"Default PHANToM\""));
}

TEST_F(TouchDriverTest, MovedTurnedPressedAndPushedItIsAllRight) {
  auto started = driver().test({.force = 1.0});
  ASSERT_TRUE(started) << started.message();
  test = std::move(*started);
  ASSERT_TRUE(run([&] {
    obey();
    return false;
  }));
  for (const TestItem& one : test->items()) {
    // A busy computer turns the library's thread more slowly.
    if (one.check == "servo" || one.check == "readings" || one.check == "rate") continue;
    EXPECT_EQ(one.verdict, Verdict::kOk) << one.check << ": " << one.fact;
  }
  EXPECT_THAT(item("servo").fact, HasSubstr("times a second, 900 to 1100 expected"));
  EXPECT_THAT(item("force.right").fact, HasSubstr("with up to 0.88 N it gave way"));
  EXPECT_LE(hd([](HdState& s) { return s.most_force; }), 0.88 + 1e-9);
  test.reset();
  EXPECT_FALSE(hd([](HdState& s) { return s.output; }));
}

TEST_F(TouchDriverTest, HeatAndErrorsStandInTheReportWithWhatToDo) {
  auto started = driver().test({.alone = true});
  ASSERT_TRUE(started) << started.message();
  test = std::move(*started);
  hd([](HdState& s) {
    s.temperature = 0.97;
    s.tick_error = kHdWarmMotors;
  });
  ASSERT_TRUE(run());
  EXPECT_EQ(item("heat").verdict, Verdict::kBad);
  EXPECT_THAT(item("heat").fact, HasSubstr("0.97 of 1"));
  EXPECT_EQ(item("errors").verdict, Verdict::kBad);
  EXPECT_THAT(item("errors").fact, HasSubstr("0x200 (internal 513)"));
  EXPECT_THAT(item("errors").next, HasSubstr("cool down"));
}

TEST_F(TouchDriverTest, WhatCannotBeOpenedIsSaid) {
  hd([](HdState& s) { s.init_error = kHdAlreadyInitiated; });
  EXPECT_THAT(driver().test({}).message(), HasSubstr("another program has it"));
}

}  // namespace
}  // namespace handrail
