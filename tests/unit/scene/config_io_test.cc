#include "server/scene/config_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include "server/base/own_places.h"
#include "server/scene/payload_io.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

// The error of a file with this text, without the file's folder.
template <typename Load>
std::string config_error(Load load, const std::string& text) {
  const TempFolder folder;
  const std::string file = folder.write("c.conf", text);
  const std::string error = load(file).message();
  return error.starts_with(folder.path()) ? error.substr(folder.path().size() + 1) : error;
}
std::string master_error(const std::string& text) {
  return config_error([](const std::string& file) { return load_master_config(file); }, text);
}
std::string slave_error(const std::string& text) {
  return config_error([](const std::string& file) { return load_slave_config(file); }, text);
}
std::string rig_error(const std::string& text) { return config_error(load_rig_config, text); }

TEST(Config, DefaultsNeedNoFileAndAreValid) {
  ASSERT_TRUE(load_master_config("").is_ok());
  const std::string link = default_link_socket();
  EXPECT_EQ(link, "/tmp/handrail-" + std::to_string(::geteuid()) + "/link.sock");
  EXPECT_EQ(load_master_config("")->link_socket(), link);
  EXPECT_EQ(load_slave_config("")->link_socket(), link);
  EXPECT_FALSE(load_master_config("")->has_slave()) << "plain, on this computer";
  EXPECT_FALSE(load_slave_config("")->has_link_address());
  EXPECT_EQ(load_slave_config("")->robot().packet_bytes(), 196U);
  EXPECT_EQ(load_rig_config("")->servo_lag_ms(), 45.0);
  EXPECT_EQ(master_error(""), "");
  EXPECT_EQ(slave_error(""), "");
  EXPECT_EQ(rig_error(""), "");
}

// Two users of a computer can start with the same ports.
TEST(Config, AnAddressThatIsAbsentIsTheUsersOwn) {
  const std::string own = own_address();
  EXPECT_EQ(own.substr(0, 4), "127.");
  EXPECT_EQ(load_slave_config("")->robot().address(), own);
  EXPECT_EQ(load_slave_config("")->force_sensor().address(), own);
  EXPECT_EQ(load_rig_config("")->address(), own);
  const TempFolder folder;
  const auto slave = load_slave_config(
      folder.write("c.conf", "robot { port: 1 } force_sensor { address: '192.168.0.1' }"));
  EXPECT_EQ(slave->robot().address(), own);
  EXPECT_EQ(slave->force_sensor().address(), "192.168.0.1");
}

TEST(Config, AcceptsPortZeroWhereADaemonListens) {
  EXPECT_EQ(slave_error("link_port: 0"), "");
  EXPECT_EQ(rig_error("robot_port: 0 sensor_port: 0"), "");
}

TEST(Config, RefusesPortZeroWhereADaemonSends) {
  EXPECT_EQ(slave_error("robot { port: 0 }"),
            "c.conf:1:9: field 'robot.port': 0 is no port to send to, expected 1 to 65535");
}

TEST(Config, RefusesAddressesThatAreNone) {
  EXPECT_EQ(slave_error("robot { address: 'localhost' }"),
            "c.conf:1:9: field 'robot.address': 'localhost' is not an IPv4 address such as "
            "127.0.0.1");
  EXPECT_EQ(rig_error("address: '127.0.0.256'"),
            "c.conf:1:1: field 'address': '127.0.0.256' is not an IPv4 address such as 127.0.0.1");
}

TEST(Config, WhoStillHasWhatIsGoneIsToldWhatTookItsPlace) {
  EXPECT_EQ(master_error("scene: 'plane'\n  slave_port: 47002"),
            "c.conf:2:3: field 'slave_port': no longer used; in its place: link_socket on this "
            "computer, slave on another");
  EXPECT_EQ(master_error("link_port: 47001"),
            "c.conf:1:1: field 'link_port': no longer used; in its place: link_socket");
  for (const char* gone : {"link_address: '127.0.0.1'", "slave_address: '127.0.0.1'"}) {
    EXPECT_NE(master_error(gone).find("no longer used"), std::string::npos) << gone;
  }
}

