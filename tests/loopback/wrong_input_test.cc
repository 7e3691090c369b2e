// What a new user may get wrong, at the real programs: each gets one line with the place, the value
// and what was expected.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>

#include "tests/loopback/program.h"

namespace handrail {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

struct Case {
  std::string program;
  std::vector<std::string> words;
  int code = 2;
  std::vector<std::string> parts;  // of its answer
};

class WrongInput : public ::testing::Test {
 protected:
  // One line on both outputs together, which begins with the program's name.
  void expect(const Case& c) {
    std::string line = c.program;
    for (const std::string& word : c.words) line += " '" + word + "'";
    SCOPED_TRACE(line);
    Program program(folder, c.program, c.words);
    EXPECT_EQ(program.finish(), c.code);
    const std::string said = program.output();
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
    EXPECT_THAT(said.substr(0, said.find(": ")),
                EndsWith(std::filesystem::path(c.program).filename().string()));
    for (const std::string& part : c.parts) EXPECT_THAT(said, HasSubstr(part));
  }
  void expect_all(const std::vector<Case>& cases) {
    for (const Case& c : cases) expect(c);
  }
  // A file with this text, for a case's words.
  std::string file(const std::string& name, const std::string& text) {
    return folder.write(name, text);
  }
  std::string away() const { return folder.path() + "/away/operator.sock"; }

