#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "server/base/units.h"
#include "server/lab/links/stroke_speed.h"
#include "tests/links/cell.h"
#include "tests/links/outcome.h"
#include "tests/links/results.h"
#include "tests/support/temp_folder.h"

namespace handrail::links {
namespace {

using ::testing::HasSubstr;

LinkFigures some_figures() {
  LinkFigures out;
  out.engaged = true;
  out.after = 1.25;
  out.holds = 12.5;
  out.held = 0.0125;
  out.longest = 21.5;
  out.ends = 0.5;
  out.behind = 3.25;
  out.speed = 770.5;
  out.violations = 2;
  return out;
}
const LinkCase kLink{50, 20, 0.1, false, 7};

TEST(LinkResults, ACellIsFoundAgainWithEveryFigure) {
  const TempFolder folder;
  const Results results(folder.path() + "/cells", {"abc123", 60, 8});
  EXPECT_FALSE(results.find(kLink));
  ASSERT_TRUE(results.add(kLink, some_figures(), 3.5));
  const auto found = results.find(kLink);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->engaged);
  EXPECT_EQ(found->after, 1.25);
  EXPECT_EQ(found->holds, 12.5);
  EXPECT_EQ(found->held, 0.0125);
  EXPECT_EQ(found->longest, 21.5);
  EXPECT_EQ(found->ends, 0.5);
  EXPECT_EQ(found->behind, 3.25);
  EXPECT_EQ(found->speed, 770.5);
  EXPECT_EQ(found->violations, 2u);
}

TEST(LinkResults, ACellOfAnotherBuildPlanOrSeedIsMeasuredAgain) {
  const TempFolder folder;
  ASSERT_TRUE(Results(folder.path(), {"abc123", 60, 8}).add(kLink, some_figures(), 0));
  LinkCase other = kLink;
  other.seed = 8;
  EXPECT_FALSE(Results(folder.path(), {"abc123", 60, 8}).find(other));
  EXPECT_FALSE(Results(folder.path(), {"abc124", 60, 8}).find(kLink));
  EXPECT_FALSE(Results(folder.path(), {"abc123", 6, 8}).find(kLink));
  EXPECT_FALSE(Results(folder.path(), {"abc123", 60, 2}).find(kLink));
  EXPECT_TRUE(Results(folder.path(), {"abc123", 60, 8}).find(kLink));
}

TEST(LinkResults, AFolderThatCannotBeWrittenIsAnErrorThatNamesIt) {
  const TempFolder folder;
  const std::string file = folder.write("file", "");
  const Status added = Results(file, {"abc123", 60, 8}).add(kLink, some_figures(), 0);
  EXPECT_THAT(added.message(), HasSubstr(file));
}

TEST(LinkOutcome, IsReadAsItWasWritten) {
  const auto read = read_outcome(outcome_text({1, 2, 3, 4, 5, 0.5}));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->launched, 1);
  EXPECT_EQ(read->started, 2);
  EXPECT_EQ(read->engaged_at, 3);
  EXPECT_EQ(read->ended, 4);
  EXPECT_EQ(read->ends, 5);
  EXPECT_EQ(read->behind, 0.5);
  EXPECT_FALSE(read_outcome(""));
}

TEST(LinkHolds, AreReadFromWhatTheSlaveSaysAtItsEnd) {
  LinkFigures figures;
  ASSERT_TRUE(
      read_holds("[info] the arm stood for the link's sake 12 times, for 0.150 s in all, "
                 "0.021 s at most\n",
                 figures, 0.5));
  EXPECT_DOUBLE_EQ(figures.holds, 24.0);
  EXPECT_DOUBLE_EQ(figures.held, 0.005);
  EXPECT_DOUBLE_EQ(figures.longest, 21.0);
  EXPECT_FALSE(read_holds("nothing", figures, 0.5));
}

TEST(StrokeSpeed, IsTheWayButForTheEndsByItsTime) {
  StrokeSpeed speed;
  std::vector<Vec3> tip(50, Vec3::Zero());  // rests, goes 200 mm at 0.5 m/s, rests
  for (int i = 1; i <= 400; ++i) tip.emplace_back(0.5e-3 * i, 0.0, 0.0);
  tip.resize(600, tip.back());
  speed.add(tip, 1e-3);
  EXPECT_NEAR(speed.mean(), 0.5, 2e-3);
}

TEST(StrokeSpeed, WhatDidNotGoHalfOfTheWayIsNoStroke) {
  StrokeSpeed speed;
  speed.add({}, 1e-3);
  speed.add(std::vector<Vec3>{Vec3::Zero(), Vec3(99.0 * kMm, 0, 0)}, 1e-3);
  EXPECT_EQ(speed.mean(), 0.0);
}

TEST(HandRecording, StrokesGoFromSideToSideAtTheTimesThatAreLookedAt) {
  RunPlan plan;
  plan.motion = Motion::kStrokes;
  plan.strokes = 2;
  const std::string csv = hand_recording(plan, kLink);
  const auto place_at = [&csv](double t) {
    const std::string row = "\n" + std::to_string(t).substr(0, std::to_string(t).size() - 4) + ",";
    const std::size_t at = csv.find(row);
    return at == std::string::npos ? -1.0 : std::atof(csv.c_str() + at + row.size());
  };
  EXPECT_EQ(place_at(stroke_start(plan, kLink, 0) - 0.01), 0.0);
  EXPECT_EQ(place_at(stroke_start(plan, kLink, 0) + 0.03), 100.0);
  EXPECT_EQ(place_at(stroke_start(plan, kLink, 1) - 0.01), 100.0);
  EXPECT_EQ(place_at(stroke_start(plan, kLink, 1) + 0.03), -100.0);
  EXPECT_EQ(place_at(stroke_start(plan, kLink, 2) + 0.03), 100.0);
}

TEST(NetworkText, IsWhatTheLabsLinkHas) {
  EXPECT_EQ(network_text(kLink), "both { delay_ms: 50 jitter_ms: 20 loss: 0.1 reorder: 1 }");
}

}  // namespace
}  // namespace handrail::links
