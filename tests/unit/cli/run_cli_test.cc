#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <sstream>

#include "client/cli/command.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

// What a command line prints and returns, with a socket that nobody serves.
struct CliRun {
  explicit CliRun(std::vector<std::string> args) {
    std::ostringstream out_stream, err_stream;
    code = run_cli(args, Console{out_stream, err_stream});
    out = out_stream.str();
    err = err_stream.str();
  }
  ExitCode code;
  std::string out;
  std::string err;
};
CliRun without_master(std::vector<std::string> args) {
  args.insert(args.end(), {"--socket", "/nowhere/operator.sock"});
  return CliRun(args);
}

TEST(Cli, PrintsHelpForEveryCommand) {
  for (const Command& command : commands()) {
    std::istringstream words(command.name);
    std::vector<std::string> args;
    for (std::string word; words >> word;) args.push_back(word);
    args.push_back("--help");
    const CliRun run(args);
    EXPECT_EQ(run.code, kExitDone) << command.name;
    EXPECT_NE(run.out.find(command.help), std::string::npos) << command.name;
    EXPECT_EQ(run.err, "") << command.name;
  }
}

// Whatever this computer is like: the findings are judged in tests/unit/doctor.
TEST(Cli, DoctorGoesOnWithoutAMasterAndItsExitCodeIsWhatItFound) {
  const CliRun run = without_master({"doctor"});
  EXPECT_NE(run.out.find("programs.master: "), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("realtime.shell: "), std::string::npos) << run.out;
  const bool none = run.out.find("\n0 problems, ") != std::string::npos;
  EXPECT_EQ(run.code, none ? kExitDone : kExitRefused) << run.out;
  const CliRun json = without_master({"doctor", "--json"});
  EXPECT_EQ(json.code, run.code);
  EXPECT_NE(json.out.find("\"check\": \"programs.master\""), std::string::npos) << json.out;
  EXPECT_EQ(without_master({"doctor", "all"}).code, kExitUsage);
}

TEST(Cli, AMasterElsewhereIsNamedAsAHostAndAPort) {
  for (const char* host : {"127.0.0.1:0", "a b", "cell:x", ":5", "[::1"}) {
    const CliRun typed({"status", "--master", host});
    EXPECT_EQ(typed.code, kExitUsage) << host;
    EXPECT_NE(typed.err.find("expected a name or an address"), std::string::npos) << typed.err;
    ::setenv("HANDRAIL_MASTER", host, 1);
    const CliRun named({"status"});
    ::unsetenv("HANDRAIL_MASTER");
    EXPECT_EQ(named.code, kExitUsage) << host;
    EXPECT_EQ(named.err.find("handrail: HANDRAIL_MASTER '"), 0u) << named.err;
  }
}

TEST(Cli, AnUnknownCommandIsNamedWithTheNearest) {
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"statsu"}, "handrail: no command 'statsu'; did you mean 'status'?\n"},
      {{"--json", "--socket", "stop", "enggage"},
       "handrail: no command 'enggage'; did you mean 'engage'?\n"},
      {{"tool", "lin"}, "handrail: no command 'tool lin'; did you mean 'tool line'?\n"},
      {{"hand", "xyzzy"}, "handrail: no command 'hand xyzzy'; there are to, home\n"},
      {{"hand"},
       "handrail: expected a command after 'handrail hand': to, home (see handrail --help)\n"},
      {{"--sokcet", "x", "status"},
       "handrail: The following arguments were not expected: x --sokcet (see handrail --help)\n"}};
  for (const auto& [args, text] : cases) {
    const CliRun run(args);
    EXPECT_EQ(run.code, kExitUsage) << text;
    EXPECT_EQ(run.err, text);
  }
}

TEST(Cli, EveryOrderWithoutAMasterExitsWithThree) {
  const std::vector<std::vector<std::string>> lines = {
      {"status"},
      {"status", "--json"},
      {"status", "--watch"},
      {"engage"},
      {"engage", "--hold"},
      {"why"},
      {"why", "--json"},
      {"disengage"},
      {"clutch", "on"},
      {"clutch", "off"},
      {"stop"},
      {"reset"},
      {"lease", "show"},
      {"lease", "take", "--as", "anna"},
      {"lease", "grant"},
      {"lease", "refuse"},
      {"lease", "release"},
      {"tool", "point"},
      {"tool", "line", "--dir", "-x"},
      {"tool", "line", "--dir", "x", "--at", "-1,2,3", "--end", "50,2,3", "--one-way"},
      {"tool", "line", "--dir=-1,0,0", "--at=-1,-2,-3", "--stiffness", "0.5"},
      {"tool", "plane", "--normal", "-z", "--dir", "-1,0,0"},
      {"tool", "plane", "--normal", "z", "--at", "0,0,-500", "--approach"},
      {"tool", "n-rotation"},
      {"tool", "f-rotation", "--axis", "-z"},
      {"tool", "off"},
      {"tool", "off", "position"},
      {"tool", "off", "orientation"},
      {"scene", "load", "linear-movement"},
      {"stage", "open"},
      {"hand", "to", "--by", "-40,0,0", "--rotate", "-10,0,0", "--seconds", "2"},
  };
  for (const auto& line : lines) {
    const CliRun run = without_master(line);
    EXPECT_EQ(run.code, kExitNoMaster) << line[0] << ' ' << line.back() << ": " << run.err;
    EXPECT_EQ(
        run.err,
        "handrail: no master on /nowhere/operator.sock: no such socket; start handrail-master\n");
    EXPECT_EQ(run.out, "");
  }
}