TEST(Config, MasterAndSlaveAreToldOneLinkEach) {
  EXPECT_EQ(master_error("slave: 'arm:47002'"), "");
  EXPECT_EQ(slave_error("link_address: '10.0.0.1' link_port: 0"), "");
  EXPECT_EQ(master_error("slave: ''"),
            "c.conf:1:1: field 'slave': empty, expected HOST or HOST:PORT");
  EXPECT_EQ(master_error("slave: 'arm' link_socket: 'a'"),
            "c.conf:1:14: field 'link_socket': is for the plain link, but slave asks for the "
            "encrypted one: expected one of them");
  EXPECT_EQ(slave_error("link_socket: 'a' link_port: 5"),
            "c.conf:1:1: field 'link_socket': is for the plain link, but link_port asks for the "
            "encrypted one: expected one of them");
  EXPECT_NE(slave_error("link_socket: 'a' link_address: '10.0.0.1'").find("one of them"),
            std::string::npos);
  EXPECT_EQ(slave_error("robot { address: '192.168.0.2' }"), "");
}

TEST(Config, RefusesAnyOtherPacketSizeOfTheController) {
  EXPECT_EQ(slave_error("robot { packet_bytes: 100 }"),
            "c.conf:1:9: field 'robot.packet_bytes': 100 is neither 64 nor 196");
  EXPECT_EQ(slave_error("robot { packet_bytes: 64 }"), "");
  EXPECT_EQ(slave_error("robot { gripper { } }"), "");
  EXPECT_EQ(slave_error("robot { gripper { close_output: 915 open_output: 900 } }"), "");
  EXPECT_THAT(slave_error("robot { gripper { open_output: 916 } }"),
              ::testing::HasSubstr("field 'robot.gripper.open_output': 916, expected another than "
                                   "close_output, 900, and at most 15 from it"));
  EXPECT_THAT(slave_error("robot { gripper { close_output: 901 open_output: 901 } }"),
              ::testing::HasSubstr("'robot.gripper.open_output': 901, expected another"));
}

TEST(Config, TakesThePayloadOfASensor) {
  const TempFolder folder;
  const Payload payload{0.5, {0.004, -0.002, 0.06}, {{1.5, -2.0, 0.7}, {0.05, -0.02, 0.01}}};
  const std::string file = folder.write("c.conf", payload_text(payload));
  const Result<pb::SlaveConfig> config = load_slave_config(file);
  ASSERT_TRUE(config.is_ok()) << config.message();
  const Payload read = payload_from(config->payload());
  EXPECT_DOUBLE_EQ(read.mass, 0.5);
  EXPECT_LT((read.centre_T - payload.centre_T).norm(), 1e-15);
  EXPECT_EQ(read.bias_T.force, payload.bias_T.force);
  EXPECT_EQ(read.bias_T.torque, payload.bias_T.torque);
  EXPECT_TRUE(payload_from(load_slave_config("")->payload()).is_none());
}

TEST(Config, RefusesAPayloadThatNoneIs) {
  EXPECT_EQ(slave_error("payload { mass_kg: 11 }"),
            "c.conf:1:11: field 'payload.mass_kg': 11 is outside 0 to 10 kg");
  EXPECT_EQ(slave_error("payload { mass_kg: -0.5 }"),
            "c.conf:1:11: field 'payload.mass_kg': -0.5 is outside 0 to 10 kg");
  EXPECT_EQ(slave_error("payload { mass_kg: nan }"),
            "c.conf:1:11: field 'payload.mass_kg': nan is not a finite number");
  EXPECT_EQ(slave_error("payload {\n  mass_kg: 1\n  centre_mm: [1, 2]\n}"),
            "c.conf:3:3: field 'payload.centre_mm': 2 values, expected 3");
  EXPECT_EQ(slave_error("payload { mass_kg: 1 centre_mm: [0, 0, 2000] }"),
            "c.conf:1:22: field 'payload.centre_mm[2]': 2000 is outside -1000 to 1000 mm");
  EXPECT_EQ(slave_error("payload { bias_n: [0, inf, 0] }"),
            "c.conf:1:11: field 'payload.bias_n[1]': inf is not a finite number");
  EXPECT_EQ(slave_error("payload { centre_mm: [0, 0, 20] }"),
            "c.conf:1:11: field 'payload.centre_mm': a centre without mass_kg, expected both or "
            "neither");
  EXPECT_EQ(slave_error("force_sensor { enabled: false }\npayload { mass_kg: 1 }"),
            "c.conf:2:1: field 'payload': hangs on a force sensor, but force_sensor.enabled is "
            "false");
  EXPECT_EQ(slave_error("force_sensor { range_n: 50 } payload { bias_n: [0, 0, -50] }"),
            "c.conf:1:40: field 'payload.bias_n[2]': -50 is not within the sensor's range, "
            "force_sensor.range_n: 50 N");
}

