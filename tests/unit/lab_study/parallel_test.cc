#include "server/lab/study/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace handrail {
namespace {

TEST(RunParallel, RunsEveryJobOnceOnAnyNumberOfThreads) {
  for (const int threads : {0, 1, 2, 7}) {
    std::vector<int> runs(100, 0);
    std::vector<std::size_t> reported;
    EXPECT_TRUE(run_parallel(
        runs.size(), threads, [&](std::size_t i) { ++runs[i]; },
        [&](std::size_t done) { reported.push_back(done); }));
    EXPECT_EQ(runs, std::vector<int>(100, 1)) << threads;
    ASSERT_EQ(reported.size(), 100u);
    for (std::size_t i = 0; i < reported.size(); ++i) EXPECT_EQ(reported[i], i + 1);
  }
}

TEST(RunParallel, HasNothingToDoForNoJobs) {
  EXPECT_TRUE(run_parallel(0, 4, [](std::size_t) { FAIL(); }));
}

TEST(RunParallel, StartsNoMoreOnceCancelled) {
  std::atomic<bool> cancelled = false;
  std::atomic<int> runs = 0;
  EXPECT_FALSE(run_parallel(
      1000, 2,
      [&](std::size_t) {
        const int mine = ++runs;
        if (mine == 3) cancelled = true;
        while (mine > 3 && !cancelled) std::this_thread::yield();  // the third is late to say it
      },
      {}, &cancelled));
  EXPECT_LE(runs, 4) << "one that was running beside it may end";
}

}  // namespace
}  // namespace handrail
