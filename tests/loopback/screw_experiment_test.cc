// Screw fastening as an experiment at the running programs: the rig says what happens at the screw,
// a simulated person fastens it.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "client/api/rig_client.h"
#include "server/lab/replay/recording_csv.h"
#include "server/lab/replay/replay.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class ScrewExperimentTest : public WholeCell {
 protected:
  void SetUp() override {
    device_kind = "kind: PAGE";
    rig_extra = "status_socket: '" + rig_socket() + "'";
    slave_extra = master_extra = " recording { folder: '" + folder.path() + "/recordings' }";
    WholeCell::SetUp();
  }
  std::string rig_socket() const { return folder.path() + "/rig.sock"; }
  std::string results() const { return folder.path() + "/results"; }
  std::string file() const {
    std::ifstream in(results() + "/screw-fastening.sim1.jsonl");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::vector<std::string> words(std::vector<std::string> more) const {
    more.insert(more.begin(), {"experiment", "screw-fastening", "--out", results()});
    return more;
  }
  // Somebody whose only mode is this one, and who has practised it.
  void begun(const std::string& mode) const {
    std::filesystem::create_directories(results());
    const std::string practised =
        R"({"began":{"practice":true,"screw":{"mode":")" + mode + R"("}}})" + "\n" +
        R"({"ended":{"practice":true,"screw":{"mode":")" + mode + R"(","end":"done"}}})" + "\n";
    std::ofstream(results() + "/screw-fastening.sim1.jsonl")
        << R"({"subject":{"experiment":"screw-fastening","subject":"sim1","simulated":true,"modes":[")"
        << mode << R"("],"practice":2,"trials":1}})" << '\n'
        << practised << practised;
  }
  std::unique_ptr<Program> begin() const {
    return std::make_unique<Program>(folder, "handrail",
                                     words({"--subject", "sim1", "--simulated", "--resume",
                                            "--rig-socket", rig_socket(), "--socket", socket()}));
  }
  pb::RigStatus at_screw() {
    const auto now = rig_client.look(nullptr, kSecond);
    EXPECT_TRUE(now) << now.message();
    return now ? *now : pb::RigStatus();
  }
  // Until `done` holds of what the rig says; a trial takes 20 to 40 s.
  template <typename Done>
  bool at_screw_within(Nanos patience, Program& runner, Done done) {
    for (const Nanos give_up = monotonic_now() + patience;
         runner.running() && monotonic_now() < give_up;) {
      const pb::RigStatus now = at_screw();
      if (now.moment_size() > 0 && done(now.moment(0))) return true;
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    return false;
  }

  // Of the third trial, the only one that this runner made: one row a millisecond, as it says it
  // took.
  void its_ticks_stand_in_a_recording() {
    std::string recording;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path() + "/recordings")) {
      const std::string name = entry.path().string();
      if (name.find("-master-screw-fastening-sim1") != std::string::npos) recording = name;
    }
    std::ifstream in(recording, std::ios::binary);
    std::ostringstream table, none;
    const auto rows = write_recording_csv(in, table, 0.0, 3);
    ASSERT_TRUE(rows) << recording << ": " << rows.message();
    const std::string lines = file();
    const auto at = lines.rfind("\"completion_time_s\":");
    ASSERT_NE(at, std::string::npos) << lines;
    const double took = std::stod(lines.substr(at + 20));
    // The way to the start belongs to a trial too.
    EXPECT_GT(static_cast<double>(*rows), 1e3 * took);
    EXPECT_LT(static_cast<double>(*rows), 1e3 * (took + 60.0));
    std::ifstream whole(recording, std::ios::binary);
    const auto replayed = replay(whole, {});
    ASSERT_TRUE(replayed) << replayed.message();
    std::vector<std::string> marks;
    for (const auto& event : replayed->happened) marks.push_back(event.text);
    EXPECT_THAT(marks, Contains("trial begins: screw-fastening C-V sim1 3 simulated"));
    EXPECT_THAT(marks, Contains("trial ends: screw-fastening C-V sim1 3 simulated done"));
    std::ifstream again(recording, std::ios::binary);
    EXPECT_THAT(write_recording_csv(again, none, 0.0, 4).message(), HasSubstr("no trial 4"));
  }

  RigClient rig_client{folder.path() + "/rig.sock"};
};

