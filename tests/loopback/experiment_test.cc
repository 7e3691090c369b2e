// An experiment at the running programs: a simulated person makes trials, the runner is killed,
// interrupted and started again, and nothing that was finished is lost.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>

#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ExperimentTest : public WholeCell {
 protected:
  void SetUp() override {
    device_kind = "kind: PAGE";
    WholeCell::SetUp();
  }
  std::vector<std::string> words(const std::vector<std::string>& more) const {
    std::vector<std::string> out = {"experiment", "linear-movement", "--out", results()};
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
  std::string results() const { return folder.path() + "/results"; }
  std::pair<int, std::string> run(const std::vector<std::string>& more) {
    return handrail(words(more));
  }
  std::unique_ptr<Program> begin(std::vector<std::string> more) const {
    more.insert(more.end(), {"--simulated", "--socket", socket()});
    return std::make_unique<Program>(folder, "handrail", words(more));
  }
  // A trial of a simulated person takes 13 to 30 s, and up to 60 with a time-out.
  static bool says(Program& program, const std::string& part, int times = 1) {
    for (const Nanos give_up = monotonic_now() + 150 * kSecond; monotonic_now() < give_up;) {
      int found = 0;
      const std::string text = program.output();
      for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++found;
      if (found >= times) return true;
      if (!program.running()) break;
      sleep_until(monotonic_now() + 20 * kMillisecond);
    }
    ADD_FAILURE() << "no '" << part << "' in:\n" << program.output();
    return false;
  }
  std::string file(const std::string& subject) const {
    std::ifstream in(results() + "/linear-movement." + subject + ".jsonl");
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST_F(ExperimentTest, NoTrialThatWasFinishedIsLost) {
  auto first = begin({"--subject", "sim1"});
  ASSERT_TRUE(says(*first, "clock"));
  EXPECT_THAT(status().prompt(), HasSubstr("M starts the clock"));
  ASSERT_TRUE(says(*first, "done: ")) << "the first trial";
  ASSERT_TRUE(says(*first, "M starts the clock", 2)) << "the second trial";
  // A second runner is told, and disturbs nothing.
  const auto [code, answer] = run({"--subject", "sim1", "--simulated", "--resume"});
  EXPECT_EQ(code, 1);
  EXPECT_THAT(answer, HasSubstr("another `handrail experiment` has it open"));
  // Longer than a prompt lasts that nobody renews.
  first->send(SIGSTOP);
  EXPECT_TRUE(eventually([](const pb::Status& s) { return !s.has_prompt(); }));
  first->send(SIGCONT);
  EXPECT_TRUE(eventually([](const pb::Status& s) { return s.has_prompt(); }));
  first->kill();
  const std::string killed = file("sim1");
  EXPECT_THAT(killed, HasSubstr("\"end\":\"done\"")) << killed;

  auto second = begin({"--subject", "sim1", "--resume"});
  ASSERT_TRUE(says(*second, "Trial 2, ")) << "the one that was not finished is made again";
  EXPECT_THAT(second->output(), Not(HasSubstr("Trial 1, ")));
  ASSERT_TRUE(says(*second, "M starts the clock"));
  second->send(SIGINT);
  EXPECT_EQ(second->finish(), 130) << second->output();
  EXPECT_THAT(second->output(), HasSubstr("--resume goes on"));
  EXPECT_THAT(file("sim1"), HasSubstr("\"interrupted\":true"));
  const auto [rules, problem] =
      run({"--subject", "sim1", "--simulated", "--resume", "--trials", "3"});
  EXPECT_EQ(rules, 1);
  EXPECT_THAT(problem, HasSubstr("was begun with --trials 2, expected the same, not 3"));
  EXPECT_EQ(file("sim1").substr(0, killed.size()), killed);
  // It leaves the cell as it found it.
  const pb::Status after = status();
  EXPECT_EQ(after.prompt(), "");
  EXPECT_EQ(after.state(), "off");
  EXPECT_EQ(after.lease().holder(), "");
  EXPECT_TRUE(std::filesystem::exists(results() + "/linear-movement.sim1.01.csv"));
  // Practice is no result, and simulated people are no people.
  const auto [report, text] = run({"--report"});
  EXPECT_EQ(report, 1);
  EXPECT_THAT(text, HasSubstr("no counted trial of a person in linear-movement"));
}

// Whatever order another version would draw for the name.
TEST_F(ExperimentTest, WhoGoesOnGoesOnInTheFilesOrderOfModes) {
  std::filesystem::create_directories(results());
  const auto begun_with = [&](const std::string& modes) {
    std::ofstream(results() + "/linear-movement.sim4.jsonl")
        << R"({"subject":{"experiment":"linear-movement","subject":"sim4","simulated":true,)"
        << R"("modes":[)" << modes << R"(],"practice":2,"trials":2}})" << '\n';
  };
  for (const std::string first : {"NV", "V"}) {
    begun_with(first == "NV" ? R"("NV","V")" : R"("V","NV")");
    auto runner = begin({"--subject", "sim4", "--resume"});
    EXPECT_TRUE(says(*runner, "Trial 1, " + first + ", practice"));
    runner->send(SIGINT);
    EXPECT_EQ(runner->finish(), 130);
  }
  begun_with(R"("X")");
  const auto [code, text] = run({"--subject", "sim4", "--simulated", "--resume"});
  EXPECT_EQ(code, 1);
  EXPECT_THAT(text, HasSubstr("there is no mode 'X'"));
}

TEST_F(ExperimentTest, AnotherSceneInTheMiddleEndsIt) {
  auto runner = begin({"--subject", "sim2"});
  ASSERT_TRUE(says(*runner, "M starts the clock"));
  order("disengage: true");
  order("scene_load: 'screw-fastening'");
  EXPECT_EQ(runner->finish(), 1);
  EXPECT_THAT(runner->output(), HasSubstr("the scene 'screw-fastening' was loaded in the middle"));
  EXPECT_THAT(file("sim2"), HasSubstr("\"interrupted\":true"));
}

TEST_F(ExperimentTest, AMasterThatStartsAnewEndsTheTrialAndIsUsedAgain) {
  auto runner = begin({"--subject", "sim3"});
  ASSERT_TRUE(says(*runner, ", then M.")) << "the clock runs";
  master->kill();
  ASSERT_TRUE(says(*runner, "session lost"));
  start_master();
  ASSERT_TRUE(says(*runner, "Trial 2, "));
  runner->send(SIGINT);
  EXPECT_EQ(runner->finish(), 130);
}

TEST_F(ExperimentTest, WordsThatCannotBeAreRefusedBeforeAnythingIsMade) {
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"--subject", "a/b"}, "--subject: "},
      {{}, "expected --subject ID, or --report"},
      {{"--subject", "a", "--trials", "21"}, "--trials '21', expected 1 to 20"},
      {{"--subject", "a", "--trials", "2x"}, "--trials '2x', expected 1 to 20"},
      {{"--subject", "a", "--figures", "f"}, "--figures goes with --report"},
      {{"--report"}, "cannot be read"},
  };
  for (const auto& [more, wanted] : cases) {
    const auto [code, text] = run(more);
    EXPECT_NE(code, 0);
    EXPECT_THAT(text, HasSubstr(wanted));
  }
  EXPECT_FALSE(std::filesystem::exists(results()));
  const auto [code, text] = handrail({"experiment", "juggling", "--subject", "a"});
  EXPECT_EQ(code, 2);
  EXPECT_THAT(text,
              HasSubstr("there is no 'juggling', expected linear-movement, gearshift, wrench, "
                        "wrench-loosening"));
}

