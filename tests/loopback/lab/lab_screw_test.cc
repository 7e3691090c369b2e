// handrail-lab's study of screw fastening, as a program.
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/loopback/program.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class LabScrew : public ::testing::Test {
 protected:
  struct Run {
    int code = 0;
    std::string output;
  };
  Run run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "screw-fastening");
    return run_lab(std::move(arguments));
  }
  Run run_lab(std::vector<std::string> arguments) {
    Program lab(folder, "handrail-lab", std::move(arguments));
    const int code = lab.finish();
    return {code, lab.output()};
  }

  TempFolder folder;
};

TEST_F(LabScrew, PrintsTheSameBytesOnOneThreadAndOnTwo) {
  const Run one = run({"--operators", "2", "--trials", "1", "--json", "--threads", "1"});
  ASSERT_EQ(one.code, 0) << one.output;
  for (const char* part :
       {"\"experiment\": \"screw-fastening\"", "\"simulated\": true", "\"bumper\": \"default\"",
        "\"NC-NV\": {", "\"NC-V\": {", "\"C-NV\": {", "\"C-V\": {", "\"trials\": ["}) {
    EXPECT_THAT(one.output, HasSubstr(part));
  }
  EXPECT_EQ(run({"--operators", "2", "--trials", "1", "--json", "--threads", "2"}).output,
            one.output);
}

TEST_F(LabScrew, TheBumperCanBeThePublishedOne) {
  const Run lab = run({"--operators", "1", "--trials", "1", "--json", "--bumper", "published"});
  ASSERT_EQ(lab.code, 0) << lab.output;
  EXPECT_THAT(lab.output, HasSubstr("\"bumper\": \"published\""));
}

TEST_F(LabScrew, PutsVariationsSideBySideAndDrawsItsFigures) {
  const std::string figures = folder.path() + "/figures";
  const Run lab = run(
      {"--operators", "1", "--trials", "1", "--set", "operator.press_mm=2", "--figures", figures});
  ASSERT_EQ(lab.code, 0) << lab.output;
  for (const char* part : {"operator.press_mm=2", "side by side", "implied", "targets"}) {
    EXPECT_THAT(lab.output, HasSubstr(part));
  }
  for (const char* name : {"measures", "trajectories", "forces"}) {
    EXPECT_TRUE(std::filesystem::exists(figures + "/screw-fastening-" + name + ".svg")) << name;
  }
}

TEST_F(LabScrew, RefusesWordsItDoesNotUnderstandBeforeRunningAnything) {
  const struct {
    std::vector<std::string> words;
    const char* part;
  } cases[] = {{{"--bumper", "soft"}, "soft not in {"},
               {{"--set", "bumper.threshold=1"}, "threshold_n"},
               {{"--set", "bumper.threshold_n=-1"}, "0.1 to 1000 N"},
               {{"--set", "operator.pres_mm=1"}, "press_mm"},
               {{"--sweep", "rig.servo_spread"}, "KEY=VALUE,VALUE"},
               {{"--trials", "0"}, "trials"},
               {{"--scene", "linear-movement"}, "no screw"},
               {{"--scene", "nowhere"}, "nowhere"},
               {{"--population", "linear-movement"}, "linear-movement.operators"},
               {{"--population", "nobody"}, "nobody"}};
  for (const auto& c : cases) {
    const Run lab = run(c.words);
    EXPECT_EQ(lab.code, 2) << c.words[0] << " " << c.words[1] << ": " << lab.output;
    EXPECT_THAT(lab.output, HasSubstr(c.part));
    EXPECT_THAT(lab.output, Not(HasSubstr("median")));
  }
}

TEST_F(LabScrew, CtrlCEndsALongRunSoonAndPrintsNoHalfResult) {
  Program lab(folder, "handrail-lab", {"screw-fastening", "--operators", "5000", "--json"});
  sleep_until(monotonic_now() + 300 * kMillisecond);
  lab.send(SIGINT);
  EXPECT_EQ(lab.finish(), 130);
  EXPECT_THAT(lab.output(), HasSubstr("cancelled"));
  EXPECT_THAT(lab.output(), Not(HasSubstr("median")));
}

TEST_F(LabScrew, TheFitWritesAPopulationThatReadsBack) {
  const std::string out = folder.path() + "/people.operators";
  const std::vector<std::string> fit = {"fit", "screw-fastening", "--operators",
                                        "1",   "--evaluations",   "2"};
  auto words = fit;
  words.insert(words.end(), {"--out", out});
  const Run first = run_lab(words);
  ASSERT_EQ(first.code, 0) << first.output;
  EXPECT_THAT(first.output, HasSubstr("2 candidates"));
  EXPECT_THAT(first.output, HasSubstr("mode NC-NV alone"));
  EXPECT_THAT(first.output, HasSubstr("implied 271"));
  words = fit;
  words.insert(words.end(), {"--population", out, "--check"});
  const Run check = run_lab(words);
  EXPECT_EQ(check.code, 0) << check.output;
  words[5] = "4";
  EXPECT_EQ(run_lab(words).code, 1) << "a longer search finds better medians";
  EXPECT_EQ(run_lab({"fit", "screw-fastening", "--scene", "linear-movement"}).code, 2);
}

}  // namespace
}  // namespace handrail
