// Trials of the studies, recorded as the daemons would, and done again.
#include "server/lab/study/trial_recording.h"

#include <gmock/gmock.h>

#include <fstream>

#include "server/lab/replay/replay.h"
#include "server/lab/study/linear/linear_trial.h"
#include "server/lab/study/screw/screw_trial.h"
#include "server/lab/study/study_setup_io.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

StudySetup setup_of(const std::string& name, const std::vector<std::string>& settings,
                    const std::string& folder) {
  StudySetup out = *study_setup(name, name, settings);
  out.machine.recording.folder = folder;
  return out;
}

// Both sides of it, to the bit; what stands first and last in the master's marks.
void expect_replays(const std::string& name, const std::string& begins, const std::string& ends) {
  for (const char* side : {".master.mcap", ".slave.mcap"}) {
    std::ifstream in(name + side, std::ios::binary);
    const auto again = replay(in, {});
    ASSERT_TRUE(again) << name << side << ": " << again.message();
    EXPECT_EQ(again->different, 0u) << again->first->number << ": " << again->first->field;
    EXPECT_EQ(again->replayed, again->entries);
    EXPECT_GT(again->entries, 500u);
    EXPECT_EQ(again->damage, "");
    ASSERT_GE(again->happened.size(), 2u);
    EXPECT_EQ(again->happened.front().text, begins);
    EXPECT_EQ(again->happened.back().text, ends);
  }
}

TEST(TrialRecordingTest, ALinearTrialIsTheSameWithItAndReplaysWithItsSettings) {
  const TempFolder folder;
  const StudySetup setup =
      setup_of("linear-movement", {"guidance.stiffness_n_mm=0.35"}, folder.path());
  TrialOptions options;
  options.mode = StudyMode::kTools;
  options.subject = 12;
  options.number = 4;
  const auto recorded = run_linear_trial(setup.machine, options);
  ASSERT_TRUE(recorded) << recorded.message();
  StudyMachine plain = setup.machine;
  plain.recording.folder.clear();
  EXPECT_EQ(recorded->execution_time, run_linear_trial(plain, options)->execution_time);
  EXPECT_THAT(run_linear_trial(setup.machine, options).message(),
              HasSubstr("/linear-movement-V-sim12-4.master.mcap: is there already"));
  expect_replays(folder.path() + "/linear-movement-V-sim12-4",
                 "trial begins: linear-movement V sim12 4 simulated",
                 "trial ends: linear-movement V sim12 4 simulated done");
}

TEST(TrialRecordingTest, AScrewWithoutProtectionIsRecordedAsTheSceneThatItIs) {
  const TempFolder folder;
  const StudySetup setup = setup_of("screw-fastening", {}, folder.path());
  ScrewTrialOptions options;
  options.mode = ScrewMode::kNCV;
  const auto recorded = run_screw_trial(setup.machine, options);
  ASSERT_TRUE(recorded) << recorded.message();
  expect_replays(
      folder.path() + "/screw-fastening-NC-V-sim1-1",
      "trial begins: screw-fastening NC-V sim1 1 simulated",
      std::string("trial ends: screw-fastening NC-V sim1 1 simulated ") + name_of(recorded->end));
}

TEST(TrialRecordingTest, AFileThatCannotBeWrittenIsNamed) {
  const StudySetup setup = setup_of("linear-movement", {}, "/dev/null/nothing");
  const auto recorded = run_linear_trial(setup.machine, {});
  ASSERT_FALSE(recorded);
  EXPECT_THAT(
      recorded.message(),
      HasSubstr("/dev/null/nothing/linear-movement-NV-sim1-1.master.mcap: cannot be written"));
}

}  // namespace
}  // namespace handrail
