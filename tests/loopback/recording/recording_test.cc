// Recordings of the real programs: both sides write, what is written replays to the bit, and a
// program that is killed or paused leaves a recording that can be read.
#include <gmock/gmock.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "server/base/random.h"
#include "server/lab/replay/replay.h"
#include "server/record/record_folder.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class RecordingTest : public WholeCell {
 protected:
  void SetUp() override {
    const std::string to = " recording { folder: '" + recordings() + "' }";
    slave_extra = to;
    master_extra = to;
    WholeCell::SetUp();
  }
  std::string recordings() const { return folder.path() + "/recordings"; }
  std::vector<std::string> files(const std::string& part) const {
    std::vector<std::string> out;
    for (const auto& entry : recordings_in(recordings())) {
      if (entry.file.find(part) != std::string::npos) out.push_back(entry.file);
    }
    return out;
  }
  bool writes() { return !status().recording().file().empty(); }
  // Until nobody writes any more: a file has its end then.
  void all_ended(const std::string& part, std::size_t count) {
    EXPECT_TRUE(within(kPatience, [&] {
      const auto found = files(part);
      return found.size() == count &&
             std::all_of(found.begin(), found.end(), [](const std::string& file) {
               std::ifstream in(file, std::ios::binary);
               const auto result = replay(in, {});
               return result && result->damage.empty();
             });
    })) << part;
  }
  // The whole recording again, without a difference.
  ReplayResult replays(const std::string& file, bool whole = true) {
    std::ifstream in(file, std::ios::binary);
    const auto result = replay(in, {});
    EXPECT_TRUE(result) << file << ": " << result.message();
    if (!result) return {};
    EXPECT_EQ(result->damage.empty(), whole) << result->damage;
    EXPECT_EQ(result->different, 0u)
        << file << ": " << result->first->number << ": " << result->first->field;
    EXPECT_EQ(result->replayed, result->entries);
    EXPECT_EQ(result->missing, 0u);
    EXPECT_TRUE(result->same_build);
    return *result;
  }
};

TEST_F(RecordingTest, WhatBothSidesDidReplaysToTheBit) {
  order("record { on: true label: 'trial' }");
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.recording().has_file(); }));
  EXPECT_THAT(refusal("record { on: true }"), HasSubstr("end that recording first"));
  order("engage: true");
  order("tool { kind: LINE direction: [0, 1, 0] }");
  order("hand { displacement_mm: [-8, 6, 4] rotation_deg: [5, 10, 0] duration_s: 1 }");
  (void)at_rest();
  order("mark: 'half way'");
  order("tool_off {}");
  order("clutch: true");
  order("clutch: false");
  order("disengage: true");
  order("scene_load: 'gearshift'");
  order("hand { displacement_mm: [5, 20, 0] duration_s: 1 }");
  sleep_until(monotonic_now() + kSecond);
  order("scene_load: 'linear-movement'");
  order("engage: true");
  order("stop: true");
  order("record { on: false }");
  all_ended("-master-trial", 1);
  all_ended("-slave", 1);
  const ReplayResult master_did = replays(files("-master-trial")[0]);
  EXPECT_GT(master_did.was.engaged, 0.5);
  EXPECT_GT(master_did.was.way, 5e-3);
  std::string all;
  for (const auto& event : master_did.happened) all += event.text + ";";
  EXPECT_THAT(all, HasSubstr("half way"));
  EXPECT_THAT(all, HasSubstr("a stop was latched"));
  const ReplayResult slave_did = replays(files("-slave")[0]);
  EXPECT_GT(slave_did.entries, 300u);
  EXPECT_EQ(slave_did.program, "handrail-slave");
}

TEST_F(RecordingTest, AStopLeavesWhatLedToItOnBothSides) {
  order("engage: true");
  sleep_until(monotonic_now() + kSecond);
  EXPECT_TRUE(files("").empty());
  order("stop: true");
  all_ended("-master-stop", 1);
  all_ended("-slave-stop", 1);
  EXPECT_GT(replays(files("-master-stop")[0]).seconds, 2.0);
  EXPECT_GT(replays(files("-slave-stop")[0]).seconds, 2.0);
}

