// The recorder: what stands in its files, when it makes them, and what becomes of a disk that is
// full.
#include "server/record/recorder.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "server/record/record_folder.h"
#include "tests/support/no_allocation.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/record/driven.h"

namespace handrail {
namespace {

using test::DrivenMaster;
using test::replay_file;
using test::to_folder;
using test::wait_until;

// A recorder at a driven master.
struct Recorded {
  explicit Recorded(std::uint64_t seed, const std::string& scene = "linear-movement")
      : Recorded(seed, scene, {}) {}
  Recorded(std::uint64_t seed, const std::string& scene, RecorderOptions options)
      : master(seed, scene) {
    if (options.folder.empty()) options.folder = folder.path();
    recorder = std::make_unique<Recorder>(options, make_feed(master.tap()), master.start());
    recorder->scene(master.scenes().front());
  }
  // So many ticks, no faster than the recorder takes them.
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      master.tick();
      if (i % 200 == 199) std::this_thread::sleep_for(std::chrono::milliseconds(25));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
  }
  std::vector<std::string> files() const {
    std::vector<std::string> out;
    for (const auto& entry : recordings_in(folder.path())) out.push_back(entry.file);
    return out;
  }
  TempFolder folder;
  DrivenMaster master;
  std::unique_ptr<Recorder> recorder;
};

TEST(Recorder, WhatIsAskedForReplaysToTheBit) {
  Recorded r(1);
  r.run(300);
  r.recorder->start("trial");
  ASSERT_TRUE(wait_until([&] { return !r.recorder->state().file.empty(); }));
  EXPECT_TRUE(wait_until([&] { return r.recorder->asked(); }));
  r.run(1500);
  r.recorder->mark("done", "ada");
  r.recorder->stop();
  ASSERT_TRUE(wait_until([&] { return r.recorder->state().file.empty(); }));
  ASSERT_EQ(r.files().size(), 1u);
  EXPECT_NE(r.files()[0].find("-master-trial.mcap"), std::string::npos);
  const auto result = replay_file(r.files()[0]);
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->damage, "");
  EXPECT_GE(result->entries, 1500u);
  EXPECT_EQ(result->replayed, result->entries);
  EXPECT_EQ(result->different, 0u) << result->first->field;
  ASSERT_EQ(result->happened.size(), 1u);
  EXPECT_EQ(result->happened[0].text, "done");
  EXPECT_EQ(result->lost, 0u);
}

TEST(Recorder, AStopKeepsWhatLedToIt) {
  RecorderOptions options;
  options.before = 2 * kSecond;
  options.after = 100 * kMillisecond;
  Recorded r(2, "linear-movement", options);
  r.run(600);
  EXPECT_TRUE(r.files().empty()) << "nothing has happened";
  r.master.order(OrderKind::kStop);
  r.run(200);
  ASSERT_TRUE(
      wait_until([&] { return r.files().size() == 1 && r.recorder->state().file.empty(); }));
  const auto result = replay_file(r.files()[0]);
  ASSERT_TRUE(result) << result.message();
  EXPECT_GE(result->entries, 600u) << "from the beginning on: it is less than two seconds ago";
  EXPECT_EQ(result->different, 0u);
  ASSERT_FALSE(result->happened.empty());
  EXPECT_EQ(result->happened.back().text, "a stop was latched");
  EXPECT_NE(r.files()[0].find("-master-stop.mcap"), std::string::npos);
}

TEST(Recorder, ARingThatHasTurnedOverBeginsAtAnImage) {
  RecorderOptions options;
  options.before = 500 * kMillisecond;
  options.after = 50 * kMillisecond;
  Recorded r(3, "gearshift", options);
  for (int i = 0; i < 12; ++i) {
    r.master.tick(true);
    for (int chunk = 0; chunk < 3; ++chunk) r.run(99);
  }
  r.master.order(OrderKind::kStop);
  r.run(100);
  ASSERT_TRUE(
      wait_until([&] { return r.files().size() == 1 && r.recorder->state().file.empty(); }));
  const auto result = replay_file(r.files()[0]);
  ASSERT_TRUE(result) << result.message();
  EXPECT_GE(result->entries, 500u) << "what is to be kept";
  EXPECT_LT(result->entries, 1500u) << "of 3700";
  EXPECT_EQ(result->replayed, result->entries) << "its first tick has an image";
  EXPECT_EQ(result->different, 0u) << result->first->field;
}

TEST(Recorder, ScenesThatChangeGoAlong) {
  for (const char* first : {"gearshift", "wrench", "linear-movement"}) {
    SCOPED_TRACE(first);
    Recorded r(4, first);
    r.recorder->start("");
    r.run(400);
    for (const char* next : {"painted-aisle", "gearshift", "linear-movement"}) {
      r.recorder->scene(r.master.change(next));
      r.run(400);
    }
    r.recorder->stop();
    ASSERT_TRUE(
        wait_until([&] { return r.files().size() == 1 && r.recorder->state().file.empty(); }));
    const auto result = replay_file(r.files()[0]);
    ASSERT_TRUE(result) << result.message();
    EXPECT_GE(result->entries, 1600u);
    EXPECT_EQ(result->replayed, result->entries);
    EXPECT_EQ(result->different, 0u) << result->first->field;
  }
}

