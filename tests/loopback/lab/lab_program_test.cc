// handrail-lab as a program: its JSON, and what it says about bad files.
#include <gmock/gmock.h>

#include <map>
#include <regex>

#include "tests/loopback/program.h"

namespace handrail {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class LabProgram : public ::testing::Test {
 protected:
  struct Run {
    int code = 0;
    std::string output;
  };
  Run run(std::vector<std::string> arguments) {
    Program lab(folder, "handrail-lab", std::move(arguments));
    const int code = lab.finish();
    return {code, lab.output()};
  }
  // A hand that goes 60 mm along X and 20 mm along Y, with one gap.
  std::string good() const {
    std::string text = "t_s,x_mm,y_mm\n";
    for (int i = 0; i <= 60; ++i) {
      const double t = 0.02 * i + (i > 30 ? 0.5 : 0.0);
      text += std::to_string(t) + "," + std::to_string(i) + "," + std::to_string(i % 21) + "\n";
    }
    return folder.write("good.csv", text);
  }

  TempFolder folder;
};

// The numbers of one flat object; empty when `text` is anything else. (Protobuf's own Struct would
// do, but its maps change their layout under ThreadSanitizer and the system's library does not.)
std::map<std::string, double> flat_json(const std::string& text) {
  const std::string number = "-?[0-9]+(?:\\.[0-9]+)?(?:[eE][-+]?[0-9]+)?";
  const std::string pair = "\"(\\w+)\": (" + number + ")";
  const std::regex whole("\\{" + pair + "(?:, " + pair + ")*\\}\n");
  std::map<std::string, double> out;
  if (!std::regex_match(text, whole)) return out;
  const std::regex one(pair);
  for (std::sregex_iterator it(text.begin(), text.end(), one), end; it != end; ++it) {
    out[(*it)[1]] = std::stod((*it)[2]);
  }
  return out;
}

TEST_F(LabProgram, PrintsItsResultAsJson) {
  const Run lab = run({"hand", good(), "--tool", "line", "--one-way", "--json"});
  ASSERT_EQ(lab.code, 0) << lab.output;
  auto values = flat_json(lab.output);
  std::vector<std::string> keys;
  for (const auto& [key, value] : values) keys.push_back(key);
  EXPECT_THAT(keys, ElementsAre("backward_steps", "gaps", "max_force_n", "max_joint_speed_ratio",
                                "max_off_tool_mm", "non_finite", "samples"));
  EXPECT_EQ(values["samples"], 61.0);
  EXPECT_EQ(values["gaps"], 1.0);
  EXPECT_LT(values["max_off_tool_mm"], 0.01);
  EXPECT_EQ(values["backward_steps"], 0.0);
  EXPECT_GT(values["max_joint_speed_ratio"], 0.01);
  EXPECT_LE(values["max_joint_speed_ratio"], 1.0);
  EXPECT_GT(values["max_force_n"], 0.1);
  EXPECT_EQ(values["non_finite"], 0.0);
}

TEST_F(LabProgram, PrintsTheSameBytesAgain) {
  const std::vector<std::string> words = {"hand", good(), "--tool", "plane", "--json"};
  const Run first = run(words);
  EXPECT_EQ(first.code, 0);
  EXPECT_EQ(run(words).output, first.output);
}

TEST_F(LabProgram, PrintsATableForPeople) {
  const Run lab = run({"hand", good()});
  EXPECT_EQ(lab.code, 0);
  EXPECT_THAT(lab.output, HasSubstr("furthest off the tool"));
  EXPECT_THAT(lab.output, HasSubstr("simulated arm"));
}

TEST_F(LabProgram, NamesFileAndLineOfWhatItCannotRead) {
  const struct {
    const char* text;
    const char* line;
  } cases[] = {{"t_s,x_mm,y_mm\n0,0,0\n0.1,one,0\n", ":3: "},
               {"t_s,x_mm,y_mm\n0,0,0\n0.1,1,0\n0.2,nan,0\n", ":4: "},
               {"t_s,x_mm,y_mm\n0,0,0\n0.2,1,0\n0.1,2,0\n", ":4: "},
               {"t_s,x_mm,y_mm\n0,0,0\n0.1,1\n", ":3: "},
               {"time,x,y\n0,0,0\n", ":1: "},
               {"", ":1: "}};
  for (const auto& c : cases) {
    const std::string file = folder.write("bad.csv", c.text);
    const Run lab = run({"hand", file, "--json"});
    EXPECT_EQ(lab.code, 2) << c.text;
    EXPECT_THAT(lab.output, HasSubstr(file + c.line)) << c.text;
  }
}

TEST_F(LabProgram, RefusesToolsScenesAndFilesItDoesNotKnow) {
  const Run tool = run({"hand", good(), "--tool", "cube"});
  EXPECT_EQ(tool.code, 2);
  EXPECT_THAT(tool.output, HasSubstr("cube"));
  const Run scene = run({"hand", good(), "--scene", "nowhere"});
  EXPECT_EQ(scene.code, 2);
  EXPECT_THAT(scene.output, HasSubstr("nowhere"));
  const Run file = run({"hand", "/nowhere/hand.csv"});
  EXPECT_EQ(file.code, 2);
  EXPECT_THAT(file.output, HasSubstr("/nowhere/hand.csv"));
  EXPECT_EQ(run({}).code, 2);
  EXPECT_EQ(run({"--help"}).code, 0);
}

TEST_F(LabProgram, RefusesWallsThatAHandOnAToolIsNotKeptFrom) {
  const Run walls = run({"hand", good(), "--scene", "gearshift"});
  EXPECT_EQ(walls.code, 1);
  EXPECT_THAT(walls.output, HasSubstr("scene gearshift has walls"));
  EXPECT_THAT(walls.output, HasSubstr("handrail-lab gearshift --hand FILE"));
}

TEST_F(LabProgram, RefusesWhatIsNoFiniteNumber) {
  for (const char* value : {"nan", "-nan", "inf", "1e999", "one", "", "1 2"}) {
    for (const char* option : {"--c", "--noise"}) {
      const std::string command = std::string(option) == "--c" ? "wrench" : "bumper";
      const Run lab = run({command, option, value});
      EXPECT_EQ(lab.code, 2) << option << " " << value << lab.output;
      EXPECT_THAT(lab.output, HasSubstr(option)) << value;
    }
  }
}

TEST_F(LabProgram, ASeedIsTakenAsItStandsOrRefused) {
  for (const char* command : {"stability", "contact-delay", "tool-sequences"}) {
    for (const char* seed : {"-1", "18446744073709551616", "", "1.5", "010"}) {
      const Run lab = run({command, "--seed", seed});
      EXPECT_EQ(lab.code, 2) << command << " --seed '" << seed << "': " << lab.output;
      EXPECT_THAT(lab.output, HasSubstr("expected a whole number from 0 to")) << command;
    }
  }
  for (const char* seed : {"0", "18446744073709551615"}) {
    const Run lab =
        run({"stability", "--case", "walls/omni/firm/thin/K10/on", "--json", "--seed", seed});
    EXPECT_THAT(lab.output, HasSubstr(std::string("\"seed\": ") + seed + ","));
  }
}

TEST_F(LabProgram, AHandOutOfAnyDevicesReachIsRefused) {
  const Run lab = run({"hand", folder.write("far.csv", "t_s,x_mm,y_mm\n0,0,0\n1,20000,0\n")});
  EXPECT_EQ(lab.code, 1);
  EXPECT_THAT(lab.output, HasSubstr("expected at most 5000 mm"));
}

TEST_F(LabProgram, LinksThatCannotBeAreNamedWithWhatWasExpected) {
  const Run early = run({"links", "--delay", "0,10", "--jitter", "20,30"});
  EXPECT_EQ(early.code, 2);
  EXPECT_THAT(early.output,
              HasSubstr("--jitter 20 is more than the longest --delay, 10; expected at most that"));
  const Run lost = run({"links", "--loss", "101"});
  EXPECT_EQ(lost.code, 2);
  EXPECT_THAT(lost.output, HasSubstr("--loss: Value 101 not in range"));
}

}  // namespace
}  // namespace handrail