TEST_F(ScrewExperimentTest, ASimulatedPersonFastensTheScrewWithProtectionAndTools) {
  begun("C-V");
  auto runner = begin();
  ASSERT_TRUE(at_screw_within(90 * kSecond, *runner, [](const pb::RigMoment& now) {
    return now.screw().turned_deg() > 90.0;
  })) << runner->output();
  // It is what the bumper and the tools make of it: the slave knows the contact, the hand feels it.
  bool rotates = false, touches = false;
  ASSERT_TRUE(at_screw_within(120 * kSecond, *runner, [&](const pb::RigMoment& now) {
    const pb::Status master_says = status();
    rotates = rotates || master_says.orientation_tool().kind() == "f-rotation";
    const auto& force = master_says.contact_force_n();
    touches = touches || (force.size() == 3 && Vec3(force[0], force[1], force[2]).norm() > 5.0);
    return now.screw().turned_deg() >= 540.0;
  })) << runner->output();
  EXPECT_TRUE(rotates && touches);
  EXPECT_EQ(status().scene(), "screw-fastening");
  EXPECT_EQ(status().slave_scene(), "screw-fastening");
  ASSERT_EQ(runner->finish(), 0) << runner->output();
  EXPECT_THAT(runner->output(), HasSubstr("done: "));
  EXPECT_THAT(file(), HasSubstr("\"mode\":\"C-V\""));
  EXPECT_THAT(file(), HasSubstr("\"max_contact_force_n\":"));
  EXPECT_TRUE(std::filesystem::exists(results() + "/screw-fastening.sim1.03.csv"));
  const auto [code, text] = handrail(words({"--report", "--simulated", "--figures", results()}));
  EXPECT_EQ(code, 0) << text;
  EXPECT_THAT(text, HasSubstr("simulated operators"));
  EXPECT_TRUE(std::filesystem::exists(results() + "/screw-fastening-measures.svg"));
  for (const char* figure : {"measures", "trajectories", "forces"}) {
    EXPECT_TRUE(std::filesystem::exists(results() + "/screw-fastening-" + figure + ".svg"));
  }
  its_ticks_stand_in_a_recording();
  // It leaves the cell as it found it.
  EXPECT_EQ(status().prompt(), "");
  EXPECT_EQ(status().lease().holder(), "");
}

TEST_F(ScrewExperimentTest, WithoutProtectionIsAnotherSceneAndAKilledTrialIsMadeAgain) {
  begun("NC-NV");
  const std::string before = file();
  auto runner = begin();
  ASSERT_TRUE(at_screw_within(90 * kSecond, *runner, [](const pb::RigMoment& now) {
    return now.screw().turned_deg() > 20.0;
  })) << runner->output();
  EXPECT_EQ(status().scene(), "screw-fastening-nc");
  EXPECT_EQ(at_screw().scene(), "screw-fastening-nc");
  runner->kill();
  EXPECT_EQ(file().substr(0, before.size()), before);
  auto again = begin();
  // The key is taken out of the screw, and the screw is a new one.
  ASSERT_TRUE(at_screw_within(60 * kSecond, *again, [](const pb::RigMoment& now) {
    return now.screw().turned_deg() == 0.0;
  })) << again->output();
  again->send(SIGINT);
  EXPECT_EQ(again->finish(), 130) << again->output();
  EXPECT_THAT(file(), HasSubstr("\"interrupted\":true"));
}

TEST_F(ScrewExperimentTest, ARigThatIsNotNamedOrNotThereIsSaid) {
  const auto [code, text] = handrail(words({"--subject", "anna"}));
  EXPECT_EQ(code, 1);
  EXPECT_THAT(text, HasSubstr("--rig-socket: expected the status_socket of handrail-rig"));
  const auto [none, problem] =
      handrail(words({"--subject", "anna", "--rig-socket", folder.path() + "/none"}));
  EXPECT_EQ(none, 1);
  EXPECT_THAT(problem, HasSubstr("no simulated rig on "));
  EXPECT_FALSE(std::filesystem::exists(results()));
}

}  // namespace
}  // namespace handrail
