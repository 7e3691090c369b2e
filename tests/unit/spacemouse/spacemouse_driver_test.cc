// A SpaceMouse as `handrail devices` sees it, with a folder in place of the kernel's and a made-up
// spacenavd.
#include "devices/spacemouse/spacemouse_driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/spnav_server.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using test::spnav_device;
using test::spnav_motion;
using test::SpnavServer;
using ::testing::HasSubstr;

class SpaceMouseDriverTest : public ::testing::Test {
 protected:
  SpaceMouseDriverTest() { options.socket = folder.path() + "/spnav.sock"; }
  void plug(const std::string& vendor, const std::string& product, const std::string& name) {
    folder.write("usb/1-2/idVendor", vendor + "\n");
    folder.write("usb/1-2/idProduct", product + "\n");
    folder.write("usb/1-2/product", name + "\n");
  }
  std::vector<Sighting> probe() {
    return SpaceMouseDriver(options, folder.path() + "/usb").probe();
  }
  // The calibration that talks to `server`.
  void calibrate() {
    auto started = SpaceMouseDriver(options, folder.path() + "/usb").calibrate();
    ASSERT_TRUE(started) << started.message();
    test = std::move(*started);
    ASSERT_NE(server->accept(), 0u);
  }
  // For `seconds`; true: it has ended.
  bool pass(double seconds) {
    for (const Nanos until = now + from_seconds(seconds); now < until; now += kMillisecond) {
      if (!test->turn(now)) return true;
    }
    return false;
  }
  // Each axis that far, both ways.
  void push_all(int counts, int least_of_all) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      for (const int way : {-1, 1}) {
        std::array<std::int32_t, 6> pushed{};
        pushed[axis] = way * (axis == 3 && way < 0 ? least_of_all : counts);
        server->send(spnav_motion(pushed));
        ASSERT_FALSE(pass(0.1));
      }
    }
    server->send(spnav_motion({}));
  }
  TestItem item(const std::string& check) const {
    for (const TestItem& one : test->items()) {
      if (one.check == check) return one;
    }
    ADD_FAILURE() << "no item " << check;
    return {};
  }

  TempFolder folder;
  SpaceMouseOptions options;
  std::unique_ptr<SpnavServer> server;
  std::unique_ptr<SelfTest> test;
  Nanos now = kSecond;
};

TEST_F(SpaceMouseDriverTest, WhatIsMissingIsSaidInTheOrderInWhichItIsToBeDone) {
  EXPECT_EQ(probe().at(0).readiness, Readiness::kAbsent);
  EXPECT_THAT(probe().at(0).next, HasSubstr("plug it in"));
  EXPECT_EQ(probe().at(1).readiness, Readiness::kAbsent);

  plug("256f", "c635", "SpaceMouse Compact");
  EXPECT_EQ(probe().at(0).readiness, Readiness::kReady);
  EXPECT_EQ(probe().at(0).fact, "256f:c635 SpaceMouse Compact");
  EXPECT_EQ(probe().at(1).readiness, Readiness::kUnfinished);
  EXPECT_EQ(probe().at(1).place, options.socket);
  EXPECT_THAT(probe().at(1).next, HasSubstr("apt-get install spacenavd"));

  server = std::make_unique<SpnavServer>(options.socket);
  EXPECT_EQ(probe().at(1).readiness, Readiness::kReady);
}

TEST_F(SpaceMouseDriverTest, AnOrdinaryMouseOfLogitechIsNone) {
  plug("046d", "c626", "SpaceNavigator");
  EXPECT_EQ(probe().at(0).readiness, Readiness::kReady);
  plug("046d", "c626", "USB Optical Mouse");
  EXPECT_EQ(probe().at(0).readiness, Readiness::kAbsent);
  plug("046d", "c0ff", "SpaceBar Keyboard");
  EXPECT_EQ(probe().at(0).readiness, Readiness::kAbsent);
  plug("046g", "c626", "SpaceNavigator");
  EXPECT_EQ(probe().at(0).readiness, Readiness::kAbsent);
}

TEST_F(SpaceMouseDriverTest, WithSpacenavdAloneACapMayBeElsewhere) {
  server = std::make_unique<SpnavServer>(options.socket);
  EXPECT_EQ(probe().at(0).readiness, Readiness::kReady);
  EXPECT_THAT(probe().at(0).fact, HasSubstr("no SpaceMouse on USB; spacenavd may"));
}

TEST_F(SpaceMouseDriverTest, TheTestOpensTheDeviceAndItsErrorSaysWhatToDo) {
  EXPECT_THAT(SpaceMouseDriver(options).test({}).message(), HasSubstr("installed and started"));
  server = std::make_unique<SpnavServer>(options.socket);
  auto started = SpaceMouseDriver(options).test({.alone = true});
  ASSERT_TRUE(started) << started.message();
  EXPECT_THAT((*started)->block(), HasSubstr("kind: SPACEMOUSE"));
  EXPECT_THAT((*started)->block(), HasSubstr("full_counts: 350 "));
}

TEST_F(SpaceMouseDriverTest, TheLeastOfTheTwelveWaysIsFullDeflection) {
  server = std::make_unique<SpnavServer>(options.socket);
  calibrate();
  EXPECT_EQ(test->asks(), "leave the cap alone");
  ASSERT_FALSE(pass(1.6));
  EXPECT_THAT(test->asks(), HasSubstr("push the cap as far as it goes"));
  EXPECT_EQ(test->block(), "");
  push_all(400, 310);
  EXPECT_THAT(test->asks(), HasSubstr("each way was pushed"));
  ASSERT_TRUE(pass(3.2));
  EXPECT_THAT(test->block(), HasSubstr("full_counts: 310 "));
  for (const TestItem& one : test->items()) EXPECT_EQ(one.verdict, Verdict::kOk) << one.fact;
  EXPECT_THAT(item("axis.4").fact, HasSubstr("tipping: -310 to 400 counts"));
}

TEST_F(SpaceMouseDriverTest, AWayThatNobodyPushedLeavesItUnknown) {
  server = std::make_unique<SpnavServer>(options.socket);
  calibrate();
  ASSERT_FALSE(pass(1.6));
  push_all(400, 150);
  EXPECT_FALSE(pass(50.0));
  EXPECT_TRUE(pass(10.0));
  EXPECT_EQ(test->block(), "");
  EXPECT_EQ(item("full_counts").verdict, Verdict::kNotSeen);
}

TEST_F(SpaceMouseDriverTest, CountsAtRestAreBadAndNoPush) {
  server = std::make_unique<SpnavServer>(options.socket);
  calibrate();
  server->send(spnav_motion({0, 0, 0, 0, -30, 0}));
  ASSERT_FALSE(pass(1.4));
  EXPECT_EQ(item("rest").verdict, Verdict::kBad);
  EXPECT_THAT(item("rest").fact, HasSubstr("at most 30 counts while left alone"));
  EXPECT_THAT(item("axis.5").fact, HasSubstr("0 to 0 counts"));
}

TEST_F(SpaceMouseDriverTest, UnpluggedOrWithoutSpacenavdItEnds) {
  server = std::make_unique<SpnavServer>(options.socket);
  calibrate();
  server->send(spnav_device(false));
  EXPECT_TRUE(pass(5.0));
  EXPECT_EQ(item("spacenavd").verdict, Verdict::kBad);
  calibrate();
  server->end();
  EXPECT_TRUE(pass(5.0));
  EXPECT_EQ(item("spacenavd").verdict, Verdict::kBad);
}

}  // namespace
}  // namespace handrail
