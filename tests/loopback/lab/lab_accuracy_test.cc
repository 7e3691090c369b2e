// handrail-lab's accuracy and scene commands as programs, and the same through handrail.
#include <gmock/gmock.h>

#include "tests/loopback/program.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class LabAccuracy : public ::testing::Test {
 protected:
  struct Run {
    int code = 0;
    std::string output;
  };
  Run run(const std::string& name, std::vector<std::string> arguments) {
    Program program(folder, name, std::move(arguments));
    const int code = program.finish();
    return {code, program.output()};
  }
  static int count(const std::string& text, const std::string& part) {
    int found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
      ++found;
    }
    return found;
  }
  std::string aisle() const {
    return folder.write("aisle.scene", R"(name: "aisle"
walls {
  region { name: "free" kind: FREE }
  region { name: "wall" kind: WALL }
  shape { rectangle { size_mm: [60, 10] centre_mm: [0, 0] region: "free" } }
}
effect { wall {} }
)");
  }

  TempFolder folder;
};

TEST_F(LabAccuracy, PrintsTheRowsOfOneChoiceAsJson) {
  const Run lab = run("handrail-lab", {"accuracy", "--only", "haptic_rate", "--json"});
  ASSERT_EQ(lab.code, 0) << lab.output;
  EXPECT_EQ(count(lab.output, "\"choice\": \"haptic_rate\""), 7);
  for (const char* key : {"\"rows\": [", "\"method\":", "\"setting\":", "\"error\": {",
                          "\"unit\":", "\"rms\":", "\"worst\":", "\"cost\": {",
                          "\"median\":", "\"p999\":", "\"memory_bytes\":"}) {
    EXPECT_THAT(lab.output, HasSubstr(key));
  }
  EXPECT_THAT(lab.output, Not(HasSubstr("Infinity")));
  EXPECT_THAT(lab.output, Not(HasSubstr("NaN")));
}

TEST_F(LabAccuracy, PrintsEveryChoiceAndDrawsAFigureOfEach) {
  const std::string figures = folder.path() + "/figures";
  const Run lab = run("handrail-lab", {"accuracy", "--figures", figures});
  ASSERT_EQ(lab.code, 0) << lab.output;
  for (const std::string choice :
       {"wall", "tool_step", "smoother", "integrator", "haptic_rate", "link_rate"}) {
    EXPECT_THAT(lab.output, HasSubstr(choice + "  "));
    EXPECT_TRUE(std::ifstream(figures + "/accuracy-" + choice + ".svg").good()) << choice;
  }
}

TEST_F(LabAccuracy, RefusesAChoiceItDoesNotKnow) {
  const Run lab = run("handrail-lab", {"accuracy", "--only", "colour"});
  EXPECT_EQ(lab.code, 2);
  EXPECT_THAT(lab.output, HasSubstr("colour"));
}

TEST_F(LabAccuracy, ExplainsTheShippedScenes) {
  for (const std::string scene : {"linear-movement", "wrench", "gearshift"}) {
    const Run said = run("handrail", {"scene", "explain", scene, "--json"});
    ASSERT_EQ(said.code, 0) << said.output;
    EXPECT_THAT(said.output, HasSubstr("\"scene\": \"" + scene + "\""));
    EXPECT_GE(count(said.output, "\"ns_per_tick\":"), 3);
    EXPECT_GE(count(said.output, "\"side\": \"master\""), 1);
    EXPECT_GE(count(said.output, "\"side\": \"rig\""), 1);
    EXPECT_THAT(said.output, HasSubstr("\"not_simulated\": ["));
  }
}

TEST_F(LabAccuracy, DrawsAPreviewWhereItIsTold) {
  const std::string out = folder.path() + "/aisle.png";
  const Run drawn = run("handrail", {"scene", "preview", aisle(), "--out", out});
  EXPECT_EQ(drawn.code, 0) << drawn.output;
  std::ifstream file(out, std::ios::binary);
  std::string start(8, '\0');
  file.read(start.data(), 8);
  EXPECT_EQ(start, "\x89PNG\r\n\x1a\n");
}

TEST_F(LabAccuracy, ResolvesToACopyThatHandrailAccepts) {
  const std::string out = folder.path() + "/copy.scene";
  const Run made =
      run("handrail", {"scene", "resolve", aisle(), "--accuracy", "0.01mm", "--out", out});
  ASSERT_EQ(made.code, 0) << made.output;
  EXPECT_THAT(made.output, HasSubstr("exact"));
  EXPECT_EQ(run("handrail", {"scene", "check", out}).code, 0);
}

TEST_F(LabAccuracy, PassesTheLabsExitCodesAndComplaintsOn) {
  const std::string out = folder.path() + "/copy.scene";
  const Run unit = run("handrail", {"scene", "resolve", aisle(), "--budget", "5", "--out", out});
  EXPECT_EQ(unit.code, 2);
  EXPECT_THAT(unit.output, HasSubstr("--budget 5: expected"));
  const Run never =
      run("handrail", {"scene", "resolve", aisle(), "--budget", "0.001ns", "--out", out});
  EXPECT_EQ(never.code, 1);
  EXPECT_THAT(never.output, HasSubstr("no setting gives"));
  EXPECT_EQ(run("handrail", {"scene", "explain", "nowhere"}).code, 2);
  EXPECT_EQ(run("handrail", {"scene", "preview", "linear-movement", "--out", out}).code, 2);
  EXPECT_EQ(run("handrail", {"scene", "preview", aisle()}).code, 2);
  EXPECT_EQ(run("handrail", {"scene", "resolve", aisle(), "--out", out}).code, 2);
}

}  // namespace
}  // namespace handrail
