// A disk that takes its time, for ever if need be, while the arm is to be stopped.
#include <gmock/gmock.h>

#include <optional>
#include <string>

#include "tests/loopback/whole_cell.h"
#include "tests/support/held_file.h"

namespace handrail {
namespace {

using test::HeldFile;
using ::testing::HasSubstr;

class SlowDisk : public WholeCell {
 protected:
  SlowDisk() { slave_extra = "scene_path: '" + folder.path() + "'"; }

  Program load(const std::string& scene) {
    return Program(folder, "handrail", {"scene", "load", scene, "--socket", socket()});
  }
  // The link stays good, and a stop acts at once, for a while.
  void all_goes_on() {
    const Nanos start = monotonic_now();
    while (monotonic_now() - start < 500 * kMillisecond) {
      const pb::Status now = status();
      ASSERT_LT(now.packet_age_ms(), 20.0);
      ASSERT_NE(now.state(), "fault");
      ASSERT_NE(now.slave_state(), "fault");
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    const Nanos asked = monotonic_now();
    EXPECT_THAT(ask("stop: true").reason(), HasSubstr("the slave has it"));
    EXPECT_LT(monotonic_now() - asked, 100 * kMillisecond);
    order("reset: true");
  }
};

TEST_F(SlowDisk, ASceneIsWaitedForByNobodyElse) {
  HeldFile file(folder.write("slow.scene", "name: 'slow'\n"));
  if (!file.works()) GTEST_SKIP() << "no file can be held here";
  Program loads = load("slow");
  ASSERT_EQ(file.holds(kPatience), master->pid());
  EXPECT_THAT(refusal("scene_load: 'slow'"), HasSubstr("scene 'slow' is still being read"));
  file.let_go();
  ASSERT_EQ(file.holds(kPatience), slave->pid());
  all_goes_on();
  file.let_go();
  EXPECT_EQ(loads.finish(), 0) << loads.output();
  EXPECT_EQ(status().scene(), "slow");
  order("engage: true");
}

TEST_F(SlowDisk, WhoWaitsTooLongIsToldSoAndTheSceneIsNotLoadedLater) {
  std::optional<HeldFile> file(std::in_place, folder.write("slow.scene", "name: 'slow'\n"));
  if (!file->works()) GTEST_SKIP() << "no file can be held here";
  Program loads = load("slow");
  ASSERT_EQ(file->holds(kPatience), master->pid());
  all_goes_on();
  EXPECT_EQ(loads.finish(), 1);
  EXPECT_THAT(loads.output(), HasSubstr("scene 'slow' is not loaded: the disk has not given it"));
  order("engage: true");
  ASSERT_TRUE(slave_reaches("engaged"));
  order("disengage: true");
  ASSERT_TRUE(slave_reaches("off"));
  ASSERT_TRUE(reaches("off"));
  file.reset();
  all_goes_on();
  EXPECT_EQ(status().scene(), "linear-movement");
  EXPECT_EQ(handrail({"scene", "load", "slow"}).first, 0) << "the disk is quick again";
}

TEST_F(SlowDisk, NorDoProgramsWaitForItWhenTheyEnd) {
  HeldFile file(folder.write("slow.scene", "name: 'slow'\n"));
  if (!file.works()) GTEST_SKIP() << "no file can be held here";
  Program loads = load("slow");
  ASSERT_EQ(file.holds(kPatience), master->pid());
  const Nanos start = monotonic_now();
  master->send(SIGTERM);
  EXPECT_EQ(master->finish(), 0);
  EXPECT_LT(monotonic_now() - start, 5 * kSecond) << "for good, if it waited";
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// One of a recording, which nobody can read from any more either: the rest of it is given up.
TEST_F(SlowDisk, NorForADeadOneThatHasARecording) {
  master->send(SIGTERM);
  ASSERT_EQ(master->finish(), 0);
  const std::string disk = folder.write("disk", "good");
  const std::string poor = "LD_PRELOAD=" POOR_DISK;
  const std::string program = HANDRAIL_BIN_DIR "/handrail-master";
  master_extra = "recording {}";
  master = std::make_unique<Program>(
      folder, "/usr/bin/env",
      std::vector<std::string>{"POOR_DISK=" + disk, poor, program, "--config",
                               folder.write("recording.cfg", master_config())});
  (void)master->after("READY link=");
  client.close();
  order("record { on: true }");
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.recording().mb() > 0.01; }));
  folder.write("disk", "dead");
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.recording().has_problem(); }));
  EXPECT_THAT(status().recording().problem(), HasSubstr("the disk takes"));
  all_goes_on();
  const Nanos start = monotonic_now();
  master->send(SIGTERM);
  EXPECT_EQ(master->finish(), 1);
  EXPECT_LT(monotonic_now() - start, 15 * kSecond) << "for good, if it waited";
  EXPECT_THAT(master->output(), HasSubstr("the recording's end is not written"));
}
#endif

}  // namespace
}  // namespace handrail
