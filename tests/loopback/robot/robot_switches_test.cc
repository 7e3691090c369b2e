// handrail robot at the rig: a user finds the controller off, brings it on, engages, and switches
// it off; and each thing that may be in the way, by the real programs.
#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>

#include "proto/devices.pb.h"
#include "server/model/reason.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class RobotSwitches : public WholeCell {
 protected:
  void SetUp() override {}
  void start(const std::string& switches, bool all = false, const std::string& more = "") {
    rig_extra = "switches { " + switches + " } " + more;
    start_rig();
    command_port = rig->number_after(" command_port=");
    robot_extra = "program: '1' command_port: " + std::to_string(command_port);
    start_slave();
    if (all) start_master();
  }
  std::pair<int, std::string> robot(std::vector<std::string> words) {
    words.insert(words.begin(), "robot");
    words.insert(words.end(), {"--slave-config", folder.path() + "/handrail-slave.cfg"});
    return handrail(words);
  }
  pb::RobotReport report(const std::string& order, int wanted_code) {
    const auto [code, text] = robot({order, "--json"});
    EXPECT_EQ(code, wanted_code) << text;
    pb::RobotReport out;
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(text, &out).ok()) << text;
    return out;
  }
  void expect_refused(const std::vector<std::string>& words, const std::string& fact,
                      const std::string& next) {
    const auto [code, text] = robot(words);
    EXPECT_EQ(code, 1) << text;
    EXPECT_THAT(text, HasSubstr(fact));
    EXPECT_THAT(text, HasSubstr("-> " + next));
    EXPECT_FALSE(report("status", 0).before().servo_on()) << "nothing was switched on";
  }

  int command_port = 0;
};

TEST_F(RobotSwitches, AControllerThatIsOffIsBroughtOnEngagedAndSwitchedOff) {
  start("off: true", true);
  const pb::RobotReport off = report("status", 0);
  EXPECT_TRUE(off.done());
  EXPECT_FALSE(off.ready());
  EXPECT_FALSE(off.before().servo_on());
  EXPECT_EQ(off.next(), "handrail robot on");
  EXPECT_THAT(robot({"status"}).second,
              HasSubstr("servos OFF, program '1' stands, override 100 %"));

  const auto [code, text] = robot({"on"});
  EXPECT_EQ(code, 0) << text;
  EXPECT_THAT(text, HasSubstr("servos OFF"));
  EXPECT_THAT(text, HasSubstr("  servos on\n  program '1' started\n"));
  EXPECT_THAT(text, HasSubstr("ready for real-time control"));
  EXPECT_THAT(robot({"on"}).second, HasSubstr("there was nothing to do"));
  ASSERT_TRUE(within(kPatience, [this] { return ask("engage: true").done(); }));
  ASSERT_TRUE(slave_reaches("engaged"));

  const pb::RobotReport ended = report("off", 0);
  EXPECT_TRUE(ended.done());
  EXPECT_FALSE(ended.after().servo_on());
  EXPECT_FALSE(ended.after().running());
  EXPECT_TRUE(slave_reaches("fault")) << "the slave sees that the arm is silent";
}

TEST_F(RobotSwitches, NothingIsSwitchedOnWhileTheSlaveHoldsAStop) {
  start("off: true", true);
  // Before that nobody would hear it.
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.slave_state() == "off"; }));
  order("stop: true");
  ASSERT_TRUE(slave_reaches("fault"));
  expect_refused({"on"}, "the slave holds a stop: stop was requested",
                 "take its cause away, then handrail reset");
}

TEST_F(RobotSwitches, TheSlaveSaysWhyTheControllerIsSilentUntilItIsNot) {
  start("off: true", true);
  const auto says = [this](Reason reason) {
    return eventually([&](const pb::Status& s) { return s.slave_reason() == describe(reason); });
  };
  ASSERT_TRUE(says(Reason::kRobotServosOff));
  EXPECT_THAT(slave->after(" is silent: "), HasSubstr("the servos are off; handrail robot on"));
  EXPECT_EQ(report("status", 0).before().servo_on(), false) << "it only looks";
  EXPECT_EQ(robot({"on"}).first, 0);
  ASSERT_TRUE(within(kPatience, [this] { return ask("engage: true").done(); }));
  ASSERT_TRUE(slave_reaches("engaged"));
  EXPECT_EQ(robot({"off"}).first, 0);
  ASSERT_TRUE(slave_reaches("fault"));
  EXPECT_TRUE(within(kPatience, [this] {
    return handrail({"why"}).second.find("'handrail robot on'") != std::string::npos;
  })) << handrail({"why"}).second;
}

