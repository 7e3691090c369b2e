// Each order of each sequence, by a controller whose answers are written down.
#include "devices/melfa/r3_switches.h"

#include <gmock/gmock.h>

#include <functional>
#include <map>

namespace handrail {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr char kReady[] = "QoK1;20;100;0;60000;2;1";
constexpr char kAllOff[] = "QoK1;10;100;0;00060;1;1";

// Answers as it was told to; an order's last answer stays.
class Scripted final : public R3Line {
 public:
  Result<R3Answer> ask(const std::string& order) override {
    if (stop_at == order) stopped = true;
    if (stopped && !finishing && stop_at != order) return Status::error("broken off");
    orders.push_back(order.substr(4));
    auto& left = answers[orders.back()];
    if (left.empty()) return Status::error("no answer to " + order + "; look");
    const std::string answer = left.front();
    if (left.size() > 1) left.erase(left.begin());
    return parse_r3_answer(answer);
  }
  void pause(Nanos time) override { waited += time; }
  bool interrupted() const override { return stopped; }
  void finish() override { finishing = true; }

  std::map<std::string, std::vector<std::string>> answers;
  std::vector<std::string> orders;
  std::string stop_at;  // Ctrl-C comes while this one is asked
  bool stopped = false, finishing = false;
  Nanos waited = 0;
};

// A controller that is off and does what it is told.
Scripted obedient() {
  Scripted out;
  out.answers = {
      {"STATE", {kAllOff, kReady}}, {"DSTATE", {"QoK80060;1;1", "QoKA0060;1;1", "QoKE0000;2;1"}},
      {"CNTLON", {"QoK"}},          {"SRVON", {"QoK"}},
      {"SLOTINIT", {"QoK"}},        {"RUN1;1", {"QoK"}},
      {"CNTLOFF", {"QoK"}},         {"STOP", {"QoK"}},
      {"SRVOFF", {"QoK"}},          {"OVRD=25", {"QoK25"}},
      {"RSTALRM", {"QoK"}}};
  return out;
}

const SwitchWishes kProgramOne{"1", std::nullopt};

TEST(R3Switches, OnTakesTheRightSwitchesStartsAndGivesTheRightBack) {
  Scripted line = obedient();
  const SwitchesReport report = switch_on(line, kProgramOne);
  EXPECT_TRUE(report.done) << report.problem.fact;
  EXPECT_THAT(line.orders, ElementsAre("STATE", "CNTLON", "SRVON", "DSTATE", "DSTATE", "SLOTINIT",
                                       "RUN1;1", "DSTATE", "CNTLOFF", "STATE"));
  EXPECT_THAT(report.steps, ElementsAre("servos on", "program '1' started"));
  EXPECT_FALSE(report.before->status.servo_on());
  EXPECT_TRUE(report.after->status.running());
}

TEST(R3Switches, OnDoesOnlyWhatIsMissing) {
  Scripted line = obedient();
  line.answers["STATE"] = {kReady};
  const SwitchesReport report = switch_on(line, kProgramOne);
  EXPECT_TRUE(report.done) << report.problem.fact;
  EXPECT_THAT(line.orders, ElementsAre("STATE", "CNTLON", "CNTLOFF", "STATE"));
  EXPECT_THAT(report.steps, IsEmpty());
}

struct Refusal {
  const char* state;
  const char* fact;
  const char* next;
};

TEST(R3Switches, OnBeginsNothingWhileSomethingIsInTheWay) {
  const Refusal refusals[] = {
      {"QoK1;10;100;0;08060;1;1", "in TEACH (manual), expected AUTOMATIC", "turn its key"},
      {"QoK1;10;100;0;00070;1;1", "emergency stop is pressed", "release it"},
      {"Qok1;10;100;0;00066130;1;1", "alarm 6130 (Network communication error) stands",
       "handrail robot reset"},
      {"QoK1;10;100;0;04060;1;1", "machine lock", "take the machine lock away"},
      {"QoKWELD;10;100;0;60000;1;1", "program 'WELD' runs, expected '1'", "stop it"},
      {"QoK1;20;25;0;60000;1;1", "speed override is 25 %, expected 100", "--override 100"},
  };
  for (const Refusal& r : refusals) {
    Scripted line = obedient();
    line.answers["STATE"] = {r.state};
    line.answers["ERRORMES6130"] = {"QokNetwork communication error"};
    const SwitchesReport report = switch_on(line, kProgramOne);
    EXPECT_FALSE(report.done) << r.state;
    EXPECT_THAT(report.problem.fact, HasSubstr(r.fact));
    EXPECT_THAT(report.problem.next, HasSubstr(r.next));
    EXPECT_THAT(report.steps, IsEmpty());
    EXPECT_THAT(line.orders, Not(::testing::Contains("CNTLON"))) << r.state;
  }
}

TEST(R3Switches, WhyItIsSilentIsLookedForAndNothingIsTold) {
  struct Row {
    const char* state;
    const char* program;
    const char* fact;
    Reason reason;
  };
  const Row rows[] = {
      {"QoK1;10;100;0;08060;1;1", "1", "in TEACH (manual)", Reason::kRobotTeaching},
      {"QoK1;10;100;0;00070;1;1", "1", "emergency stop", Reason::kRobotStopPressed},
      {"Qok1;10;100;0;00066130;1;1", "1", "alarm 6130 (Network", Reason::kRobotAlarm},
      {"QoK1;10;100;0;04060;1;1", "1", "machine lock", Reason::kRobotMachineLock},
      {"QoKWELD;10;100;0;60000;1;1", "1", "program 'WELD' runs", Reason::kRobotProgram},
      {"QoK1;10;100;0;20060;1;1", "1", "program '1' does not run", Reason::kRobotProgram},
      {"QoK1;10;100;0;20060;1;1", "", "no program runs", Reason::kRobotProgram},
      {"QoK1;10;100;0;00060;1;1", "1", "servos are off", Reason::kRobotServosOff},
      // An override makes nobody silent: what does is named before it.
      {"QoK1;10;25;0;00060;1;1", "1", "servos are off", Reason::kRobotServosOff},
      {"QoK1;10;25;0;60000;1;1", "1", "speed override is 25 %", Reason::kRobotSlow},
      {kReady, "1", "switches are as they should be, and program '1' runs", Reason::kNone},
      {"Rubbish", "1", "", Reason::kNone},
  };
  for (const Row& r : rows) {
    Scripted line;
    line.answers["STATE"] = {r.state};
    line.answers["ERRORMES6130"] = {"QokNetwork communication error"};
    const Obstacle why = silence_of(line, r.program);
    EXPECT_FALSE(why.none()) << r.state;
    EXPECT_THAT(why.fact, HasSubstr(r.fact));
    EXPECT_EQ(why.reason, r.reason) << r.state;
    for (const std::string& order : line.orders) {
      EXPECT_TRUE(order == "STATE" || order == "ERRORMES6130") << order;
    }
  }
  Scripted mute;
  EXPECT_THAT(silence_of(mute, "1").fact, HasSubstr("no answer to 1;1;STATE"));
}

TEST(R3Switches, OnStartsNoProgramThatNobodyNamed) {
  Scripted line = obedient();
  const SwitchesReport report = switch_on(line, {});
  EXPECT_FALSE(report.done);
  EXPECT_THAT(report.problem.fact, HasSubstr("no program runs"));
  EXPECT_THAT(report.problem.next, HasSubstr("robot { program"));
  EXPECT_THAT(line.orders, ElementsAre("STATE"));
  // One that runs already may have any name.
  Scripted runs = obedient();
  runs.answers["STATE"] = {"QoKANY;20;100;0;40000;2;1", kReady};
  EXPECT_TRUE(switch_on(runs, {}).done);
}

TEST(R3Switches, AnOverrideThatIsWishedForIsSetAndLeft) {
  Scripted line = obedient();
  line.answers["STATE"] = {kAllOff, "QoK1;20;25;0;60000;2;1"};
  const SwitchesReport report = switch_on(line, {"1", 25});
  EXPECT_TRUE(report.done) << report.problem.fact;
  EXPECT_THAT(report.steps,
              ElementsAre("speed override set to 25 %", "servos on", "program '1' started"));
  // From another share than 100 as well.
  Scripted slow = obedient();
  slow.answers["STATE"] = {"QoK1;10;60;0;00060;1;1", "QoK1;20;25;0;60000;2;1"};
  EXPECT_TRUE(switch_on(slow, {"1", 25}).done);
  Scripted other = obedient();
  other.answers["OVRD=25"] = {"QoK30"};
  const SwitchesReport not_taken = switch_on(other, {"1", 25});
  EXPECT_FALSE(not_taken.done);
  EXPECT_THAT(not_taken.problem.fact, HasSubstr("25 % was not taken: '30'"));
  EXPECT_THAT(other.orders, Not(::testing::Contains("SRVON")));
}

TEST(R3Switches, WhoElseHoldsTheRightKeepsIt) {
  Scripted line = obedient();
  line.answers["CNTLON"] = {"QeR4220"};
  line.answers["ERRORMES4220"] = {"QoKheld elsewhere"};
  const SwitchesReport report = switch_on(line, kProgramOne);
  EXPECT_FALSE(report.done);
  EXPECT_THAT(report.problem.fact,
              HasSubstr("the right to operate the controller was refused, error 4220 (held "
                        "elsewhere)"));
  EXPECT_THAT(report.problem.next, HasSubstr("somebody else holds it"));
  EXPECT_THAT(line.orders, ElementsAre("STATE", "CNTLON", "ERRORMES4220", "STATE"));
}

TEST(R3Switches, ServosThatDoNotComeOnAreSwitchedOffAgain) {
  Scripted line = obedient();
  line.answers["DSTATE"] = {"QoK80060;1;1"};
  line.answers["STATE"] = {kAllOff};
  const SwitchesReport report = switch_on(line, kProgramOne);
  EXPECT_FALSE(report.done);
  EXPECT_THAT(report.problem.fact, HasSubstr("not on 10 s after"));
  EXPECT_GE(line.waited, 10 * kSecond);
  EXPECT_LT(line.waited, 11 * kSecond);
  EXPECT_THAT(report.steps, ElementsAre("servos switched off again"));
  EXPECT_EQ(line.orders[line.orders.size() - 3], "SRVOFF");
  EXPECT_EQ(line.orders[line.orders.size() - 2], "CNTLOFF");
}

TEST(R3Switches, AProgramThatIsNotThereLeavesTheServosOff) {
  Scripted line = obedient();
  line.answers["RUN1;1"] = {"QeR3110"};
  line.answers["STATE"] = {kAllOff};
  const SwitchesReport report = switch_on(line, kProgramOne);
  EXPECT_FALSE(report.done);
  EXPECT_THAT(report.problem.fact, HasSubstr("to start program '1' was refused, error 3110"));
  EXPECT_THAT(report.steps, ElementsAre("servos on", "servos switched off again"));
  EXPECT_THAT(line.orders, Not(::testing::Contains("STOP")));
}

TEST(R3Switches, AnAlarmOnTheWayIsNamedAndTakenBack) {
  Scripted line = obedient();
  line.answers["DSTATE"] = {"QoKA0060;1;1", "Qok80062140;1;1"};
  const SwitchesReport report = switch_on(line, kProgramOne);
  EXPECT_FALSE(report.done);
  EXPECT_THAT(report.problem.fact, HasSubstr("then alarm 2140 stands"));
  EXPECT_THAT(report.steps,
              ElementsAre("servos on", "program stopped again", "servos switched off again"));
}

TEST(R3Switches, CtrlCAnywhereLeavesNothingOnThatWasOff) {
  for (const char* order : {"1;1;SRVON", "1;1;DSTATE", "1;1;SLOTINIT", "1;1;RUN1;1"}) {
    Scripted line = obedient();
    line.stop_at = order;
    const SwitchesReport report = switch_on(line, kProgramOne);
    EXPECT_FALSE(report.done) << order;
    EXPECT_EQ(report.problem.fact, "broken off") << order;
    EXPECT_THAT(line.orders, ::testing::Contains("SRVOFF")) << order;
    EXPECT_THAT(line.orders, ::testing::Contains("CNTLOFF")) << order;
    EXPECT_EQ(std::count(line.orders.begin(), line.orders.end(), "STOP") == 1,
              std::string(order) == "1;1;RUN1;1")
        << order;
  }
  // Servos that were on before stay so.
  Scripted line = obedient();
  line.answers["STATE"] = {"QoK1;10;100;0;20060;1;1"};
  line.stop_at = "1;1;SLOTINIT";
  EXPECT_FALSE(switch_on(line, kProgramOne).done);
  EXPECT_THAT(line.orders, Not(::testing::Contains("SRVOFF")));
}

TEST(R3Switches, OffSwitchesOffWhateverElseIsRefused) {
  Scripted line = obedient();
  line.answers["STATE"] = {"Rubbish", "QoK1;10;100;0;00060;1;1"};
  line.answers["CNTLON"] = {"QeR4220"};
  line.answers["STOP"] = {"QeR1"};
  line.answers["DSTATE"] = {"QoK20060;1;1", "QoK00060;1;1"};
  line.stopped = true;  // Ctrl-C does not keep it from that
  const SwitchesReport report = switch_off(line);
  EXPECT_TRUE(report.done) << report.problem.fact;
  EXPECT_THAT(line.orders, ::testing::IsSupersetOf({"STOP", "SRVOFF"}));
  EXPECT_THAT(line.orders, Not(::testing::Contains("CNTLOFF")));
  EXPECT_THAT(report.steps, ::testing::Contains("servos switched off"));
}

TEST(R3Switches, OffThatDidNotWorkSaysSo) {
  Scripted line = obedient();
  line.answers["STATE"] = {kReady};
  line.answers["DSTATE"] = {"QoK60000;1;1"};
  const SwitchesReport report = switch_off(line);
  EXPECT_FALSE(report.done);
  EXPECT_THAT(report.problem.fact, HasSubstr("still on 3 s after"));
  EXPECT_THAT(report.problem.next, HasSubstr("emergency stop"));
  Scripted refuses = obedient();
  refuses.answers["STATE"] = {kReady};
  refuses.answers["SRVOFF"] = {"QeR7"};
  refuses.answers["DSTATE"] = {"QoK60000;1;1"};
  EXPECT_THAT(switch_off(refuses).problem.fact, HasSubstr("to switch the servos off was refused"));
  Scripted silent;
  const SwitchesReport nothing = switch_off(silent);
  EXPECT_FALSE(nothing.done);
  EXPECT_THAT(silent.orders, ::testing::Contains("SRVOFF"));
  EXPECT_THAT(nothing.problem.next, HasSubstr("emergency stop"));
}

TEST(R3Switches, ResetSaysWhichAlarmWentAndWhichCameBack) {
  Scripted line = obedient();
  line.answers["STATE"] = {"Qok1;10;100;0;00066130;1;1", kAllOff};
  line.answers["ERRORMES6130"] = {"QokNetwork communication error"};
  const SwitchesReport report = reset_alarm(line);
  EXPECT_TRUE(report.done) << report.problem.fact;
  EXPECT_EQ(report.alarm_text, "Network communication error");
  EXPECT_THAT(report.steps, ElementsAre("alarm reset"));
  Scripted again = obedient();
  again.answers["STATE"] = {"Qok1;10;100;0;00066130;1;1"};
  EXPECT_THAT(reset_alarm(again).problem.fact, HasSubstr("alarm 6130 stands again"));
  EXPECT_FALSE(reset_alarm(again).done);
}

TEST(R3Switches, LookingChangesNothingAndSaysWhatIsInTheWay) {
  Scripted line = obedient();
  const SwitchesReport off = look_at_switches(line, kProgramOne);
  EXPECT_TRUE(off.done);
  EXPECT_EQ(off.problem.fact, "the servos are off");
  const SwitchesReport ready = look_at_switches(line, {});
  EXPECT_TRUE(ready.problem.none()) << ready.problem.fact;
  EXPECT_THAT(line.orders, ElementsAre("STATE", "STATE"));
  line.answers["STATE"] = {"QoK1;10;100;0;20060;1;1"};
  EXPECT_THAT(look_at_switches(line, kProgramOne).problem.fact, HasSubstr("'1' does not run"));
  EXPECT_THAT(look_at_switches(line, {}).problem.fact, HasSubstr("no program runs"));
  Scripted nobody;
  EXPECT_FALSE(look_at_switches(nobody, {}).done);
  EXPECT_EQ(look_at_switches(nobody, {}).problem.next, "look");
}

}  // namespace
}  // namespace handrail