TEST_F(ExperimentTest, AFolderThatIsNoneIsSaid) {
  folder.write("results", "a file");
  const auto [code, text] = run({"--subject", "a"});
  EXPECT_EQ(code, 1);
  EXPECT_THAT(text, HasSubstr("results: cannot be made"));
}

TEST_F(ExperimentTest, MarksAndPromptsAreOneLineOfText) {
  order("mark: 'reached'");
  order("mark: 'again'");
  const pb::Status now = status();
  EXPECT_EQ(now.mark().count(), 2u);
  EXPECT_EQ(now.mark().text(), "again");
  EXPECT_NEAR(now.mark().time_s(), now.time_s(), 5.0);
  EXPECT_LE(now.mark().time_s(), now.time_s());
  EXPECT_THAT(refusal("mark: ''"), HasSubstr("mark: '', expected 1 to 200 bytes of plain text"));
  EXPECT_THAT(refusal("mark: '" + std::string(201, 'x') + "'"), HasSubstr("1 to 200 bytes"));
  EXPECT_THAT(refusal("prompt: 'two\\nlines'"), HasSubstr("in one line"));
  EXPECT_THAT(refusal("prompt: 'esc\\033[2J'"), HasSubstr("in one line"));
  EXPECT_THAT(refusal("mark: 'x' observer: true"), HasSubstr("only looks"));
  order("prompt: 'Turn the key.'");
  EXPECT_EQ(status().prompt(), "Turn the key.");
  // It goes with who does not say it again.
  EXPECT_TRUE(eventually([](const pb::Status& s) { return !s.has_prompt(); }));
  order("prompt: 'Turn the key.'");
  order("prompt: ''");
  EXPECT_FALSE(status().has_prompt());
  EXPECT_EQ(handrail({"mark", "here"}).first, 0);
  EXPECT_EQ(status().mark().count(), 3u);
}

class OmniExperimentTest : public WholeCell {};

TEST_F(OmniExperimentTest, ASimulatedPersonWantsThePage) {
  const auto [code, text] = handrail(
      {"experiment", "linear-movement", "--subject", "a", "--simulated", "--out", folder.path()});
  EXPECT_EQ(code, 1);
  EXPECT_THAT(text, HasSubstr("start it with device { kind: PAGE }"));
}

class JoystickExperimentTest : public WholeCell {
 protected:
  void SetUp() override {
    device_kind = "kind: SIM_JOYSTICK";
    WholeCell::SetUp();
  }
};

TEST_F(JoystickExperimentTest, ADeviceThatCannotTurnIsNoneForThisTask) {
  const auto [code, text] =
      handrail({"experiment", "linear-movement", "--subject", "a", "--out", folder.path()});
  EXPECT_EQ(code, 1);
  EXPECT_THAT(text, HasSubstr("does not say how the hand is turned"));
}

}  // namespace
}  // namespace handrail
