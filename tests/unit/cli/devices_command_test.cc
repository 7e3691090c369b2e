// handrail devices, as it is typed.
#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "client/cli/command.h"
#include "client/cli/devices/devices_run.h"
#include "proto/devices.pb.h"
#include "server/scene/config_io.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

struct DevicesRun {
  explicit DevicesRun(std::vector<std::string> args) {
    std::ostringstream out_stream, err_stream;
    args.insert(args.begin(), "devices");
    code = run_cli(args, Console{out_stream, err_stream});
    out = out_stream.str();
    err = err_stream.str();
  }
  template <typename Message>
  Message parsed() const {
    Message message;
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(out, &message).ok()) << out;
    return message;
  }
  ExitCode code;
  std::string out, err;
};

std::string whole_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(DevicesCommand, TheListHasEveryDriverWithWhatIsMissingAndTheNextStep) {
  const TempFolder folder;
  const std::string master =
      folder.write("m.conf", "device { kind: SPACEMOUSE spacemouse { socket: 'none.sock' } }");
  const std::string slave = folder.write("s.conf",
                                         "robot { port: 9 } force_sensor { port: 19 }\n"
                                         "stop_switch { device: '/nowhere/event3' }");
  const std::vector<std::string> files = {"--master-config", master, "--slave-config", slave};
  std::vector<std::string> words = {"list"};
  words.insert(words.end(), files.begin(), files.end());
  const DevicesRun text(words);
  EXPECT_EQ(text.code, kExitDone) << text.err;
  for (const std::string& name : driver_names()) EXPECT_THAT(text.out, HasSubstr(name));
  EXPECT_THAT(text.out, HasSubstr("-> plug it in; only"));
  words.emplace_back("--json");
  const auto list = DevicesRun(words).parsed<pb::DeviceList>();
  std::map<std::string, pb::DeviceRow> rows;
  for (const pb::DeviceRow& row : list.devices()) rows[row.name()] = row;
  EXPECT_EQ(rows.size(), driver_rows().size());
  EXPECT_EQ(rows["spacemouse"].place(), folder.path() + "/none.sock");
  EXPECT_THAT(rows["spacemouse"].next(), HasSubstr("spacenavd"));
  EXPECT_EQ(rows["stop-switch"].place(), "/nowhere/event3");
  EXPECT_EQ(rows["stop-switch"].readiness(), pb::DeviceRow::ABSENT);
  EXPECT_TRUE(rows["page"].simulated());
  EXPECT_EQ(rows["page"].readiness(), pb::DeviceRow::READY);
}

TEST(DevicesCommand, ATestThatPassesWritesTheBlockToANewFileAlone) {
  const TempFolder folder;
  const std::string file = folder.path() + "/device.conf";
  const DevicesRun run({"test", "sim-omni", "--alone", "--json", "--out", file});
  EXPECT_EQ(run.code, kExitDone) << run.err;
  const auto report = run.parsed<pb::DeviceTestReport>();
  EXPECT_TRUE(report.passed());
  EXPECT_EQ(report.daemon(), "handrail-master");
  EXPECT_EQ(whole_of(file), report.block() + "\n");
  EXPECT_TRUE(load_master_config(file, "", ""));
  const DevicesRun again({"test", "sim-omni", "--alone", "--out", file});
  EXPECT_EQ(again.code, kExitUsage);
  EXPECT_THAT(again.err, HasSubstr("is there already, expected a new file"));
}

TEST(DevicesCommand, ATestThatDoesNotPassExitsWithOneAndSaysWhy) {
  const TempFolder folder;
  const std::string csv = folder.write("hand.csv", "t_s,x_mm,y_mm,z_mm\n0,0,0,0\n9,900,0,0\n");
  const std::string file =
      folder.write("m.conf", "device { kind: RECORDED recording: 'hand.csv' }");
  const DevicesRun moves({"test", "recorded", "--master-config", file});
  EXPECT_EQ(moves.code, kExitRefused);
  EXPECT_THAT(moves.out, HasSubstr("BAD       still"));
  EXPECT_THAT(moves.out, HasSubstr("for the file of handrail-master:\ndevice { kind: RECORDED"));
  const DevicesRun cannot({"calibrate", "page"});
  EXPECT_EQ(cannot.code, kExitRefused);
  EXPECT_THAT(cannot.err, HasSubstr("there is nothing to calibrate"));
}

