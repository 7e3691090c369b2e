// The table of drivers, and what holds of every row.
#include "devices/catalogue/catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "devices/config/device_config_io.h"
#include "server/base/clock.h"
#include "server/scene/config_io.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

// Where nothing is: no input device, no USB, no spacenavd, and nobody at the two ports.
DeviceSettings nowhere(const TempFolder& folder) {
  DeviceSettings out;
  out.hand.spacemouse.socket = folder.path() + "/spnav.sock";
  out.hand.touch.library = folder.path() + "/libHD.so";
  out.hand.joystick.place.library = folder.path() + "/libcomedi.so.0";
  out.card_sensor.place.library = folder.path() + "/libcomedi.so.0";
  out.robot.port = out.sensor.port = 9;  // discard: nothing answers there
  out.input_folder = folder.path() + "/input";
  out.usb_folder = folder.path() + "/usb";
  return out;
}

bool is_of_the_master(const Driver& driver) { return driver.daemon() == "handrail-master"; }

// What a block that a driver writes means to the daemon that reads it.
void expect_read(const Driver& driver, const std::string& block, const TempFolder& folder) {
  const std::string file = folder.write("block.conf", block + '\n');
  if (is_of_the_master(driver)) {
    const auto config = load_master_config(file, "", "");
    EXPECT_TRUE(config) << block << ": " << config.message();
  } else {
    const auto config = load_slave_config(file, "");
    EXPECT_TRUE(config) << block << ": " << config.message();
  }
}

