// What a contest calls, and when; not how long it takes.
#include "server/lab/scenes/contest.h"

#include <gtest/gtest.h>

#include <string>

namespace handrail {
namespace {

TEST(Contest, GoesRoundItsEntrantsTurnByTurnAndNobodyAlwaysGoesFirst) {
  const std::atomic<bool> go_on = false;
  std::string calls;
  Contest contest;
  contest.add([&] { calls += 'A'; }, [&] { calls += 'a'; }, 1);
  contest.add([&] { calls += 'B'; }, [&] { calls += 'b'; }, 1);
  contest.run(2, 2, go_on);
  // One batch to warm up and two; one turn that does not count.
  EXPECT_EQ(calls, "AaaaBbbbBbbbAaaaAaaaBbbb");
  EXPECT_GE(contest.time(0).p999, contest.time(0).median);
}

TEST(Contest, TellsWorkFromNone) {
  const std::atomic<bool> go_on = false;
  double sum = 0.0;
  Contest contest;
  contest.add([] {},
              [&] {
                for (int i = 0; i < 20000; ++i) keep(sum += i);
              },
              1);
  contest.add([] {}, [] {}, 1);
  contest.run(5, 11, go_on);
  EXPECT_GT(contest.longer(0, 1), 0.0);
  EXPECT_LT(contest.longer(1, 0), 0.0);
}

TEST(Contest, LeavesTheFirstTurnOut) {
  const std::atomic<bool> go_on = false;
  double sum = 0.0;
  int prepared = 0;
  const auto work = [&sum](int size) {
    for (int i = 0; i < size; ++i) keep(sum += i);
  };
  Contest contest;
  contest.add([&] { ++prepared; }, [&] { work(prepared == 1 ? 80'000 : 0); }, 1);
  contest.add([] {}, [&] { work(20'000); }, 1);
  contest.run(1, 11, go_on);
  EXPECT_LT(contest.longer(0, 1), 0.0);
}

TEST(Contest, EndsWhenCancelled) {
  const std::atomic<bool> cancelled = true;
  int calls = 0;
  Contest contest;
  contest.add([&] { ++calls; }, [&] { ++calls; }, 1);
  contest.run(3, 3, cancelled);
  EXPECT_EQ(calls, 0);
  EXPECT_EQ(contest.time(0).median, 0.0);
}

}  // namespace
}  // namespace handrail