TEST_F(RecordingTest, PausesAreReplayedToo) {
  order("record { on: true }");
  order("engage: true");
  order("hand { displacement_mm: [-20, 6, 4] duration_s: 3 }");
  for (Program* program : {master.get(), slave.get(), rig.get(), master.get()}) {
    sleep_until(monotonic_now() + 300 * kMillisecond);
    ::kill(program->pid(), SIGSTOP);
    sleep_until(monotonic_now() + 150 * kMillisecond);
    ::kill(program->pid(), SIGCONT);
  }
  sleep_until(monotonic_now() + 300 * kMillisecond);
  order("record { on: false }");
  all_ended("", files("").size());
  EXPECT_GE(files("").size(), 2u);
  for (const std::string& file : files("")) (void)replays(file);
}

TEST_F(RecordingTest, ASlaveDoesNotRecordForAMasterThatIsGone) {
  order("record { on: true }");
  ASSERT_TRUE(within(kPatience, [&] { return files("-slave").size() == 1; }));
  ::kill(master->pid(), SIGKILL);
  client.close();
  EXPECT_TRUE(within(20 * kSecond, [&] {
    std::ifstream in(files("-slave")[0], std::ios::binary);
    const auto result = replay(in, {});
    return result && result->damage.empty();
  }));
  EXPECT_LT(replays(files("-slave")[0]).seconds, 25.0);
}

TEST_F(RecordingTest, AKilledMasterLeavesAllButTheLastTenthOfASecond) {
  Random random(static_cast<std::uint64_t>(monotonic_now()));
  for (int i = 0; i < 5; ++i) {
    order("record { on: true }");
    ASSERT_TRUE(eventually([](const pb::Status& s) { return s.recording().has_file(); }));
    // The slave is in fault where the one before was engaged. Whether this one is does not matter.
    (void)ask("reset: true");
    (void)ask("engage: true");
    sleep_until(monotonic_now() + static_cast<Nanos>(random.uniform() * 1e9));
    const Nanos killed = monotonic_now();
    ::kill(master->pid(), SIGKILL);
    const std::string newest = files("-master").back();
    const ReplayResult did = replays(newest, false);
    const Nanos last = did.begun + static_cast<Nanos>(did.seconds * 1e9);
    EXPECT_LT(to_seconds(killed - last), 0.1 + 0.3) << "0.3 s for a machine that is busy";
    EXPECT_THAT(did.damage, HasSubstr("byte"));
    master.reset();
    client.close();
    start_master();
    ASSERT_TRUE(eventually([](const pb::Status& s) { return s.has_tip(); }));
  }
}

// Of the real programs, once: a line, a move, a mark and a stop, from the programs' start on.
// Whoever means to change what the steps do makes them anew: `handrail record` in RECORDINGS.md,
// ended by a stop within the first half minute.
TEST(GoldenRecording, DoneAgainTheyAreAsTheyWere) {
  for (const char* side : {"master", "slave"}) {
    std::ifstream in(
        std::string(HANDRAIL_SOURCE_DIR) + "/tests/loopback/recording/golden/" + side + ".mcap",
        std::ios::binary);
    ReplayOptions options;
    options.exact = false;  // this processor may be of another kind
    const auto result = replay(in, options);
    ASSERT_TRUE(result) << side << ": " << result.message();
    EXPECT_EQ(result->damage, "");
    EXPECT_GT(result->entries, 300u);
    EXPECT_EQ(result->replayed, result->entries);
    EXPECT_EQ(result->different, 0u)
        << side << " " << result->first->number << ": " << result->first->field;
    EXPECT_EQ(result->happened.back().text,
              side == std::string("master") ? "half" : "a stop was latched");
  }
}

}  // namespace
}  // namespace handrail