TEST(Config, RefusesAFilterLaterThanTheBumperCanReckonWith) {
  EXPECT_EQ(load_slave_config("")->force_sensor().filter_ms(), 0.0);
  EXPECT_EQ(slave_error("force_sensor { filter_ms: 50 }"), "");
  EXPECT_EQ(slave_error("force_sensor {\n  filter_ms: 51\n}"),
            "c.conf:2:3: field 'force_sensor.filter_ms': 51 is outside 0 to 50 ms");
  EXPECT_EQ(slave_error("force_sensor { filter_ms: -1 }"),
            "c.conf:1:16: field 'force_sensor.filter_ms': -1 is outside 0 to 50 ms");
}

TEST(Config, RefusesTwoEndsOnOnePort) {
  EXPECT_EQ(rig_error("sensor_port: 10000"),
            "c.conf:1:1: field 'sensor_port': 10000 is taken by robot_port");
  EXPECT_EQ(slave_error("robot { port: 49152 }"),
            "c.conf:1:1: field 'force_sensor.port': 49152 is taken by robot.port");
  EXPECT_EQ(slave_error("robot { port: 49152 address: '127.0.0.2' }"), "");
}

TEST(Config, MeasuresTheSocketsPath) {
  const std::string longest(107, 'a');
  EXPECT_EQ(socket_path_problem(longest), "");
  EXPECT_EQ(
      master_error("operator_socket: '" + longest + "a'"),
      "c.conf:1:1: field 'operator_socket': a path of 108 bytes, but a Unix socket's path has "
      "at most 107");
  EXPECT_NE(socket_path_problem(""), "");
}

// A master's own is beside it, and longer.
TEST(Config, MeasuresTheLinksPathWithRoomForItsMasters) {
  const std::string longest = "/" + std::string(91, 'a');
  EXPECT_EQ(master_socket(longest, 4194304).size(), 107u);
  for (const auto error : {master_error, slave_error}) {
    EXPECT_EQ(error("link_socket: '" + longest + "'"), "");
    EXPECT_EQ(error("link_socket: '" + longest + "a'"),
              "c.conf:1:1: field 'link_socket': a path of 93 bytes, but a Unix socket's path has "
              "room here for at most 92");
    EXPECT_EQ(error("link_socket: ''"),
              "c.conf:1:1: field 'link_socket': empty, expected the path of a Unix socket");
  }
}

TEST(Config, WantsARecordingForARecordedHandOnly) {
  EXPECT_EQ(master_error("device { kind: RECORDED }"),
            "c.conf:1:1: field 'device.recording': missing, but kind RECORDED plays a file");
  EXPECT_EQ(master_error("device { recording: 'a.csv' }"),
            "c.conf:1:10: field 'device.recording': only used with kind: RECORDED or SIM_JOYSTICK");
}

TEST(Config, ASpaceMouseHasItsOwnBlockAndEachButtonOnce) {
  using ::testing::HasSubstr;
  EXPECT_THAT(master_error("device { spacemouse { } }"),
              HasSubstr("only used with kind: SPACEMOUSE"));
  const std::string mouse = "device { kind: SPACEMOUSE spacemouse { ";
  EXPECT_THAT(master_error(mouse + "clutch_button: 1 } }"),
              HasSubstr("1 is taken by clutch_button"));
  EXPECT_THAT(master_error(mouse + "enable_button: 0 } }"),
              HasSubstr("0 is taken by clutch_button"));
  EXPECT_THAT(master_error(mouse + "enable_button: 1 } }"), HasSubstr("1 is taken by drop_button"));
  EXPECT_THAT(master_error(mouse + "drop_button: 32 } }"),
              HasSubstr("device.spacemouse.drop_button"));
  EXPECT_THAT(master_error(mouse + "motion { speed_mm_s: 501 } } }"), HasSubstr("speed_mm_s"));
}

