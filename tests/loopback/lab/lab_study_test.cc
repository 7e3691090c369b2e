// handrail-lab's study of the linear movement, as a program.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <pty.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "tests/loopback/program.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class LabStudy : public ::testing::Test {
 protected:
  struct Run {
    int code = 0;
    std::string output;
  };
  Run run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "linear-movement");
    Program lab(folder, "handrail-lab", std::move(arguments));
    const int code = lab.finish();
    return {code, lab.output()};
  }

  TempFolder folder;
};

TEST_F(LabStudy, PrintsTheSameBytesOnOneThreadAndOnTwo) {
  const Run one = run({"--operators", "2", "--trials", "1", "--json", "--threads", "1"});
  ASSERT_EQ(one.code, 0) << one.output;
  for (const char* part : {"\"experiment\": \"linear-movement\"", "\"simulated\": true",
                           "\"seed\": 1", "\"NV\": {", "\"V\": {", "\"trials\": ["}) {
    EXPECT_THAT(one.output, HasSubstr(part));
  }
  EXPECT_EQ(run({"--operators", "2", "--trials", "1", "--json", "--threads", "2"}).output,
            one.output);
  EXPECT_NE(run({"--operators", "2", "--trials", "1", "--json", "--seed", "2"}).output, one.output);
}

TEST_F(LabStudy, PutsVariationsSideBySide) {
  const Run lab = run({"--operators", "1", "--trials", "1", "--smoother", "low-lag", "--sweep",
                       "rig.servo_spread=0,0.1"});
  ASSERT_EQ(lab.code, 0) << lab.output;
  for (const char* part : {"smoother.form=LOW_LAG", "rig.servo_spread=0 ", "rig.servo_spread=0.1",
                           "simulated operators", "published", "as fast as real time"}) {
    EXPECT_THAT(lab.output, HasSubstr(part));
  }
}

TEST_F(LabStudy, DrawsItsFigures) {
  const std::string figures = folder.path() + "/figures";
  ASSERT_EQ(run({"--operators", "1", "--trials", "1", "--figures", figures}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(figures + "/linear-movement-measures.svg"));
  EXPECT_TRUE(std::filesystem::exists(figures + "/linear-movement-trajectories.svg"));
}

TEST_F(LabStudy, RefusesWordsItDoesNotUnderstandBeforeRunningAnything) {
  const struct {
    std::vector<std::string> words;
    const char* part;
  } cases[] = {{{"--set", "guidance.delta=1"}, "delta_mm"},
               {{"--set", "guidance.delta_mm=9999"}, "0.001 to 10"},
               {{"--sweep", "rig.servo_spread"}, "KEY=VALUE,VALUE"},
               {{"--smoother", "long"}, "long"},
               {{"--rate", "9"}, "100 to 5000 Hz"},
               {{"--tool-method", "magic"}, "magic"},
               {{"--operators", "0"}, "operators"},
               {{"--scene", "published"}, "task"},
               {{"--scene", "nowhere"}, "nowhere"},
               {{"--population", "nobody"}, "nobody"},
               {{"--scene", "screw-fastening"}, "task"},
               {{"--seed", "-1"}, "seed"}};
  for (const auto& c : cases) {
    const Run lab = run(c.words);
    EXPECT_EQ(lab.code, 2) << c.words[0] << " " << c.words[1] << ": " << lab.output;
    EXPECT_THAT(lab.output, HasSubstr(c.part));
    EXPECT_THAT(lab.output, Not(HasSubstr("median")));
  }
}

TEST_F(LabStudy, CtrlCEndsALongRunSoonAndPrintsNoHalfResult) {
  Program lab(folder, "handrail-lab", {"linear-movement", "--operators", "5000", "--json"});
  sleep_until(monotonic_now() + 300 * kMillisecond);
  lab.send(SIGINT);
  EXPECT_EQ(lab.finish(), 130);
  EXPECT_THAT(lab.output(), HasSubstr("cancelled"));
  EXPECT_THAT(lab.output(), Not(HasSubstr("median")));
}

TEST_F(LabStudy, TheFitWritesAPopulationThatReadsBack) {
  const std::string out = folder.path() + "/people.operators";
  Program fit(folder, "handrail-lab", {"fit", "linear-movement", "--operators", "1", "--out", out});
  ASSERT_EQ(fit.finish(), 0) << fit.output();
  EXPECT_THAT(fit.output(), HasSubstr("mode NV alone"));
  EXPECT_THAT(fit.output(), HasSubstr("written: " + out));
  EXPECT_EQ(run({"--population", out, "--operators", "1", "--trials", "1"}).code, 0);
  Program check(folder, "handrail-lab",
                {"fit", "linear-movement", "--operators", "1", "--population", out, "--check"});
  EXPECT_EQ(check.finish(), 0) << check.output();
}

TEST_F(LabStudy, AFitShowsOnATerminalHowFarItIsAndHowFarItMayGo) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(::openpty(&ends[0], &ends[1], nullptr, nullptr, nullptr), 0);
  for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);
  Program fit(folder, "handrail-lab",
              {"fit", "linear-movement", "--operators", "1", "--evaluations", "2", "--out",
               folder.path() + "/fitted.operators"},
              Streams{.error = ends[1]});
  EXPECT_EQ(fit.finish(), 0) << fit.output();
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  std::array<char, 4096> seen{};
  const ssize_t count = ::read(ends[0], seen.data(), seen.size());
  const std::string text(seen.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  for (const int end : ends) ::close(end);
  EXPECT_THAT(text, HasSubstr("fit: 0 of at most 2 candidates"));
  EXPECT_THAT(text, HasSubstr("fit: 2 of at most 2 candidates, misfit "));
  EXPECT_THAT(fit.output(), Not(HasSubstr("at most")));
}

}  // namespace
}  // namespace handrail