TEST_F(RobotSwitches, TheSlaveNamesAnAlarmByItsNumber) {
  start("", true, "mxttout_cycles: 50");
  ASSERT_TRUE(within(kPatience, [this] { return ask("engage: true").done(); }));
  ASSERT_TRUE(slave_reaches("engaged"));
  slave->send(SIGSTOP);
  EXPECT_TRUE(within(kPatience, [this] { return report("status", 0).before().alarm() == 6130; }));
  slave->send(SIGCONT);
  EXPECT_THAT(slave->after(" is silent: "),
              HasSubstr("alarm 6130 (Network communication error) stands; take its cause away"));
}

TEST_F(RobotSwitches, TeachingModeIsNamed) {
  start("off: true teach: true");
  expect_refused({"on"}, "TEACH (manual), expected AUTOMATIC", "turn its key to AUTOMATIC");
}

TEST_F(RobotSwitches, AnEmergencyStopIsNamed) {
  start("emergency_stop: true");
  expect_refused({"on"}, "emergency stop is pressed", "release it there");
}

TEST_F(RobotSwitches, AnOverrideIsNamedAndMayBeWishedFor) {
  start("off: true override_percent: 25");
  expect_refused({"on"}, "the speed override is 25 %, expected 100",
                 "handrail robot on --override");
  const auto [code, text] = robot({"on", "--override", "40"});
  EXPECT_EQ(code, 0) << text;
  EXPECT_THAT(text, HasSubstr("speed override set to 40 %"));
  EXPECT_THAT(text, HasSubstr("note: whether the override slows"));
  EXPECT_EQ(report("status", 0).before().override_percent(), 40u);
  EXPECT_EQ(robot({"on", "--override", "0"}).first, 2);
  EXPECT_EQ(robot({"on", "--override", "4x"}).first, 2);
}

TEST_F(RobotSwitches, WhoElseOperatesItIsNamed) {
  start("off: true rights_taken: true");
  expect_refused({"on"}, "right to operate the controller was refused", "somebody else holds it");
}

TEST_F(RobotSwitches, AnotherProgramAndNoneAreNamed) {
  start("off: true program: 'WELD'");
  expect_refused({"on"}, "to start program '1' was refused", "is there a program of that name");
}

TEST_F(RobotSwitches, AnAlarmIsNamedResetAndTheProgramStartedAgain) {
  start("", true, "mxttout_cycles: 50");
  ASSERT_TRUE(within(kPatience, [this] { return ask("engage: true").done(); }));
  ASSERT_TRUE(slave_reaches("engaged"));
  // Without a packet the controller waits in vain: its own alarm.
  slave->kill();
  ASSERT_TRUE(within(kPatience, [this] { return report("status", 0).before().alarm() == 6130; }));
  const auto [code, text] = robot({"on"});
  EXPECT_EQ(code, 1) << text;
  EXPECT_THAT(text, HasSubstr("alarm 6130 (Network communication error) stands"));
  EXPECT_THAT(text, HasSubstr("-> take its cause away, then handrail robot reset"));
  const pb::RobotReport reset = report("reset", 0);
  EXPECT_EQ(reset.before().alarm(), 6130u);
  EXPECT_EQ(reset.before().alarm_text(), "Network communication error");
  EXPECT_EQ(reset.after().alarm(), 0u);
  EXPECT_FALSE(reset.ready()) << "its program stands";
  EXPECT_EQ(robot({"on"}).first, 0);
  EXPECT_TRUE(report("status", 0).ready());
}

TEST_F(RobotSwitches, AClosedPortAndAnotherMachineAreNamed) {
  start("");
  const std::string slave_file = folder.path() + "/handrail-slave.cfg";
  const auto at_port = [&](int port) {
    const std::string file =
        folder.write("other.cfg", "robot { command_port: " + std::to_string(port) + " }");
    return handrail({"robot", "status", "--slave-config", file});
  };
  const auto [code, text] = at_port(1);
  EXPECT_EQ(code, 1) << text;
  EXPECT_THAT(text, HasSubstr(":1: cannot be reached: Connection refused"));
  EXPECT_THAT(text, HasSubstr("-> robot { address command_port }"));
  const auto [wrong, why] = handrail({"robot", "status", "--slave-config", "/nowhere.cfg"});
  EXPECT_EQ(wrong, 2) << why;
  const std::string named = folder.write("named.cfg", "robot { program: '1;1;SRVON' }");
  const auto [odd, how] = handrail({"robot", "on", "--slave-config", named});
  EXPECT_EQ(odd, 2) << how;
  EXPECT_THAT(how, HasSubstr("robot.program"));
}

}  // namespace
}  // namespace handrail