TEST(Config, OnlyASensorOfOnRobotIsToldItsRateAndFilter) {
  using ::testing::HasSubstr;
  const std::string sensor = "force_sensor { dialect: ONROBOT ";
  for (const char* fine : {"rate_hz: 500", "rate_hz: 4", "sensor_filter_hz: 1.5",
                           "sensor_filter_hz: 0", "rate_hz: 1000 sensor_filter_hz: 150"}) {
    EXPECT_EQ(slave_error(sensor + fine + " }"), "") << fine;
  }
  EXPECT_THAT(slave_error(sensor + "rate_hz: 300 }"),
              HasSubstr("300 has no period of whole milliseconds, expected 1000, 500"));
  EXPECT_THAT(slave_error(sensor + "rate_hz: 3 }"), HasSubstr("force_sensor.rate_hz"));
  EXPECT_THAT(slave_error(sensor + "sensor_filter_hz: 100 }"),
              HasSubstr("100 is none of 0, 500, 150, 50, 15, 5 and 1.5"));
  EXPECT_THAT(slave_error("force_sensor { rate_hz: 500 }"),
              HasSubstr("'force_sensor.rate_hz': only used with dialect: ONROBOT"));
  EXPECT_THAT(slave_error("force_sensor { sensor_filter_hz: 50 }"),
              HasSubstr("'force_sensor.sensor_filter_hz': only used with dialect: ONROBOT"));
}

TEST(Config, ATouchHasItsOwnBlockAndItsLibraryAPathOrAName) {
  using ::testing::HasSubstr;
  EXPECT_THAT(master_error("device { touch { } }"), HasSubstr("only used with kind: TOUCH"));
  EXPECT_THAT(master_error("device { kind: TOUCH touch { library: '' } }"),
              HasSubstr("'device.touch.library': empty, expected a library such as libHD.so"));
  const TempFolder folder;
  const auto library = [&folder](const std::string& block) {
    return load_master_config(folder.write("t.conf", "device { kind: TOUCH " + block + " }"))
        ->device()
        .touch()
        .library();
  };
  EXPECT_EQ(library(""), "libHD.so");
  EXPECT_EQ(library("touch { library: 'libHD.so.3.4' }"), "libHD.so.3.4");
  EXPECT_EQ(library("touch { library: 'lib/libHD.so' }"), folder.path() + "/lib/libHD.so");
}

TEST(Config, AGamepadHasItsOwnBlockAndAWholePath) {
  using ::testing::HasSubstr;
  EXPECT_THAT(master_error("device { gamepad { } }"), HasSubstr("only used with kind: GAMEPAD"));
  EXPECT_THAT(master_error("device { kind: GAMEPAD gamepad { device: 'event5' } }"),
              HasSubstr("'device.gamepad.device': 'event5', expected the path of an input device"));
  EXPECT_THAT(master_error("device { kind: GAMEPAD gamepad { dead_share: 0.6 } }"),
              HasSubstr("device.gamepad.dead_share"));
  EXPECT_EQ(master_error("device { kind: GAMEPAD gamepad { device: '/dev/input/event5' } }"), "");
}

TEST(Config, AForceStickHasItsOwnBlockAndForceForAllItsAxes) {
  using ::testing::HasSubstr;
  EXPECT_THAT(master_error("device { force_stick { } }"),
              HasSubstr("only used with kind: FORCE_STICK"));
  const auto error = [](const std::string& fields) {
    return master_error("device { kind: FORCE_STICK force_stick { " + fields + " } }");
  };
  EXPECT_THAT(error("device: 'event5'"), HasSubstr("'device.force_stick.device': 'event5', "));
  EXPECT_THAT(error("full_force_n: [4, 0]"), HasSubstr("expected both, none, or axes: WHEEL"));
  EXPECT_THAT(error("full_force_n: [4]"), HasSubstr("device.force_stick.full_force_n"));
  EXPECT_THAT(error("full_force_n: [400, 4]"), HasSubstr("device.force_stick.full_force_n"));
  EXPECT_THAT(error("upload_hz: 50"), HasSubstr("device.force_stick.upload_hz"));
  EXPECT_EQ(error("full_force_n: [4, 0] axes: WHEEL"), "");
  EXPECT_EQ(error("full_force_n: [4, -4] device: '/dev/input/event5'"), "");
}

