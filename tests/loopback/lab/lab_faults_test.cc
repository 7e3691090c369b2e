// The fault matrix as a program: many seeds, killed and interrupted and gone on with.
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/loopback/program.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class LabFaults : public ::testing::Test {
 protected:
  struct Run {
    int code = 0;
    std::string output;
  };
  static std::vector<std::string> words(std::vector<std::string> more) {
    more.insert(more.begin(), "faults");
    return more;
  }
  Run run(const std::vector<std::string>& arguments) {
    Program lab(folder, "handrail-lab", words(arguments));
    const int code = lab.finish();
    return {code, lab.output()};
  }
  std::string text(const std::string& path) const {
    std::ostringstream out;
    out << std::ifstream(path).rdbuf();
    return out.str();
  }
  long lines(const std::string& path) const {
    const std::string all = text(path);
    return std::count(all.begin(), all.end(), '\n');
  }
  // Waits until the file has so many lines.
  void wait_for_lines(Program& lab, const std::string& path, long count) {
    const Nanos give_up = monotonic_now() + Program::kPatience;
    while (lines(path) < count) {
      ASSERT_TRUE(lab.running()) << lab.output();
      ASSERT_LT(monotonic_now(), give_up);
      sleep_until(monotonic_now() + 2 * kMillisecond);
    }
  }

  TempFolder folder;
  std::string results = folder.path() + "/runs.txt";
};

TEST_F(LabFaults, AKilledMatrixGoesOnWhereItWas) {
  {
    Program lab(folder, "handrail-lab",
                words({"--row", "S3b", "--seeds", "1..1000", "--results", results}));
    wait_for_lines(lab, results, 5);
    lab.kill();
  }
  const long before = lines(results);
  ASSERT_GE(before, 5);
  const std::vector<std::string> again = {"--row", "S3b", "--seeds", "1,2", "--json"};
  const Run fresh = run(again);
  std::vector<std::string> kept = again;
  kept.insert(kept.end(), {"--results", results});
  const Run resumed = run(kept);
  EXPECT_EQ(resumed.code, fresh.code) << resumed.output;
  // Without the lines on the error output.
  EXPECT_EQ(resumed.output.substr(resumed.output.find('{')),
            fresh.output.substr(fresh.output.find('{')));
  EXPECT_THAT(fresh.output, HasSubstr("\"runs\": 12"));
  // What is known is not run again, and is what counts.
  std::string file = text(results);
  const std::size_t at = file.find("\nS3b 2 3 0 ");
  ASSERT_NE(at, file.npos) << file;
  file.replace(at, 11, "\nS3b 2 3 9 ");
  folder.write("runs.txt", file);
  const Run changed = run(kept);
  EXPECT_EQ(changed.code, 1);
  EXPECT_THAT(changed.output, HasSubstr("\"violations\": 9"));
  EXPECT_EQ(text(results), file);
}

TEST_F(LabFaults, CtrlCEndsItCleanlyAndSaysHowToGoOn) {
  Program lab(folder, "handrail-lab",
              words({"--row", "S3b", "--seeds", "1..1000", "--results", results, "--out",
                     folder.path() + "/table.txt"}));
  wait_for_lines(lab, results, 3);
  lab.send(SIGINT);
  EXPECT_EQ(lab.finish(), 130);
  EXPECT_THAT(lab.output(), HasSubstr("of 6000 runs; the same command goes on from " + results));
  EXPECT_EQ(text(results).back(), '\n');
  EXPECT_FALSE(std::filesystem::exists(folder.path() + "/table.txt"));
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    EXPECT_THAT(entry.path().filename().string(), Not(StartsWith("table.txt")));
  }
}

// S2b is one run of a simulated hour, of which nothing is kept.
TEST_F(LabFaults, CtrlCIsAnsweredInTwoSecondsInTheMiddleOfALongRun) {
  Program lab(folder, "handrail-lab", words({"--row", "S2b"}));
  sleep_until(monotonic_now() + 500 * kMillisecond);
  ASSERT_TRUE(lab.running()) << lab.output();
  const Nanos sent = monotonic_now();
  lab.send(SIGINT);
  EXPECT_EQ(lab.finish(), 130);
  EXPECT_LT(monotonic_now() - sent, 2 * kSecond);
  EXPECT_THAT(lab.output(), HasSubstr("stopped after 0 of 1 runs; with --results FILE it could"));
}

TEST_F(LabFaults, TheTableOfSeveralSeedsIsPrintedAndWritten) {
  const std::string out = folder.path() + "/table.txt";
  const Run lab = run({"--row", "X9b", "--seeds", "1..3", "--out", out});
  EXPECT_EQ(lab.code, 0) << lab.output;
  EXPECT_THAT(lab.output, HasSubstr("seed 2 done: 0 violations\n"));
  EXPECT_THAT(text(out), StartsWith("handrail-lab faults --row X9b --seeds 1..3: 12 runs, 0 "
                                    "violations\n"));
  EXPECT_THAT(lab.output, HasSubstr(text(out)));
  const Run nowhere = run({"--row", "X9b", "--out", "/nowhere/table.txt"});
  EXPECT_EQ(nowhere.code, 2);
  EXPECT_THAT(nowhere.output, HasSubstr("/nowhere/table.txt: cannot write: No such file"));
}

TEST_F(LabFaults, ResultsOfTheQuickFormDoNotStandForTheWholeOne) {
  ASSERT_EQ(run({"--row", "X9b", "--quick", "--results", results}).code, 0);
  const Run whole = run({"--row", "X9b", "--results", results});
  EXPECT_EQ(whole.code, 2);
  EXPECT_THAT(whole.output, HasSubstr(results + ":1: "));
  EXPECT_THAT(whole.output, HasSubstr("quick'; expected"));
}

TEST_F(LabFaults, TheQuickFormIsShort) {
  const Run quick = run({"--row", "N13", "--quick"});
  EXPECT_EQ(quick.code, 0) << quick.output;
  EXPECT_THAT(quick.output, HasSubstr("handrail-lab faults --row N13 --quick --seeds 1: 2 runs"));
  EXPECT_THAT(run({"--row", "X9b"}).output, Not(HasSubstr("quick")));
}

TEST_F(LabFaults, WrongWordsAreRefused) {
  const struct {
    std::vector<std::string> words;
    const char* says;
  } cases[] = {{{"--seeds", "5..1"}, "expected a range that rises"},
               {{"--seeds", "a..b"}, "expected such as 7 or 1..50"},
               {{"--seed", "-3"}, "expected such as 7 or 1..50"},
               {{"--seeds", "1..99999999999"}, "expected at most 1000"},
               {{"--seeds", "99999999999999999999"}, "expected such as 7 or 1..50"},
               {{"--seeds", "1..3", "--row", "N99"}, "no row 'N99'"},
               {{"--results", "/nowhere/runs.txt"}, "cannot open /nowhere/runs.txt"},
               {{"--prove", "--quick"}, "excludes --prove"}};
  for (const auto& c : cases) {
    const Run lab = run(c.words);
    EXPECT_EQ(lab.code, 2) << c.says;
    EXPECT_THAT(lab.output, HasSubstr(c.says));
  }
}

}  // namespace
}  // namespace handrail