// Those of server/base/hand_move.h.
TEST(Cli, HelpOfHandToNamesItsLimitsAndTheDurationKeepsThem) {
  const std::string help = without_master({"hand", "to", "--help"}).out;
  EXPECT_THAT(help, testing::ContainsRegex("displacement in mm.* at most 1000 long"));
  EXPECT_THAT(help, testing::ContainsRegex("degrees, at most 180 long"));
  EXPECT_THAT(help, testing::ContainsRegex("0.01 to 600; 1 without it"));
  for (const char* within : {"0.01", "600"}) {
    EXPECT_EQ(without_master({"hand", "to", "--by", "1,0,0", "--seconds", within}).code,
              kExitNoMaster)
        << within;
  }
  for (const char* beyond : {"0.00999", "600.001", "nan"}) {
    const CliRun run = without_master({"hand", "to", "--by", "1,0,0", "--seconds", beyond});
    EXPECT_EQ(run.code, kExitUsage) << beyond;
    EXPECT_EQ(run.err, std::string("handrail: --seconds: '") + beyond +
                           "': expected a number from 0.01 to 600 s\n");
  }
}

TEST(Cli, EveryUsageErrorExitsWithTwoAndOneLine) {
  const std::vector<std::vector<std::string>> lines = {
      {},
      {"bogus"},
      {"status", "--bogus"},
      {"tool"},
      {"tool", "bogus"},
      {"clutch"},
      {"clutch", "maybe"},
      {"clutch", "on", "off"},
      {"engage", "--json"},
      {"engage", "--as", "bad name!"},
      {"lease", "take", "--as", ""},
      {"tool", "off", "both"},
      {"tool", "line"},
      {"tool", "line", "--dir"},
      {"tool", "line", "--dir", "0,0,0"},
      {"tool", "line", "--dir", "x", "--dir", "y"},
      {"tool", "line", "--dir", "x", "--at", "100mm,0,0"},
      {"tool", "line", "--dir", "x", "--at", "0,0,0", "--end", "-1,0,0"},
      {"tool", "line", "--dir", "x", "--stiffness", "11"},
      {"tool", "n-rotation", "--at", "1,2,3"},
      {"tool", "n-rotation", "--approach"},
      {"tool", "point", "--one-way"},
      {"scene"},
      {"scene", "show"},
      {"scene", "show", "no-such-scene"},
      {"scene", "check", "/nowhere/x.scene"},
      {"scene", "load", "../x"},
      {"stage"},
      {"hand", "to"},
      {"hand", "to", "--by", "1,2"},
      {"hand", "to", "--by", "1,2,3", "--seconds", "0"},
  };
  for (const auto& line : lines) {
    const CliRun run = without_master(line);
    const std::string text = line.empty() ? "(nothing)" : line.back();
    EXPECT_EQ(run.code, kExitUsage) << text;
    EXPECT_TRUE(run.err.starts_with("handrail: ")) << text;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "") << text;
  }
}

TEST(Cli, TakesTheSocketFromTheEnvironment) {
  ASSERT_EQ(::setenv("HANDRAIL_SOCKET", "/nowhere/other.sock", 1), 0);
  const CliRun run({"stop"});
  ::unsetenv("HANDRAIL_SOCKET");
  EXPECT_EQ(run.err,
            "handrail: no master on /nowhere/other.sock: no such socket; start handrail-master\n");
}

TEST(Cli, LooksAtScenesWithoutAMaster) {
  EXPECT_NE(without_master({"scene", "list"}).out.find("linear-movement"), std::string::npos);
  const CliRun json = without_master({"scene", "list", "--json"});
  EXPECT_EQ(json.out.front(), '[');
  EXPECT_NE(json.out.find("{\"name\":\"linear-movement\",\"file\":"), std::string::npos);
  const CliRun show = without_master({"scene", "show", "plane"});
  EXPECT_EQ(show.code, kExitDone);
  EXPECT_NE(show.out.find("limits.tip_speed_mm_s               250 mm/s\n"), std::string::npos);
  EXPECT_NE(show.out.find("bumper.threshold_n                  50 N  (default)\n"),
            std::string::npos);
  const CliRun show_json = without_master({"scene", "show", "plane", "--json"});
  EXPECT_NE(show_json.out.find("\"threshold_n\": 50"), std::string::npos);
  EXPECT_NE(without_master({"scene", "show", "linear-movement"})
                .out.find("task.b_mm                           350, -37.5, 329 mm\n"),
            std::string::npos);
  // No task is a task left out, not one with values of its own.
  EXPECT_EQ(show.out.find("task"), std::string::npos);
  EXPECT_EQ(show_json.out.find("task"), std::string::npos);
  const CliRun check =
      without_master({"scene", "check", HANDRAIL_SOURCE_DIR "/server/scene/library/plane.scene"});
  EXPECT_EQ(check.code, kExitDone);
  EXPECT_TRUE(check.out.ends_with("plane.scene: ok\n"));
  // The lab does not stand beside this test.
  EXPECT_NE(check.err.find("handrail-lab"), std::string::npos) << check.err;
}

TEST(Cli, TheCheckOfASceneFindsAWorkpieceOutOfReach) {
  const TempFolder folder;
  const std::string file = folder.write("far-screw.scene",
                                        "name: 'far-screw'\nsimulate { effect { hex_socket {\n"
                                        "at_mm: [900, 0, 260] axis: [0, 0, 1] } } }\n");
  const CliRun check = without_master({"scene", "check", file});
  EXPECT_EQ(check.code, kExitUsage);
  EXPECT_TRUE(
      check.err.starts_with("handrail: " + file +
                            ":3:1: field 'simulate.effect[0].hex_socket.at_mm': out of the arm's "
                            "reach: at the bottom of the socket the wrist would be 826.1 mm"))
      << check.err;
  EXPECT_EQ(check.out, "");
}

}  // namespace
}  // namespace handrail