// In virtual time, to its end.
void run(SelfTest& test) {
  Nanos now = kSecond;
  for (int i = 0; i < 200'000 && test.turn(now); ++i) now += kMillisecond;
}

TEST(Catalogue, EachDriverHasANameOfItsOwnAndIsFoundByIt) {
  std::set<std::string> names;
  for (const DriverRow& row : driver_rows()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(find_driver(row.name), &row);
  }
  EXPECT_EQ(driver_names().size(), names.size());
  EXPECT_EQ(find_driver("spacemice"), nullptr);
}

TEST(Catalogue, WhereNothingIsEachDriverSaysSoAndWhatToDo) {
  const TempFolder folder;
  for (const DriverRow& row : driver_rows()) {
    const auto driver = row.make(nowhere(folder));
    EXPECT_NE(driver->what(), "") << row.name;
    EXPECT_TRUE(is_of_the_master(*driver) || driver->daemon() == "handrail-slave") << row.name;
    const std::vector<Sighting> seen = driver->probe();
    ASSERT_FALSE(seen.empty()) << row.name;
    for (const Sighting& one : seen) {
      EXPECT_NE(one.fact, "") << row.name;
      if (one.readiness == Readiness::kReady) {
        EXPECT_TRUE(row.simulated) << row.name << ": " << one.fact;
      } else {
        EXPECT_NE(one.next, "") << row.name << ": " << one.fact;
      }
    }
    if (row.simulated) continue;
    EXPECT_FALSE(driver->calibrate()) << row.name;
    // The sensor's socket opens, whoever is at its other end.
    EXPECT_EQ(driver->test({}).is_ok(), std::string(row.name) == "net-ft") << row.name;
  }
}

TEST(Catalogue, EverySimulatedDeviceIsDrivenByItsOwnHandAndFeelsTheForce) {
  const TempFolder folder;
  for (const DriverRow& row : driver_rows()) {
    if (!row.simulated || std::string(row.name) == "recorded") continue;
    const auto driver = row.make(nowhere(folder));
    auto test = driver->test({.alone = false, .force = 5.0});
    ASSERT_TRUE(test) << row.name << ": " << test.message();
    run(**test);
    for (const TestItem& item : (*test)->items()) {
      EXPECT_EQ(item.verdict, Verdict::kOk) << row.name << " " << item.check << ": " << item.fact;
    }
    // The joystick moves in a plane: nobody is asked to go toward or away.
    const bool flat = std::string(row.name) == "sim-joystick";
    const std::vector<TestItem> items = (*test)->items();
    EXPECT_EQ(std::any_of(items.begin(), items.end(),
                          [](const TestItem& i) { return i.check == "move.toward"; }),
              !flat);
    expect_read(*driver, (*test)->block(), folder);
    EXPECT_THAT(driver->calibrate().message(), HasSubstr("nothing to calibrate"));
  }
}

TEST(Catalogue, ARecordingNeedsItsFileAndIsOnlyWatched) {
  const TempFolder folder;
  DeviceSettings settings = nowhere(folder);
  const auto without = find_driver("recorded")->make(settings);
  EXPECT_EQ(without->probe().at(0).readiness, Readiness::kUnfinished);
  EXPECT_THAT(without->test({}).message(), HasSubstr("expected the path of a CSV file"));
  settings.hand.kind = HapticDeviceKind::kRecorded;
  settings.hand.recording_path =
      folder.write("hand.csv", "t_s,x_mm,y_mm,z_mm\n0,0,0,0\n1,0,0,0\n60,0,0,0\n");
  const auto with = find_driver("recorded")->make(settings);
  EXPECT_EQ(with->probe().at(0).readiness, Readiness::kReady) << with->probe().at(0).fact;
  auto test = with->test({});
  ASSERT_TRUE(test) << test.message();
  run(**test);
  EXPECT_EQ((*test)->items().size(), 2u);
  expect_read(*with, (*test)->block(), folder);
}

TEST(Catalogue, WhatTheFilesThatWereGivenWantIsWanted) {
  const TempFolder folder;
  DeviceSettings settings = nowhere(folder);
  const auto wanted = [&settings] {
    std::vector<std::string> out;
    for (const DriverRow& row : driver_rows()) {
      if (row.wanted(settings)) out.emplace_back(row.name);
    }
    return out;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(wanted(), Names{});
  settings.master_given = true;
  EXPECT_EQ(wanted(), Names{"sim-omni"});
  settings.hand.kind = HapticDeviceKind::kSpaceMouse;
  EXPECT_EQ(wanted(), Names{"spacemouse"});
  settings.hand.kind = HapticDeviceKind::kTouch;
  EXPECT_EQ(wanted(), Names{"touch"});
  settings.hand.kind = HapticDeviceKind::kGamepad;
  EXPECT_EQ(wanted(), Names{"gamepad"});
  settings.hand.kind = HapticDeviceKind::kForceStick;
  EXPECT_EQ(wanted(), Names{"force-stick"});
  settings.hand.kind = HapticDeviceKind::kSpaceMouse;
  settings.slave_given = true;
  EXPECT_EQ(wanted(), (Names{"spacemouse", "melfa", "net-ft"}));
  settings.has_sensor = false;
  settings.stop_switch.path = "/dev/input/event7";
  EXPECT_EQ(wanted(), (Names{"spacemouse", "stop-switch", "melfa"}));
}

TEST(Catalogue, TheSensorOnTheHandleIsAskedForByTheMastersFile) {
  const TempFolder folder;
  DeviceSettings settings = nowhere(folder);
  const DriverRow* const row = find_driver("handle-ft");
  EXPECT_EQ(row->make(settings)->probe().at(0).fact, "none is configured");
  EXPECT_THAT(row->make(settings)->test({}).message(),
              HasSubstr("handle_sensor { sensor { address } } in the master's file"));
  settings.master_given = true;
  EXPECT_FALSE(row->wanted(settings));
  settings.has_handle = true;
  EXPECT_TRUE(row->wanted(settings));
  settings.handle_taken = true;
  EXPECT_THAT(row->make(settings)->test({}).message(), HasSubstr("end the master first"));
  settings.handle_at_card = true;
  settings.card_handle.place.library = folder.path() + "/libcomedi.so.0";
  EXPECT_THAT(row->make(settings)->probe().at(0).place, HasSubstr("libcomedi"));
}

TEST(Catalogue, WhatAnotherProgramSpeaksWithIsLeftAlone) {
  const TempFolder folder;
  DeviceSettings settings = nowhere(folder);
  settings.robot_taken = settings.sensor_taken = true;
  for (const char* name : {"melfa", "net-ft"}) {
    const auto driver = find_driver(name)->make(settings);
    EXPECT_EQ(driver->probe().at(0).readiness, Readiness::kReady);
    EXPECT_THAT(driver->probe().at(0).fact, HasSubstr("another program of this computer"));
    EXPECT_THAT(driver->test({}).message(), HasSubstr("end the slave first")) << name;
    EXPECT_FALSE(driver->calibrate());
  }
}

}  // namespace
}  // namespace handrail
