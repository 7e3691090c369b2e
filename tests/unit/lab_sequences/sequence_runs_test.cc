// Many sequences: on any number of threads, interrupted, and from a file.
#include "server/lab/sequences/sequence_runs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <limits>

#include "server/base/output.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class SequenceRuns : public ::testing::Test {
 protected:
  SequenceRuns() { std::filesystem::remove(path); }
  ~SequenceRuns() override { std::filesystem::remove(path); }

  SequenceRun run_to(std::uint64_t of, int threads, SequenceRun run = {.first = 90}) {
    const auto done =
        run_sequences(run, of, threads, cancelled, [](const SequenceRun&) { return Status::ok(); });
    EXPECT_TRUE(done && done.value());
    return run;
  }
  std::atomic<bool> cancelled = false;
  std::string path = ::testing::TempDir() + "handrail_sequence_runs.txt";
};

TEST_F(SequenceRuns, AreTheSameOnAnyNumberOfThreads) {
  const SequenceRun one = run_to(60, 1);
  EXPECT_EQ(one.figures.sequences, 60u);
  EXPECT_EQ(sequence_json(run_to(60, 3)), sequence_json(one));
}

TEST_F(SequenceRuns, GoOnFromAFileAsIfTheyHadNeverStopped) {
  const SequenceRun whole = run_to(60, 2);
  ASSERT_TRUE(save_run(path, "program 1", run_to(25, 2)));
  const auto part = load_run(path, "program 1");
  ASSERT_TRUE(part) << part.message();
  EXPECT_EQ(part->figures.sequences, 25u);
  EXPECT_EQ(sequence_json(run_to(60, 2, *part)), sequence_json(whole));
}

TEST_F(SequenceRuns, ACancelledRoundIsDroppedWhole) {
  SequenceRun run{.first = 90};
  int rounds = 0;
  const auto done = run_sequences(run, 1'000'000, 2, cancelled, [&](const SequenceRun&) {
    cancelled = ++rounds == 1;
    return Status::ok();
  });
  ASSERT_TRUE(done);
  EXPECT_FALSE(done.value());
  EXPECT_EQ(run.figures.sequences, run.figures.ticks / kSequenceTicks);
  EXPECT_EQ(rounds, 1);
}

TEST_F(SequenceRuns, WhatCannotBeSavedEndsTheRun) {
  SequenceRun run{.first = 90};
  const auto done = run_sequences(run, 10, 1, cancelled,
                                  [](const SequenceRun&) { return Status::error("disk full"); });
  EXPECT_EQ(done.message(), "disk full");
}

TEST_F(SequenceRuns, AFileOfAnotherProgramOrOfNoneIsRefusedByName) {
  ASSERT_TRUE(save_run(path, "program 1", run_to(5, 1)));
  EXPECT_THAT(
      load_run(path, "program 2").message(),
      HasSubstr(path + ":1: 'handrail-lab tool-sequences, results of program 1'; expected"));
  ASSERT_TRUE(write_file(path, "something else\n"));
  EXPECT_THAT(load_run(path, "program 2").message(), HasSubstr("no results of"));
}

TEST_F(SequenceRuns, AFileThatIsCutOrHasMoreIsRefused) {
  ASSERT_TRUE(save_run(path, "p", run_to(5, 1)));
  std::string text;
  {
    std::FILE* file = std::fopen(path.c_str(), "r");
    ASSERT_NE(file, nullptr);
    char buffer[8192];
    text.assign(buffer, std::fread(buffer, 1, sizeof buffer, file));
    std::fclose(file);
  }
  ASSERT_TRUE(load_run(path, "p"));
  ASSERT_TRUE(write_file(path, text + "7\n"));
  EXPECT_THAT(load_run(path, "p").message(), HasSubstr("not whole"));
  for (const std::size_t length : {text.size() - 8, text.size() / 2, std::size_t{60}}) {
    ASSERT_TRUE(write_file(path, text.substr(0, length)));
    EXPECT_FALSE(load_run(path, "p")) << length;
  }
}

TEST_F(SequenceRuns, ABoundThatIsBrokenWithoutMeasureIsKeptInTheFileAndPrinted) {
  SequenceRun run = run_to(5, 1);
  Worst& worst = run.figures.worst[static_cast<std::size_t>(Bound::kFinite)];
  worst = {{std::numeric_limits<double>::infinity(), 2.0, 0.0}, 92, 17};
  run.figures.broken[static_cast<std::size_t>(Bound::kFinite)] = 3;
  EXPECT_FALSE(run.figures.holds());
  ASSERT_TRUE(save_run(path, "p", run));
  const auto read = load_run(path, "p");
  ASSERT_TRUE(read) << read.message();
  EXPECT_FALSE(read->figures.holds());
  EXPECT_THAT(sequence_json(*read), HasSubstr("\"ratio\": null, \"measured\": 2, \"allowed\": 0, "
                                              "\"seed\": 92, \"tick\": 17, \"broken\": 3"));
  EXPECT_THAT(sequence_table(*read), HasSubstr("5 sequences of 1000 ticks from seed 90 on"));
}

}  // namespace
}  // namespace handrail
