// Gearshift and wrench as experiments at the running programs: simulated people make trials, and
// people are asked what they felt.
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class WallExperimentTest : public WholeCell {
 protected:
  void SetUp() override {
    device_kind = "kind: PAGE";
    WholeCell::SetUp();
  }
  std::unique_ptr<Program> begin(const std::string& experiment) {
    return std::make_unique<Program>(
        folder, "handrail",
        std::vector<std::string>{"experiment", experiment, "--subject", "sim1", "--simulated",
                                 "--trials", "1", "--out", results(), "--socket", socket()});
  }
  // Two trials of 15 to 30 s each.
  static int all_made(Program& program) {
    for (const Nanos give_up = monotonic_now() + 180 * kSecond;
         program.running() && monotonic_now() < give_up;) {
      sleep_until(monotonic_now() + 50 * kMillisecond);
    }
    return program.finish();
  }
  std::string results() const { return folder.path() + "/results"; }
  std::string file(const std::string& name) const {
    std::ifstream in(results() + "/" + name);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::string report(const std::string& experiment, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"experiment", experiment, "--report", "--out", results()};
    words.insert(words.end(), more.begin(), more.end());
    const auto [code, text] = handrail(words);
    EXPECT_EQ(code, 0) << text;
    return text;
  }
};

TEST_F(WallExperimentTest, ASimulatedPersonShiftsThroughAllGears) {
  auto runner = begin("gearshift");
  EXPECT_TRUE(
      eventually([](const pb::Status& s) { return s.prompt().find("Now 2.") != s.prompt().npos; }));
  ASSERT_EQ(all_made(*runner), 0) << runner->output();
  const std::string lines = file("gearshift.sim1.jsonl");
  EXPECT_THAT(lines, HasSubstr("\"visited\":[\"N\",\"1\",\"2\",\"3\",\"4\",\"5\",\"R\",\"N\"]"))
      << lines;
  EXPECT_THAT(lines, HasSubstr("\"wrong_gears\":0"));
  EXPECT_THAT(lines, Not(HasSubstr("\"time-out\"")));
  EXPECT_THAT(runner->output(), Not(HasSubstr("How far do you agree")));
  EXPECT_THAT(file("gearshift.sim1.02.csv"), HasSubstr("t_s,x_mm,y_mm"));
  const std::string table = report("gearshift", {"--simulated", "--figures", results()});
  EXPECT_THAT(table, HasSubstr("1 simulated person, 1 trials that count, 0 of them failed"));
  EXPECT_THAT(table, HasSubstr("they feel nothing"));
  EXPECT_THAT(file("gearshift-people.svg"), HasSubstr("simulated people"));
  // It leaves the cell as it found it.
  EXPECT_EQ(status().prompt(), "");
  EXPECT_EQ(status().lease().holder(), "");
}

TEST_F(WallExperimentTest, ASimulatedPersonTurnsTheWrenchBehindTheBall) {
  auto runner = begin("wrench");
  EXPECT_TRUE(eventually([](const pb::Status& s) { return s.walls().turned_rad() > 1.0; }));
  const pb::Status turns = status();
  EXPECT_EQ(turns.walls().ball_mm_size(), 2);
  EXPECT_EQ(turns.walls().screw_c(), 5.0);
  // The next trial begins with a loose screw, and with what its scene says.
  order("screw_c: 15");
  EXPECT_TRUE(eventually([](const pb::Status& s) { return s.walls().screw_c() == 15.0; }));
  EXPECT_LT(status().walls().turned_rad(), 9.0);
  ASSERT_EQ(all_made(*runner), 0) << runner->output();
  const std::string lines = file("wrench.sim1.jsonl");
  EXPECT_THAT(lines, HasSubstr("\"screw_c\":15"));
  EXPECT_THAT(lines, HasSubstr("\"screw_c\":5"));
  EXPECT_THAT(lines, Not(HasSubstr("\"time-out\"")));
  // Two half turns and what the corners add.
  EXPECT_GT(status().walls().turned_rad(), 2.0 * 3.1);
  EXPECT_LT(status().walls().turned_rad(), 2.0 * 3.6);
  EXPECT_THAT(report("wrench", {"--simulated", "--json"}), HasSubstr("\"max_from_ball_mm\""));
  EXPECT_EQ(handrail({"screw", "101"}).first, 1);
  EXPECT_EQ(handrail({"screw", "much"}).first, 2);
}

TEST_F(WallExperimentTest, APersonIsAskedUntilAllIsAnswered) {
  std::filesystem::create_directories(results());
  std::ofstream(results() + "/gearshift.anna.jsonl")
      << R"({"subject":{"experiment":"gearshift","subject":"anna","simulated":false,"modes":["walls"],"practice":1,"trials":1}})"
      << '\n'
      << R"({"began":{"practice":true,"walls":{}}})" << '\n'
      << R"({"ended":{"practice":true,"walls":{"end":"done","time_s":30}}})" << '\n'
      << R"({"began":{"walls":{}}})" << '\n'
      << R"({"ended":{"walls":{"end":"done","time_s":25}}})" << '\n';
  const auto type = [&](const std::string& typed) {
    const std::string line = "printf '" + typed + "' | " + HANDRAIL_BIN_DIR +
                             "/handrail experiment gearshift --subject anna --resume --out " +
                             results() + " --socket " + socket();
    Program shell(folder, "/bin/sh", {"-c", line});
    EXPECT_EQ(shell.finish(), 0) << shell.output();
    return shell.output();
  };
  const std::string first = type("3\\nvery\\n");
  EXPECT_THAT(first, HasSubstr("'very' is no score"));
  EXPECT_THAT(first, HasSubstr("not all is answered: --resume asks again"));
  EXPECT_THAT(file("gearshift.anna.jsonl"), HasSubstr("{\"statement\":\"visual effect\"}"));
  const std::string second = type("5\\n2\\n");
  EXPECT_THAT(second, Not(HasSubstr("not all is answered")));
  EXPECT_THAT(second, HasSubstr("visual effect (1 answers)"));
  EXPECT_THAT(type(""), Not(HasSubstr("How far do you agree"))) << "all is answered";
  EXPECT_THAT(report("gearshift", {}), HasSubstr("resemblance (1 answers)"));
}

}  // namespace
}  // namespace handrail
