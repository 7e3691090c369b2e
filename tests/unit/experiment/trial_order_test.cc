#include "client/experiment/trial_order.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "server/base/random.h"
#include "server/lab/study/study_run.h"

namespace handrail {
namespace {

// Makes trials that end as `outcome` says, and gives what was made.
template <typename Outcome>
std::vector<TrialMade> all_of(const ExperimentRules& rules, const std::vector<int>& order,
                              const Outcome& outcome) {
  std::vector<TrialMade> made;
  while (const auto next = next_trial(rules, order, made)) {
    if (made.size() > 1000) break;
    TrialMade trial{next->mode, next->practice};
    outcome(made.size(), trial);
    made.push_back(trial);
  }
  return made;
}

TEST(TrialOrder, PracticesUntilTwoSuccessesThenCounts) {
  const auto made =
      all_of({2, 3}, {1, 0}, [](std::size_t, TrialMade& trial) { trial.done = true; });
  ASSERT_EQ(made.size(), 10u);
  for (std::size_t i = 0; i < made.size(); ++i) {
    EXPECT_EQ(made[i].mode, i < 5 ? 1 : 0) << i;
    EXPECT_EQ(made[i].practice, i % 5 < 2) << i;
  }
}

TEST(TrialOrder, FailedPracticeIsMadeAgainFailedTrialsThriceAtMost) {
  // The first three of each mode fail, in the second mode all that count.
  const auto made = all_of({2, 2}, {0, 1}, [](std::size_t i, TrialMade& trial) {
    trial.done = trial.mode == 0 ? i >= 3 : trial.practice;
  });
  const auto count = [&](int mode, bool practice) {
    return std::count_if(made.begin(), made.end(), [&](const TrialMade& t) {
      return t.mode == mode && t.practice == practice;
    });
  };
  EXPECT_EQ(count(0, true), 5);
  EXPECT_EQ(count(0, false), 2);
  EXPECT_EQ(count(1, true), 2);
  EXPECT_EQ(count(1, false), 2 * kAttemptsPerTrial);
}

TEST(TrialOrder, InterruptedTrialsCountForNothing) {
  const ExperimentRules rules;
  const std::vector<int> order = {0, 1};
  const auto whole = all_of(rules, order, [](std::size_t, TrialMade& trial) { trial.done = true; });
  auto torn = all_of(rules, order, [](std::size_t i, TrialMade& trial) {
    trial.interrupted = i % 2 == 0;
    trial.done = !trial.interrupted;
  });
  const auto next = next_trial(rules, order, {torn.front()});
  ASSERT_TRUE(next);
  EXPECT_EQ(next->number, 1);
  torn.erase(std::remove_if(torn.begin(), torn.end(), [](auto& t) { return t.interrupted; }),
             torn.end());
  ASSERT_EQ(torn.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(torn[i].mode, whole[i].mode) << i;
    EXPECT_EQ(torn[i].practice, whole[i].practice) << i;
  }
}

// Nor for the most attempts that are given.
TEST(TrialOrder, NobodyIsInterruptedOutOfTheirTrials) {
  const ExperimentRules rules;
  std::vector<TrialMade> made(static_cast<std::size_t>(rules.practice), {0, true, false, true});
  made.insert(made.end(), 20, {0, false, true, false});
  const auto next = next_trial(rules, {0, 1}, made);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->mode, 0);
  EXPECT_EQ(next->attempt, 1);
  EXPECT_EQ(next->number, 3);
}

TEST(TrialOrder, ModesComeInEveryOrderAndAlwaysTheSameForOnePerson) {
  int first[2] = {};
  for (int i = 0; i < 200; ++i) {
    const std::string subject = "s" + std::to_string(i);
    const std::vector<int> order = order_of_modes(subject, 2);
    ASSERT_EQ(order.size(), 2u);
    EXPECT_NE(order[0], order[1]);
    EXPECT_EQ(order, order_of_modes(subject, 2));
    ++first[order[0]];
  }
  // 200 fair draws: fewer than 70 of a kind are seen once in 10^5 times.
  EXPECT_GT(first[0], 70);
  EXPECT_GT(first[1], 70);
}

TEST(TrialOrder, WhoAPersonIsSaysNothingOfTheirOrder) {
  int same = 0;
  for (int i = 0; i < 200; ++i) {
    const std::string subject = "s" + std::to_string(i);
    Random person(subject_seed(subject, "person"));
    same += order_of_modes(subject, 2).front() == static_cast<int>(person.bits() % 2);
  }
  // As above.
  EXPECT_GT(same, 70);
  EXPECT_LT(same, 130);
}

}  // namespace
}  // namespace handrail
