// Rows at several seeds: what is run, what is kept, and where a run that ended goes on.
#include "server/lab/faults/fault_runner.h"

#include <gmock/gmock.h>

#include <atomic>
#include <set>

#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::atomic<bool> kRunnerGoOn = false;
std::atomic<int> calls = 0;
std::atomic<bool> stop = false;
double share_seen = 0.0;

// Fails in run 1 of every seed for which the run's own seed is odd there.
FaultOutcome odd_seeds_fail(const RowRun& row) {
  ++calls;
  FaultOutcome out;
  measure(out, static_cast<double>(row.seed % 7), 5.0);
  find(out, row.index == 1 && row.seed / 1000 % 2 == 1 ? 2 : 0, "oddities");
  return out;
}
FaultOutcome stops_in_its_third(const RowRun&) {
  if (++calls == 3) stop = true;
  return {};
}
FaultOutcome shows_its_share(const RowRun& row) {
  ++calls;
  share_seen = row.share;
  return {};
}

class FaultRunnerTest : public ::testing::Test {
 protected:
  FaultRunnerTest() {
    calls = 0;
    stop = false;
  }
  const std::vector<FaultRow> rows{{"T1", "a test", "ms", 3, 2, odd_seeds_fail}};
  TempFolder folder;
  std::string path = folder.path() + "/runs.txt";
};

TEST_F(FaultRunnerTest, ARowIsJudgedOverAllSeedsAndNamesThoseThatAreRed) {
  const auto results = run_faults({rows, {1, 2, 3, 4}, false, 2}, kRunnerGoOn).value();
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results[0].runs, 12);
  EXPECT_EQ(calls, 12);
  EXPECT_EQ(results[0].violations, 4u);
  ASSERT_EQ(results[0].red_seeds.size(), 2u);
  EXPECT_EQ(results[0].red_seeds[1], results[0].red_seeds[0] + 2);
  EXPECT_EQ(results[0].shown_seed, results[0].red_seeds[0]);
  EXPECT_EQ(results[0].shown_index, 1);
  const std::string table = fault_table(results);
  EXPECT_THAT(table, HasSubstr("seed " + std::to_string(results[0].red_seeds[0]) +
                               ", run 1: 2 x oddities"));
  // The same seed alone is red, and its neighbour is not.
  const auto red = run_faults({rows, {results[0].red_seeds[0]}, false, 1}, kRunnerGoOn).value();
  EXPECT_EQ(red[0].violations, 2u);
  const auto green =
      run_faults({rows, {results[0].red_seeds[0] + 1}, false, 1}, kRunnerGoOn).value();
  EXPECT_EQ(green[0].violations, 0u);
}

TEST_F(FaultRunnerTest, ManyRedSeedsAreNamedUpToEight) {
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t i = 1; i <= 24; ++i) seeds.push_back(i);
  const auto results = run_faults({rows, seeds, false, 1}, kRunnerGoOn).value();
  ASSERT_EQ(results[0].red_seeds.size(), 12u);
  EXPECT_THAT(fault_table(results), HasSubstr(" and 4 more\n"));
}

TEST_F(FaultRunnerTest, TheQuickFormHasFewerRunsAndShorterSpans) {
  const std::vector<FaultRow> shares{{"T1", "a test", "ms", 3, 2, shows_its_share}};
  EXPECT_EQ(run_faults({shares, {1}, true, 1}, kRunnerGoOn).value()[0].runs, 2);
  EXPECT_EQ(share_seen, kQuickShare);
  EXPECT_EQ(run_faults({shares, {1}, false, 1}, kRunnerGoOn).value()[0].runs, 3);
  EXPECT_EQ(share_seen, 1.0);
  RowRun quick;
  quick.share = kQuickShare;
  EXPECT_EQ(quick.span(3600 * kSecond), 180 * kSecond);
}

TEST_F(FaultRunnerTest, WhatTheJournalKnowsIsNotRunAgainAndCountsTheSame) {
  const auto whole = run_faults({rows, {1, 2, 3}, false, 1}, kRunnerGoOn).value();
  calls = 0;
  auto journal = FaultJournal::open(path, "A");
  ASSERT_TRUE(journal.is_ok());
  run_faults({rows, {2}, false, 1}, kRunnerGoOn, &*journal).value();
  EXPECT_EQ(calls, 3);
  const auto rest = run_faults({rows, {1, 2, 3}, false, 2}, kRunnerGoOn, &*journal).value();
  EXPECT_EQ(calls, 9);
  EXPECT_EQ(fault_json(rest), fault_json(whole));
  EXPECT_EQ(fault_table(rest), fault_table(whole));
  run_faults({rows, {1, 2, 3}, false, 2}, kRunnerGoOn, &*journal).value();
  EXPECT_EQ(calls, 9);
}

TEST_F(FaultRunnerTest, ACancelledRunKeepsWhatItHasAndGoesOnThere) {
  const std::vector<FaultRow> stops{{"T1", "a test", "ms", 5, 5, stops_in_its_third}};
  {
    auto journal = FaultJournal::open(path, "A");
    const auto some = run_faults({stops, {1}, false, 1}, stop, &*journal).value();
    EXPECT_EQ(some[0].runs, 3);
  }
  auto journal = FaultJournal::open(path, "A");
  const auto all = run_faults({stops, {1}, false, 1}, kRunnerGoOn, &*journal).value();
  EXPECT_EQ(all[0].runs, 5);
  EXPECT_EQ(calls, 5);
}

TEST_F(FaultRunnerTest, ProgressTellsEveryRunAndWhenASeedIsDone) {
  std::vector<std::size_t> runs;
  std::vector<std::uint64_t> done;
  std::uint64_t violations = 0;
  run_faults({rows, {5, 9}, false, 2}, kRunnerGoOn, nullptr, [&](const FaultProgress& now) {
    runs.push_back(now.runs);
    EXPECT_EQ(now.of, 6u);
    if (now.seed_done != nullptr) done.push_back(*now.seed_done);
    if (now.seed_done != nullptr) violations += now.of_seed;
    EXPECT_GE(now.violations, violations);
  }).value();
  EXPECT_THAT(runs, ElementsAre(0u, 1u, 2u, 3u, 4u, 5u, 6u));
  EXPECT_EQ(std::set<std::uint64_t>(done.begin(), done.end()), (std::set<std::uint64_t>{5, 9}));
}

}  // namespace
}  // namespace handrail
