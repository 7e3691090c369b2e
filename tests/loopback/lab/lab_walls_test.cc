// handrail-lab wrench and gearshift as programs: JSON, files, and what they say about bad input.
#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

#include "tests/loopback/program.h"

namespace handrail {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class LabWalls : public ::testing::Test {
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
  std::string file(const std::string& name) const { return folder.path() + "/" + name; }
  static std::string text_of(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
  // What stands between the brackets of the first list of that name, blanks left out, by comma.
  static std::vector<std::string> list(const std::string& json, const std::string& name) {
    std::vector<std::string> out;
    const std::size_t start = json.find("\"" + name + "\": [");
    if (start == std::string::npos) return out;
    const std::size_t open = json.find('[', start), end = json.find(']', open);
    std::string word;
    for (const char c : json.substr(open + 1, end - open - 1) + ",") {
      if (c == ',' && !word.empty()) {
        out.push_back(word);
        word.clear();
      } else if (c != ',' && c != ' ' && c != '\n' && c != '"') {
        word += c;
      }
    }
    return out;
  }
  static std::vector<double> numbers(const std::string& json, const std::string& name) {
    std::vector<double> out;
    for (const std::string& word : list(json, name)) out.push_back(std::stod(word));
    return out;
  }

  TempFolder folder;
};

TEST_F(LabWalls, ThePictureOfTheFirstPageIsWhatItsCommandGives) {
  EXPECT_EQ(run({"gearshift", "--operators", "1", "--figures", folder.path()}).code, 0);
  const std::string drawn = text_of(file("gearshift.svg"));
  EXPECT_FALSE(drawn.empty());
  EXPECT_TRUE(drawn == text_of(HANDRAIL_SOURCE_DIR "/server/lab/gearshift.svg"));
}

TEST_F(LabWalls, TheWrenchPrintsAPeakAndAnAngleForEachTurn) {
  const Run lab = run({"wrench", "--c", "15", "--turns", "4", "--loosen", "4", "--json"});
  ASSERT_EQ(lab.code, 0) << lab.output;
  const std::vector<double> peaks = numbers(lab.output, "peaks_n");
  const std::vector<double> alphas = numbers(lab.output, "alpha_rad");
  ASSERT_EQ(peaks.size(), 8u) << lab.output;
  ASSERT_EQ(alphas.size(), 8u);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_GT(peaks[i], peaks[i - 1]);
    EXPECT_LT(peaks[i + 4], peaks[i + 3]);
    EXPECT_GT(alphas[i], alphas[i - 1]);
    EXPECT_LT(alphas[i + 4], alphas[i + 3]);
  }
  for (const double peak : peaks) EXPECT_TRUE(peak > 0.0 && peak < 16.0) << peak;
  for (const char* key : {"\"simulated\": true", "\"c\": 15", "\"loop_s\": 6", "\"radius_mm\": 60",
                          "\"max_force_n\"", "\"junction_ratio\"", "\"people\""}) {
    EXPECT_THAT(lab.output, HasSubstr(key));
  }
}

TEST_F(LabWalls, TheGearshiftPrintsWhatItVisitedAndItsEvents) {
  const Run lab = run({"gearshift", "--json"});
  ASSERT_EQ(lab.code, 0) << lab.output;
  EXPECT_THAT(list(lab.output, "visited"), ElementsAre("N", "1", "2", "3", "4", "5", "R", "N"));
  for (const char* key :
       {"\"max_force_n\"", "\"max_penetration_mm\"", "\"event\": \"lock\"", "\"event\": \"unlock\"",
        "\"event\": \"return\"", "\"gear\": \"R\"", "\"junction_ratio\""}) {
    EXPECT_THAT(lab.output, HasSubstr(key));
  }
}

TEST_F(LabWalls, ThreadsAndRepetitionChangeNoByteAndTheSeedDoes) {
  for (const char* what : {"wrench", "gearshift"}) {
    std::vector<std::string> words = {what, "--operators", "4", "--json", "--threads", "1"};
    const Run one = run(words);
    EXPECT_EQ(one.code, 0) << one.output;
    words.back() = "3";
    EXPECT_EQ(run(words).output, one.output);
    words.insert(words.end(), {"--seed", "2"});
    EXPECT_NE(run(words).output, one.output);
  }
}

TEST_F(LabWalls, SeveralOperatorsGiveMeasurementsThatAreNotCalledOpinions) {
  const Run wrench = run({"wrench", "--operators", "3", "--json", "--turns", "2"});
  EXPECT_THAT(wrench.output,
              AllOf(HasSubstr("\"score\": \"guidance\""), HasSubstr("\"score\": \"tightening\""),
                    HasSubstr("\"score\": \"resemblance\""), HasSubstr("\"published_mean\": 3.8")));
  EXPECT_THAT(run({"wrench", "--operators", "3"}).output, HasSubstr("have no opinions"));
  EXPECT_THAT(run({"wrench", "--json"}).output, Not(HasSubstr("published_mean")));
}

TEST_F(LabWalls, FiguresAndTracesAreWritten) {
  const Run wrench = run({"wrench", "--turns", "1", "--operators", "2", "--figures", file("w"),
                          "--traces", file("w.csv")});
  ASSERT_EQ(wrench.code, 0) << wrench.output;
  const Run gears = run({"gearshift", "--operators", "2", "--figures", file("g")});
  ASSERT_EQ(gears.code, 0) << gears.output;
  for (const char* name :
       {"w/wrench.svg", "w/wrench-people.svg", "g/gearshift.svg", "g/gearshift-people.svg"}) {
    EXPECT_THAT(text_of(file(name)), HasSubstr("</svg>")) << name;
  }
  const std::string trace = text_of(file("w.csv"));
  EXPECT_THAT(trace, HasSubstr("t_s,x_mm,y_mm,proxy_x_mm"));
  EXPECT_GT(std::count(trace.begin(), trace.end(), '\n'), 8000);
}

TEST_F(LabWalls, ARecordedHandIsPlayedInPlaceOfTheSimulatedOne) {
  const std::string hand = folder.write("hand.csv",
                                        "t_s,x_mm,y_mm\n0,0,-47\n1,0,-47\n2,0,47\n"
                                        "3,0,47\n");
  const Run gears = run({"gearshift", "--hand", hand, "--json"});
  ASSERT_EQ(gears.code, 0) << gears.output;
  EXPECT_THAT(list(gears.output, "visited"), ElementsAre("4", "3"));
  EXPECT_THAT(gears.output, HasSubstr("\"hand\": \"" + hand + "\""));
  EXPECT_EQ(run({"wrench", "--hand", hand, "--json"}).code, 0);
}

TEST_F(LabWalls, BadInputIsRefusedInOneLineThatSaysWhatIsWrong) {
  const std::string bad = folder.write("bad.csv", "t_s,x_mm,y_mm\n0,0,0\n0.1,one,0\n");
  const std::string far = folder.write("far.csv", "t_s,x_mm,y_mm\n0,0,0\n1,900,0\n");
  const struct {
    std::vector<std::string> words;
    std::string says;
  } cases[] = {{{"wrench", "--turns", "0"}, "--turns"},
               {{"wrench", "--c", "-1"}, "--c"},
               {{"wrench", "--operators", "0"}, "--operators"},
               {{"wrench", "--scene", "nowhere"}, "nowhere"},
               {{"wrench", "--scene", "plane"}, "no progressive effect"},
               {{"gearshift", "--scene", "wrench"}, "no detent"},
               {{"gearshift", "--hand", bad}, bad + ":3: "},
               {{"wrench", "--hand", "/nowhere.csv"}, "/nowhere.csv"},
               {{"wrench", "--hand", far}, "covers more than 500 mm"},
               {{"gearshift", "--hand", bad, "--operators", "2"}, "--operators"},
               {{"gearshift", "--turns", "3"}, "--turns"}};
  for (const auto& c : cases) {
    const Run lab = run(c.words);
    EXPECT_EQ(lab.code, 2) << c.says << ": " << lab.output;
    EXPECT_THAT(lab.output, HasSubstr(c.says));
  }
}

TEST_F(LabWalls, PricesAreCheckedEffectByEffect) {
  const Run lab = run({"price-check", "wrench"});
  EXPECT_LE(lab.code, 1) << lab.output;
  for (const char* word : {"wall  ", "progressive", "device_force_limits", "left out saves"}) {
    EXPECT_THAT(lab.output, HasSubstr(word));
  }
  EXPECT_EQ(run({"price-check", "nowhere"}).code, 2);
  const Run arm = run({"price-check", "linear-movement"});
  EXPECT_EQ(arm.code, 2);
  EXPECT_THAT(arm.output, HasSubstr("'linear-movement' has no walls"));
}

TEST_F(LabWalls, AFolderThatCannotBeMadeIsNamed) {
  const Run lab = run({"gearshift", "--figures", "/proc/none/here"});
  EXPECT_EQ(lab.code, 1);
  EXPECT_THAT(lab.output, HasSubstr("/proc/none/here"));
}

TEST_F(LabWalls, CtrlCEndsALongRunAtOnceWithoutHalfAResult) {
  Program lab(folder, "handrail-lab",
              {"wrench", "--operators", "100000", "--turns", "1000", "--json"});
  sleep_until(monotonic_now() + 300 * kMillisecond);
  ASSERT_TRUE(lab.running());
  lab.send(SIGINT);
  EXPECT_EQ(lab.finish(), 130);
  EXPECT_THAT(lab.output(), AllOf(HasSubstr("cancelled"), Not(HasSubstr("peaks_n"))));
}

}  // namespace
}  // namespace handrail