TEST(DevicesCommand, WhatIsWronglyTypedIsNamed) {
  const TempFolder folder;
  const std::string bad = folder.write("bad.conf", "robot { port: 70000 }");
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"test", "spacmouse"}, "there is no 'spacmouse', did you mean 'spacemouse'?"},
      {{"test", "xyzzy"},
       "there is no 'xyzzy', expected spacemouse, touch, gamepad, joystick, "
       "force-stick, stop"},
      {{"test", "sim-omni", "--force", "41"}, "--force: '41'"},
      {{"test", "sim-omni", "--force", "much"}, "--force: 'much'"},
      {{"test", "page", "--device", "/dev/input/event5"}, "--device is for stop-switch"},
      {{"list", "--slave-config", bad}, "bad.conf:1:9: field 'robot.port'"},
      {{"list", "--master-config", "/nowhere/m.conf"}, "/nowhere/m.conf"},
      {{"test", "page", "--slave-config", bad}, "bad.conf:1:9"},
      {{"test"}, "NAME"}};
  for (const auto& [words, text] : cases) {
    const DevicesRun run(words);
    EXPECT_EQ(run.code, kExitUsage) << text;
    EXPECT_THAT(run.err, HasSubstr(text));
    EXPECT_EQ(run.out, "") << text;
  }
}

TEST(DevicesCommand, BrokenOffItSaysHowFarItCameAndWritesNoFile) {
  const TempFolder folder;
  std::ostringstream out, err;
  DevicesWords words;
  words.name = "sim-omni";
  words.out = folder.path() + "/device.conf";
  static int turns = 0;
  turns = 0;
  const auto after_a_while = [] { return ++turns > 50; };
  EXPECT_EQ(test_device(words, {out, err, after_a_while}), kExitInterrupted);
  EXPECT_THAT(out.str(), HasSubstr("readings"));
  EXPECT_THAT(out.str(), HasSubstr("broken off\n"));
  EXPECT_EQ(whole_of(*words.out), "");
}

TEST(DevicesCommand, TheFilesSayWhatIsLookedAt) {
  const TempFolder folder;
  DevicesWords words;
  words.slave_config = folder.write(
      "s.conf",
      "robot { address: '192.0.2.20' port: 11000 packet_bytes: 64 }\n"
      "force_sensor { address: '192.0.2.30' port: 50000 counts_per_n: 5 counts_per_n_m: 7 "
      "range_n: 80 }\nstop_switch { device: '/dev/input/event5' key: 48 }\n");
  words.master_config = folder.write(
      "m.conf",
      "device { kind: SPACEMOUSE spacemouse { full_counts: 300 enable_button: 2 motion { "
      "mode: POSITION reach_mm: 50 } } }");
  const auto settings = device_settings(words);
  ASSERT_TRUE(settings) << settings.message();
  EXPECT_EQ(settings->robot.address, "192.0.2.20");
  EXPECT_EQ(settings->robot.port, 11000);
  EXPECT_EQ(settings->robot.client.packet_bytes, 64u);
  EXPECT_EQ(settings->sensor.address, "192.0.2.30");
  EXPECT_EQ(settings->sensor.client.counts_per_n_m, 7.0);
  EXPECT_EQ(settings->sensor.range_n, 80.0);
  EXPECT_EQ(settings->stop_switch.path, "/dev/input/event5");
  EXPECT_EQ(settings->stop_switch.key, 48);
  EXPECT_EQ(settings->hand.kind, HapticDeviceKind::kSpaceMouse);
  EXPECT_EQ(settings->hand.spacemouse.full_counts, 300.0);
  EXPECT_EQ(settings->hand.spacemouse.enable_button, 2);
  EXPECT_EQ(settings->hand.spacemouse.motion.reach, 0.05);
  EXPECT_TRUE(settings->master_given && settings->slave_given && settings->has_sensor);
  EXPECT_EQ(settings->sensor.client.dialect, RdtDialect::kAti);
  words.slave_config = folder.write("o.conf",
                                    "force_sensor { dialect: ONROBOT rate_hz: 250 "
                                    "sensor_filter_hz: 15 counts_per_n: 5000 }");
  const RdtClientOptions hex = device_settings(words)->sensor.client;
  EXPECT_EQ(hex.dialect, RdtDialect::kOnRobot);
  EXPECT_EQ(hex.period_ms, 4u);
  EXPECT_EQ(hex.filter, 4u);
  EXPECT_EQ(hex.counts_per_n, 5e3);
  EXPECT_EQ(hex.counts_per_n_m, 1e5);
  words.device = "/dev/input/event9";
  EXPECT_EQ(device_settings(words)->stop_switch.path, "/dev/input/event9");
  EXPECT_EQ(device_settings(words)->stop_switch.key, std::nullopt);
  EXPECT_TRUE(wanted_devices(*device_settings({})).empty());
}

}  // namespace
}  // namespace handrail