TEST(Config, TakesRelativePathsFromTheFilesFolder) {
  const TempFolder folder;
  const std::string file = folder.write(
      "c.conf",
      "scene_path: 'mine' scene_path: '/abs' device { kind: RECORDED recording: 'a.csv' }");
  const Result<pb::MasterConfig> config = load_master_config(file);
  ASSERT_TRUE(config.is_ok()) << config.message();
  EXPECT_EQ(config->device().recording(), folder.path() + "/a.csv");
  EXPECT_EQ(config->scene_path(0), folder.path() + "/mine");
  EXPECT_EQ(config->scene_path(1), "/abs");
  const std::string mouse =
      folder.write("m.conf", "device { kind: SPACEMOUSE spacemouse { socket: 'spnav.sock' } }");
  EXPECT_EQ(load_master_config(mouse)->device().spacemouse().socket(),
            folder.path() + "/spnav.sock");
  const std::string slave = folder.write("s.conf", "link_socket: 'run/link.sock'");
  EXPECT_EQ(load_slave_config(slave)->link_socket(), folder.path() + "/run/link.sock");
  EXPECT_EQ(load_master_config(slave)->link_socket(), folder.path() + "/run/link.sock");
}

TEST(Config, RefusesAFileThatIsNotThere) {
  EXPECT_EQ(load_slave_config("/nowhere/c.conf").message(),
            "/nowhere/c.conf: cannot open: No such file or directory");
}

TEST(Config, RefusesAFileOfMoreThanAMegabyte) {
  const std::string text(1 << 20, ' ');
  EXPECT_EQ(rig_error(text), "");
  EXPECT_EQ(rig_error(text + " "), "c.conf: larger than the 1048576 bytes allowed");
}

TEST(Config, WhereASlaveWaitsIsAnyOrAnAddress) {
  for (const char* address : {"any", "0.0.0.0", "192.0.2.7", "::", "2001:db8::7", "fe80::1%eth0"}) {
    const auto config = load_slave_config("", address);
    ASSERT_TRUE(config) << config.message();
    EXPECT_EQ(config->link_address(), address);
  }
  for (const char* address : {"robot", "192.0.2", "any:47002", "[::1]", "%eth0"}) {
    const auto config = load_slave_config("", address);
    ASSERT_FALSE(config) << address;
    EXPECT_THAT(config.message(),
                ::testing::HasSubstr("--link '" + std::string(address) + "': expected any"));
  }
  EXPECT_THAT(slave_error("link_address: 'robot'"),
              ::testing::HasSubstr("c.conf:1:1: field 'link_address': 'robot'"));
}

TEST(Config, OperatorsElsewhereAreWaitedForWhereItIsSaid) {
  EXPECT_FALSE(load_master_config("")->has_operator_address());
  EXPECT_EQ(load_master_config("", "", "any")->operator_address(), "any");
  EXPECT_EQ(load_master_config("")->operator_port(), 47003u);
  EXPECT_EQ(master_error("operator_address: '192.0.2.7' operator_port: 5"), "");
  EXPECT_THAT(load_master_config("", "", "desk").message(),
              ::testing::HasSubstr("--operators 'desk': expected any"));
  EXPECT_THAT(master_error("operator_address: 'desk'"),
              ::testing::HasSubstr("c.conf:1:1: field 'operator_address': 'desk': expected any"));
  EXPECT_EQ(
      master_error("operator_port: 5"),
      "c.conf:1:1: field 'operator_port': without operator_address, expected both or neither");
}

TEST(Config, AThreadThatNeverSleepsNeedsAProcessorBesideTheOthers) {
  EXPECT_FALSE(load_master_config("")->busy_poll());
  EXPECT_FALSE(load_slave_config("")->busy_poll());
  cpu_set_t all, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
  CPU_ZERO(&one);
  for (std::size_t i = 0; CPU_COUNT(&one) == 0; ++i) {
    if (CPU_ISSET(i, &all)) CPU_SET(i, &one);
  }
  if (CPU_COUNT(&all) > 1) {
    EXPECT_EQ(master_error("busy_poll: true") + slave_error("busy_poll: true"), "");
  }
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  const std::string problem =
      "c.conf:1:1: field 'busy_poll': true, but this program has one processor, expected two or "
      "more";
  EXPECT_EQ(master_error("busy_poll: true"), problem);
  EXPECT_EQ(slave_error("busy_poll: true"), problem);
  EXPECT_EQ(master_error("busy_poll: false"), "");
  ASSERT_EQ(sched_setaffinity(0, sizeof all, &all), 0);
}

TEST(Config, WhatIsTypedAfterLinkIsTakenInPlaceOfTheFiles) {
  const TempFolder folder;
  const std::string file = folder.write("m.conf", "slave: 'north'");
  EXPECT_EQ(load_master_config(file, "south:5")->slave(), "south:5");
  EXPECT_EQ(load_master_config(file)->slave(), "north");
}

}  // namespace
}  // namespace handrail
