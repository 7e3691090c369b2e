// The recorder: what stands in its files, when it makes them, and what becomes of a disk that is
// full.
#include "server/record/recorder.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <new>

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
  options.before = 400 * kMillisecond;
  options.after = 50 * kMillisecond;
  Recorded r(3, "gearshift", options);
  // Three chunks from image to image, of which two begin without one. What is to be kept begins in
  // the middle of one of those.
  for (int i = 0; i < 8; ++i) {
    r.master.tick(true);
    for (int chunk = 0; chunk < 3; ++chunk) {
      r.run(99);
      std::this_thread::sleep_for(std::chrono::milliseconds(60));
    }
  }
  r.master.order(OrderKind::kStop);
  r.run(100);
  ASSERT_TRUE(
      wait_until([&] { return r.files().size() == 1 && r.recorder->state().file.empty(); }));
  const auto result = replay_file(r.files()[0]);
  ASSERT_TRUE(result) << result.message();
  EXPECT_GE(result->entries, 400u) << "what is to be kept";
  // As far back again to an image, and what came of the stop.
  EXPECT_LT(result->entries, 1000u) << "of 2500";
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
  const auto put = [&](const std::string& name) {
    std::ofstream(folder.path() + "/" + name) << std::string(1000, 'x');
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // a time of its own for each
    return folder.path() + "/" + name;
  };
  std::vector<std::string> own;
  for (int i = 0; i < 5; ++i)
    own.push_back(put(recording_name(i * kSecond, "master", i == 2 ? "a-b" : "")));
  const std::string others[] = {put("notes.txt"), put("grasps.mcap"), put("both-master.mcap"),
                                put(recording_name(0, "slave", ""))};
  EXPECT_EQ(prune(folder.path(), "master", 3500, 0, own[0]).size(), 2u);
  for (const int stays : {0, 3, 4})
    EXPECT_TRUE(std::filesystem::exists(own[static_cast<std::size_t>(stays)]));
  for (const int gone : {1, 2})
    EXPECT_FALSE(std::filesystem::exists(own[static_cast<std::size_t>(gone)]));
  EXPECT_EQ(prune(folder.path(), "master", 1u << 30, kForever, "").size(), 3u) << "all are too old";
  for (const std::string& other : others) EXPECT_TRUE(std::filesystem::exists(other)) << other;
}

TEST(Recorder, OneThatIsAskedForComesAfterOneThatAStopBegan) {
  Recorded r(9);
  r.run(300);
  r.master.order(OrderKind::kStop);
  r.run(100);
  ASSERT_TRUE(wait_until([&] { return !r.recorder->state().file.empty(); }));
  EXPECT_FALSE(r.recorder->asked());
  r.recorder->start("mine");
  ASSERT_TRUE(wait_until([&] { return r.recorder->asked(); }));
  EXPECT_NE(r.recorder->state().file.find("-mine"), std::string::npos);
  r.run(300);
  r.recorder->stop();
  ASSERT_TRUE(wait_until([&] { return r.recorder->state().file.empty(); }));
  ASSERT_EQ(r.files().size(), 2u);
  for (const std::string& file : r.files()) {
    const auto result = replay_file(file);
    ASSERT_TRUE(result) << result.message();
    EXPECT_EQ(result->damage, "");
    EXPECT_EQ(result->different, 0u);
  }
}

// Has no memory, as long as it is told so.
class PoorFeed final : public RecordFeed {
 public:
  PoorFeed(std::unique_ptr<RecordFeed> feed, const std::atomic<bool>& poor)
      : feed_(std::move(feed)), poor_(poor) {}
  void pull(RecordSink& sink) override {
    feed_->pull(sink);
    if (poor_) throw std::bad_alloc();
  }
  const char* side() const override { return feed_->side(); }
  std::uint64_t lost() const override { return feed_->lost(); }

 private:
  std::unique_ptr<RecordFeed> feed_;
  const std::atomic<bool>& poor_;
};

TEST(Recorder, WithoutMemoryTheProgramGoesOnAndTheRecordingHasAGap) {
  TempFolder folder;
  DrivenMaster master(10);
  std::atomic<bool> poor = false;
  std::atomic<int> said = 0;
  RecorderOptions options = to_folder(folder.path());
  options.say = [&](bool bad, const std::string&) { said += bad ? 1 : 0; };
  Recorder recorder(options, std::make_unique<PoorFeed>(make_feed(master.tap()), poor),
                    master.start());
  recorder.scene(master.scenes().front());
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) master.tick(i == 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
  };
  recorder.start("");
  run(300);
  poor = true;
  run(300);
  poor = false;
  run(300);
  recorder.stop();
  ASSERT_TRUE(wait_until([&] { return recorder.state().file.empty(); }));
  const auto files = recordings_in(folder.path());
  ASSERT_EQ(files.size(), 1u);
  const auto result = replay_file(files[0].file);
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->missing, 300u);
  EXPECT_EQ(result->replayed, 600u);
  EXPECT_EQ(result->different, 0u);
  EXPECT_EQ(said, 1) << "once, however often";
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

TEST(Recorder, ADiskThatIsFullFromTheBeginningIsLeftWithoutAFile) {
  Recorded r(8);
  r.run(100);
  {
    const LongestFile full(1000);
    r.recorder->start("");
    ASSERT_TRUE(wait_until([&] { return !r.recorder->state().problem.empty(); }));
    EXPECT_EQ(r.recorder->state().file, "");
    EXPECT_FALSE(r.recorder->asked());
  }
  EXPECT_TRUE(r.files().empty()) << r.files()[0];
}

TEST(Recorder, AFileThatIsRemovedGoesOnInAnother) {
  Recorded r(3);
  r.run(300);
  r.recorder->start("trial");
  ASSERT_TRUE(wait_until([&] { return !r.files().empty(); }));
  r.run(300);
  const std::string first = r.files()[0];
  std::filesystem::remove_all(r.folder.path());
  ASSERT_TRUE(wait_until([&] { return !r.files().empty(); }));
  EXPECT_NE(r.files()[0], first);
  EXPECT_NE(r.files()[0].find("-master-trial.mcap"), std::string::npos);
  EXPECT_TRUE(r.recorder->asked());
  r.run(300);
  EXPECT_TRUE(r.recorder->end(20 * kSecond));
  const auto result = replay_file(r.files()[0]);
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->damage, "");
  EXPECT_GE(result->entries, 300u);
  EXPECT_EQ(result->different, 0u);
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