  TempFolder folder;
};

TEST_F(WrongInput, CommandLinesOfTheOperator) {
  const std::string handrail = "handrail";
  std::vector<Case> cases = {
      {handrail, {"statsu"}, 2, {"'statsu'", "did you mean 'status'"}},
      {handrail, {"Status"}, 2, {"'Status'", "status"}},
      {handrail, {"start"}, 2, {"'start'", "did you mean"}},
      {handrail, {"xyzzy"}, 2, {"'xyzzy'", "there are", "engage", "demo"}},
      {handrail, {}, 2, {"--help"}},
      {handrail, {"tool"}, 2, {"--help"}},
      {handrail, {"tool", "lien"}, 2, {"'tool lien'", "did you mean 'tool line'"}},
      {handrail, {"scene", "lst"}, 2, {"'scene lst'", "did you mean 'scene list'"}},
      {handrail, {"hand", "xyzzy"}, 2, {"'hand xyzzy'", "to, home"}},
      {handrail, {"lease", "tkae"}, 2, {"'lease tkae'", "did you mean 'lease take'"}},
      {handrail, {"status", "--jsn"}, 2, {"--jsn", "--help"}},
      {handrail, {"engage", "--json"}, 2, {"--json"}},
      {handrail, {"stop", "now"}, 2, {"now"}},
      {handrail, {"status", "--socket"}, 2, {"--socket"}},
      {handrail, {"engage", "--as", "bad name!"}, 2, {"--as"}},
      {handrail, {"lease", "take", "--as", ""}, 2, {"--as"}},
      {handrail, {"clutch"}, 2, {"on|off"}},
      {handrail, {"clutch", "maybe"}, 2, {"clutch", "'maybe'", "on", "off"}},
      {handrail, {"tool", "line"}, 2, {"--dir"}},
      {handrail, {"tool", "line", "--dir", "w"}, 2, {"--dir", "'w'", "x"}},
      {handrail, {"tool", "line", "--dir", "0,0,0"}, 2, {"direction"}},
      {handrail,
       {"tool", "line", "--dir", "x", "--at", "1,2"},
       2,
       {"--at", "'1,2'", "three numbers in mm"}},
      {handrail, {"tool", "point", "--at", "1,2,nan"}, 2, {"--at", "nan"}},
      {handrail, {"tool", "point", "--at", "10cm,0,0"}, 2, {"--at", "10cm", "mm"}},
      {handrail,
       {"tool", "line", "--dir", "x", "--stiffness", "11"},
       2,
       {"--stiffness", "11", "10"}},
      {handrail,
       {"tool", "line", "--dir", "x", "--stiffness", "-1"},
       2,
       {"--stiffness", "-1", "0"}},
      {handrail, {"tool", "plane"}, 2, {"--normal"}},
      {handrail, {"tool", "n-rotation", "--approach"}, 2, {"approach"}},
      {handrail, {"tool", "off", "both"}, 2, {"'both'", "position", "orientation"}},
      {handrail, {"hand", "to"}, 2, {"--by", "--rotate"}},
      {handrail, {"hand", "to", "--by", "1,2"}, 2, {"--by", "'1,2'"}},
      {handrail, {"hand", "to", "--by", "1,2,3", "--seconds", "0"}, 2, {"--seconds", "0"}},
      {handrail, {"hand", "to", "--by", "1,2,3", "--seconds", "soon"}, 2, {"--seconds", "'soon'"}},
      {handrail, {"stage"}, 2, {"NAME"}},
      {handrail, {"scene", "show"}, 2, {"NAME|FILE"}},
      {handrail, {"scene", "show", "linear-movment"}, 2, {"linear-movment", "linear-movement"}},
      {handrail, {"scene", "check", "/nowhere/x.scene"}, 2, {"/nowhere/x.scene", "No such file"}},
      {handrail, {"scene", "load", "../x"}, 2, {"'../x'", "a scene's name"}},
      {handrail, {"scene", "preview", "plane"}, 2, {"--out"}},
      {handrail, {"calibrate", "payload", "--poses", "3"}, 2, {"--poses", "3", "4"}},
      {handrail, {"calibrate", "payload", "--poses", "4.5"}, 2, {"--poses", "'4.5'", "whole"}},
      {handrail,
       {"calibrate", "payload", "--from", "/nowhere.csv"},
       2,
       {"/nowhere.csv", "No such"}},
  };
  expect_all(cases);
}

TEST_F(WrongInput, CommandLinesOfTheLab) {
  const std::string lab = "handrail-lab";
  expect_all({
      {lab, {"wrnech"}, 2, {"handrail-lab: ", "'wrnech'", "did you mean 'wrench'"}},
      {lab, {"xyzzy"}, 2, {"handrail-lab: ", "'xyzzy'", "there are", "gearshift"}},
      {lab, {"screw"}, 2, {"'screw'", "did you mean 'screw-fastening'"}},
      {lab, {"hand", "/nowhere/hand.csv"}, 2, {"/nowhere/hand.csv", "No such file"}},
      {lab, {"hand", file("a.csv", "t,x\n")}, 2, {"a.csv:1", "t_s,x_mm,y_mm"}},
      {lab,
       {"hand", file("b.csv", "t_s,x_mm,y_mm\n0,0,0\n1,a,0\n")},
       2,
       {"b.csv:3", "x_mm is \"a\""}},
      {lab, {"hand", file("c.csv", "t_s,x_mm,y_mm\n0,0,0\n0,1,0\n")}, 2, {"c.csv:3"}},
      {lab, {"hand", file("d.csv", "")}, 2, {"d.csv:1"}},
  });
}

TEST_F(WrongInput, CommandLinesOfTheDaemons) {
  for (const std::string daemon : {"handrail-rig", "handrail-slave", "handrail-master"}) {
    expect_all({
        {daemon, {"--cofnig", "x"}, 2, {daemon + ": ", "'--cofnig'", "--config FILE"}},
        {daemon, {"x.cfg"}, 2, {daemon + ": ", "'x.cfg'", "--config FILE"}},
        {daemon, {"--config"}, 2, {"'--config'", "path"}},
        {daemon, {"--config", "--check"}, 2, {"'--config'", "path"}},
        {daemon, {"--config", "a", "--config", "b"}, 2, {"'--config'", "twice", "once"}},
        {daemon, {"--config", "/nowhere/x.cfg"}, 2, {"/nowhere/x.cfg", "No such file"}},
        {daemon, {"--config", folder.path()}, 2, {folder.path()}},
    });
  }
}

TEST_F(WrongInput, CommandLinesOfThePlayer) {
  const std::string console = "handrail-console";
  expect_all({
      {"handrail", {"play"}, 2, {"FILE"}},
      {console, {"--recording", "a.mcap", "--listen", "127.0.0.1:65536"}, 2, {"--listen", "65536"}},
      {console, {"--recording", "a.mcap", "--listen", "a:1"}, 2, {"--listen a:1", "127.0.0.1"}},
      {console, {"--recording", "/nowhere/a.mcap"}, 2, {"/nowhere/a.mcap", "No such file"}},
      {console, {"--recording", folder.path()}, 2, {folder.path(), "is no regular file"}},
      {console, {"--recording", file("e.mcap", "")}, 2, {"e.mcap", "is empty", "a recording"}},
      {console, {"--recording", file("t.mcap", "text text")}, 2, {"byte 0", "74 65", "89 4d"}},
      {console,
       {"--recording", file("n.mcap", "\x89MCAP1\r\n")},
       2,
       {"byte 5", "version '1'", "expected '0'"}},
      {console, {"--recording", "a", "--socket", "b"}, 2, {"--recording", "--socket"}},
  });
}

TEST_F(WrongInput, ConfigurationFiles) {
  int number = 0;
  const auto check = [&](const std::string& daemon, const std::string& text,
                         std::vector<std::string> parts) {
    const std::string name = std::to_string(++number) + ".cfg";
    parts.push_back(name + ":1:");
    expect({"handrail-" + daemon, {"--check", "--config", file(name, text)}, 2, parts});
  };
  check("master", "link_sokcet: 'a'", {"link_sokcet", "link_socket"});
  check("master", "link_socket: ''", {"link_socket", "empty", "path of a Unix socket"});
  check("master", "link_socket: 1", {"link_socket"});
  check("master", "link_port: 47001", {"link_port", "no longer used", "link_socket"});
  check("master", "slave_address: '127.0.0.1'", {"slave_address", "no longer used", "slave"});
  check("master", "slave: ''", {"slave", "empty", "HOST"});
  check("master", "slave: 'arm' link_socket: 'a'", {"link_socket", "slave", "one of them"});
  check("slave", "link_port: 70000", {"link_port", "70000", "65535"});
  check("slave", "link_port: -1", {"link_port"});
  check("slave", "link_port: 'a'", {"link_port"});
  check("master", "scene: ''", {"scene", "linear-movement"});
  check("master", "presence: SOMETIMES", {"presence", "SOMETIMES"});
  check("master", "device { kind: OMNI }", {"kind", "OMNI"});
  check("master", "device { kind: RECORDED }", {"device.recording", "missing"});
  check("master", "device { hand { mass_kg: 0 } }", {"mass_kg", "0.01 to 5 kg"});
  check("master", "operator_socket: ''", {"operator_socket", "empty"});
  check("slave", "robot { packet_bytes: 100 }", {"robot.packet_bytes", "100", "64", "196"});
  check("slave", "robot { address: 'arm' }", {"robot.address", "'arm'", "IPv4"});
  check("slave", "robot { command_port: 0 }", {"robot.command_port", "0", "1 to 65535"});
  check("slave", "robot { program: '1;1;SRVON' }", {"robot.program", "1;1;SRVON", "letters"});
  check("slave", "robot { program: '' }", {"robot.program", "1 to 32"});
  check("slave", "force_sensor { filter_ms: 51 }", {"filter_ms", "51", "0 to 50 ms"});
  check("slave", "payload { mass_kg: nan }", {"mass_kg", "nan"});
  check("slave", "payload { mass_kg: 1 centre_mm: 1 }", {"centre_mm", "1 value,", "3"});
  check("slave", "}", {});
  check("rig", "drop_share: 2", {"drop_share", "2", "0 to 1"});
  check("rig", "start_joints_deg: [0, 0, 400, 0, 0, 0]", {"start_joints_deg", "400", "200"});
  check("rig", "switches { override_percent: 0 }", {"override_percent", "0", "1 to 100 %"});
  check("rig", "switches { program: 'A B' }", {"switches.program", "'A B'", "letters"});
  check("rig", "sensor_port: 10000", {"sensor_port", "10000", "robot_port"});
}

TEST_F(WrongInput, SceneFilesAndPictures) {
  int number = 0;
  const auto check = [&](const std::string& text, std::vector<std::string> parts) {
    const std::string name = std::to_string(++number) + ".scene";
    parts.push_back(name + ":");
    expect({"handrail", {"scene", "check", file(name, text)}, 2, parts});
  };
  check("nmae: 'a'", {"nmae", "name"});
  check("name: 'a b'", {"name", "'a b'"});
  check("limits { tip_speed_mm_s: 1e9 }", {"tip_speed_mm_s", "1000000000", "mm/s"});
  check("mapping { scale: 0 }", {"scale", "0"});
  check("smoother { form: LENGTH samples: 0 }", {"samples", "0"});
  check("mapping { scale: 2", {});
  const auto painted = [&](const std::string& picture, const std::string& more,
                           std::vector<std::string> parts) {
    check("name: '" + std::to_string(number + 1) + "'\nwalls {\n image { file: '" + picture +
              "' size_mm: [60, 60] }\n region { name: 'room' colour: '#ffffff' kind: FREE }\n" +
              " region { name: 'wall' colour: " + more + " }\n}\neffect { wall {} }\n",
          std::move(parts));
  };
  const std::string black = "'#000000' kind: WALL stiffness_n_mm: 5";
  painted("nowhere.png", black, {"nowhere.png", "No such file"});
  file("text.png", "no picture");
  painted("text.png", black, {"text.png", "PNG"});
  painted("text.png", "'black' kind: WALL", {":5:", "colour", "'black'"});
  painted("text.png", "'#000000' kind: STONE", {":5:", "kind", "STONE"});
  painted("text.png", "'#000000' kind: WALL stiffness_n_mm: -5", {":5:", "stiffness_n_mm", "-5"});
}

TEST_F(WrongInput, States) {
  std::filesystem::create_directory(folder.path() + "/open");
  ::chmod((folder.path() + "/open").c_str(), 0777);
  const std::string no_socket = file("plain.sock", "");
  const std::string link = "link_socket: '" + folder.path() + "/run/link.sock'";
  expect_all({
      {"handrail",
       {"engage", "--socket", away()},
       3,
       {away(), "no such socket", "handrail-master"}},
      {"handrail", {"demo", "--socket", away()}, 3, {away(), "no such socket", "handrail-master"}},
      {"handrail", {"status", "--socket", no_socket}, 3, {no_socket, "handrail-master"}},
      {"handrail", {"stop", "--socket", std::string(200, 'a')}, 3, {"200 bytes", "107"}},
      {"handrail-master",
       {"--config",
        file("open.cfg", link + " operator_socket: '" + folder.path() + "/open/operator.sock'")},
       2,
       {folder.path() + "/open", "0777", "expected 0700"}},
      {"handrail-master",
       {"--config", file("plain.cfg", link + " operator_socket: '" + no_socket + "'")},
       2,
       {no_socket, "not a socket"}},
      {"handrail-master",
       {"--check", "--config", file("scene.cfg", "scene: 'plan'")},
       2,
       {"'plan'", "plane"}},
      {"handrail-slave",
       {"--check", "--config", file("scene2.cfg", "scene: 'plan'")},
       2,
       {"'plan'", "plane"}},
  });
  // A port in use: who is likely there, and what to set.
  Program rig(folder, "handrail-rig",
              {"--config", file("rig.cfg", "robot_port: 0 sensor_port: 0")});
  const std::string port = std::to_string(rig.number_after("READY robot_port="));
  Program slave(folder, "handrail-slave", {"--config", file("slave.cfg", link)});
  EXPECT_EQ(slave.after("READY link="), folder.path() + "/run/link.sock");
  expect_all({
      {"handrail-rig",
       {"--config", file("rig2.cfg", "sensor_port: 0 robot_port: " + port)},
       2,
       {port, "in use", "handrail-rig", "robot_port"}},
      {"handrail-slave",
       {"--config", file("slave2.cfg", link)},
       2,
       {folder.path() + "/run/link.sock", "another slave"}},
      {"handrail-slave",
       {"--check", "--config", file("far.cfg", "link_address: '10.0.0.1'")},
       2,
       {"link_address", "needs a key", "leave both out"}},
      {"handrail-master",
       {"--check", "--config", file("far2.cfg", "slave: 'arm:47002'")},
       2,
       {"slave arm:47002", "needs a key", "leave it out"}},
  });
}

TEST_F(WrongInput, Scripts) {
  const std::string root = HANDRAIL_SOURCE_DIR;
  expect_all({
      {root + "/client/demo",
       {"--fast"},
       2,
       {"client/demo", "'--fast'", "expected --stay or none"}},
      {root + "/client/install", {"--test"}, 2, {"client/install", "'--test'", "--tests"}},
      {root + "/tests/fuzz/run", {}, 2, {"tests/fuzz/run", "SECONDS", "--runs"}},
      {root + "/tests/fuzz/run", {"--runs", "0"}, 2, {"tests/fuzz/run", "--runs '0'", "inputs"}},
      {root + "/tests/fuzz/run", {"10", "scenes"}, 2, {"tests/fuzz/run", "'scenes'", "scene"}},
      {root + "/tests/run", {"--sanitiser"}, 2, {"tests/run", "'--sanitiser'", "--sanitizers"}},
  });
}

}  // namespace
}  // namespace handrail