TEST(Recorder, WhatItHasNoRoomForIsCountedAndTheRestReplays) {
  Recorded r(5);
  r.recorder->start("");
  ASSERT_TRUE(wait_until([&] { return !r.recorder->state().file.empty(); }));
  for (int i = 0; i < 20'000; ++i) r.master.tick();  // far faster than a thousand a second
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // until it has caught up
  r.run(500);
  r.recorder->stop();
  ASSERT_TRUE(wait_until([&] { return r.recorder->state().file.empty(); }));
  ASSERT_GT(r.recorder->state().lost, 0u);
  const auto result = replay_file(r.files()[0]);
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->lost, r.recorder->state().lost);
  EXPECT_EQ(result->entries + result->lost, 20'500u);
  EXPECT_GT(result->replayed, 400u);
  EXPECT_EQ(result->different, 0u) << result->first->field;
}

TEST(Recorder, ATickAllocatesNothing) {
  DrivenMaster master(6);
  master.tick();
  const test::NoAllocation guard("a tick that is kept");
  for (int i = 0; i < 2000; ++i) master.tick(i % 100 == 0);
}

TEST(Recorder, OldRecordingsGoAndTheOneThatIsWrittenStays) {
  TempFolder folder;
  for (int i = 0; i < 5; ++i) {
    std::ofstream(folder.path() + "/" + std::to_string(i) + ".mcap") << std::string(1000, 'x');
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  std::ofstream(folder.path() + "/notes.txt") << std::string(5000, 'x');
  const std::string oldest = folder.path() + "/0.mcap";
  EXPECT_EQ(prune(folder.path(), 3500, 0, oldest).size(), 2u);
  const auto left = recordings_in(folder.path());
  ASSERT_EQ(left.size(), 3u);
  EXPECT_EQ(left[0].file, oldest);
  EXPECT_EQ(left[1].file, folder.path() + "/3.mcap");
  EXPECT_EQ(prune(folder.path(), 1u << 30, kForever, "").size(), 3u) << "all are too old";
}

// What a disk is like that takes no more: the system refuses to make a file longer.
class LongestFile {
 public:
  explicit LongestFile(rlim_t bytes) {
    before_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit now{bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &now);
  }
  ~LongestFile() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, before_);
  }

 private:
  rlimit old_{};
  void (*before_)(int);
};

TEST(Recorder, AFullDiskLeavesWhatWasWrittenAndMarksTheGap) {
  Recorded r(7);
  r.recorder->start("");
  ASSERT_TRUE(wait_until([&] { return !r.recorder->state().file.empty(); }));
  r.run(600);
  {
    const LongestFile full(static_cast<rlim_t>(r.recorder->state().bytes + 1000));
    r.run(600);
    EXPECT_NE(r.recorder->state().problem.find("cannot be written"), std::string::npos);
    EXPECT_FALSE(r.recorder->state().file.empty()) << "it goes on when there is room";
    std::ifstream in(r.files()[0], std::ios::binary);
    const auto so_far = replay(in, {});
    ASSERT_TRUE(so_far) << so_far.message();
    EXPECT_GE(so_far->entries, 500u);
    EXPECT_EQ(so_far->different, 0u);
    EXPECT_NE(so_far->damage.find("the file has no end"), std::string::npos) << so_far->damage;
  }
  r.run(300);
  EXPECT_EQ(r.recorder->state().problem, "");
  r.recorder->stop();
  ASSERT_TRUE(wait_until([&] { return r.recorder->state().file.empty(); }));
  const auto result = replay_file(r.files()[0]);
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->damage, "");
  EXPECT_EQ(result->different, 0u) << result->first->field;
  EXPECT_LT(result->entries, 1400u);
  const bool marked = std::any_of(
      result->happened.begin(), result->happened.end(),
      [](const auto& e) { return e.text.find("cannot be written") != std::string::npos; });
  EXPECT_TRUE(marked);
}

TEST(Recorder, AFolderThatCannotBeMadeIsSaid) {
  TempFolder folder;
  std::ofstream(folder.path() + "/file") << "x";
  Recorded r(8, "linear-movement", to_folder(folder.path() + "/file/rec"));
  r.recorder->start("");
  ASSERT_TRUE(wait_until([&] { return !r.recorder->state().problem.empty(); }));
  EXPECT_NE(r.recorder->state().problem.find("cannot be made: Not a directory"), std::string::npos)
      << r.recorder->state().problem;
}

TEST(Recorder, NamesAndLabels) {
  EXPECT_EQ(recording_name(1'764'293'301'345'000'000, "master", ""),
            "20251128T012821.345Z-master.mcap");
  EXPECT_EQ(recording_name(0, "slave", "x"), "19700101T000000.000Z-slave-x.mcap");
  EXPECT_TRUE(is_record_label("a-B_9"));
  for (const char* bad : {"", "a/b", "..", "a b", "12345678901234567890123456789012345678901"}) {
    EXPECT_FALSE(is_record_label(bad)) << bad;
  }
}

}  // namespace
}  // namespace handrail
