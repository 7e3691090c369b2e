// The named cases: all hold, and what does not hold is said.
#include "server/lab/sequences/tool_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <set>

#include "server/lab/sequences/case_rig.h"

namespace handrail {
namespace {

void expect_all_hold(const std::vector<ToolCase>& cases) {
  std::set<std::string> names;
  for (const ToolCase& c : cases) {
    EXPECT_EQ(c.failure, "") << c.name;
    EXPECT_TRUE(names.insert(c.name).second) << c.name;
    EXPECT_EQ(c.energy, 0.0) << c.name;
  }
  EXPECT_EQ(failures_of(cases), 0u);
}

TEST(ToolCases, EveryOrderedPairOfToolsChangesWithinTheBoundsAndComesToRest) {
  const std::vector<ToolCase> cases = tool_change_cases();
  EXPECT_EQ(cases.size(), 4u * 99u) << "ten, without none to none, in four ways";
  expect_all_hold(cases);
  double force = 0.0, step = 0.0;
  for (const ToolCase& c : cases) {
    force = std::max(force, c.worst[static_cast<std::size_t>(Bound::kForceStep)].ratio);
    step = std::max(step, c.worst[static_cast<std::size_t>(Bound::kCommandStep)].ratio);
  }
  EXPECT_GT(force, 0.4) << "they are felt";
  EXPECT_GT(step, 0.99) << "and the command is eased over";
}

TEST(ToolCases, TurnedHandsAtNothingAHairAQuarterAndHalfATurnHold) {
  const std::vector<ToolCase> cases = turned_hand_cases();
  EXPECT_EQ(cases.size(), 3u * 5u * 4u);
  expect_all_hold(cases);
}

TEST(ToolCases, AxesThatNearlyCoincideOrOpposeHold) { expect_all_hold(parallel_axis_cases()); }

TEST(ToolCases, TheMeanOfOrientationsHoldsThroughHalfATurn) {
  const std::vector<ToolCase> cases = half_turn_cases();
  expect_all_hold(cases);
  double turn = 0.0;
  for (const ToolCase& c : cases) {
    turn = std::max(turn, c.worst[static_cast<std::size_t>(Bound::kCommandTurn)].measured);
  }
  EXPECT_GT(turn, 0.03) << "near the pole it turns fast, up to what a mean of 0.5 lets it";
}

TEST(ToolCases, AnAnswerThatIsNotTheExpectedOneIsSaid) {
  CaseRig rig("odd", false);
  ToolCall line;
  line.kind = ToolKind::kLine;
  rig.call(line);  // without a direction
  const ToolCase c = rig.finish();
  EXPECT_NE(c.failure.find("order answered with"), std::string::npos) << c.failure;
  EXPECT_NE(tool_cases_table({c}).find("1 cases, 1 fail"), std::string::npos);
  EXPECT_NE(tool_cases_json({c}).find("\"case\": \"odd\""), std::string::npos);
}

TEST(ToolCases, ACancelledRunHasNoRowsAndAWholeOneAllInOrder) {
  const std::atomic<bool> go = false, stop = true;
  EXPECT_TRUE(run_tool_cases(2, stop).empty());
  std::size_t last = 0;
  const std::vector<ToolCase> all =
      run_tool_cases(2, go, [&last](std::size_t done, std::size_t of) { last = 100 * done / of; });
  EXPECT_EQ(last, 100u);
  EXPECT_EQ(all.size(), 396u + 60u + 40u + 60u);
  EXPECT_EQ(all.front().name, "none to point, 0 mm away, hand turned by 0 deg");
  EXPECT_EQ(failures_of(all), 0u);
}

}  // namespace
}  // namespace handrail
