#include "server/lab/study/screw/screw_verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/lab_study_screw/screw_samples.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

const ScrewTarget& target(const std::vector<ScrewTarget>& targets, const std::string& what) {
  static const ScrewTarget none;
  for (const ScrewTarget& one : targets) {
    if (one.what.find(what) != std::string::npos) return one;
  }
  ADD_FAILURE() << "no target on " << what;
  return none;
}

TEST(ScrewVerdict, SizesStandBesideTheDissertations) {
  const std::vector<ScrewEffect> effects = effects_of(five_people(), 1);
  ASSERT_EQ(effects.size(), 6u);
  EXPECT_NEAR(effects[0].lowered, 0.5, 1e-12);
  EXPECT_NEAR(effects[0].implied, 0.468, 1e-3);
  EXPECT_NEAR(effects[2].lowered, 0.4, 1e-12);
  EXPECT_NEAR(effects[2].implied, 0.434, 1e-3);
  const std::string force = text_of(effects[0]);
  EXPECT_THAT(force, HasSubstr("mean contact force, with protection, without tools: 50 % lower"));
  EXPECT_THAT(force, HasSubstr("dissertation 46.8 % lower"));
}

TEST(ScrewVerdict, ASizeIsReproducedWhenTheDissertationsIsWithinTheInterval) {
  ScrewEffect effect{ScrewPairing::kToolsNC, ScrewFigure::kTime, 0.18, {0.12, 0.25}, 0.209};
  EXPECT_TRUE(effect.reproduced());
  EXPECT_THAT(text_of(effect), HasSubstr("as there"));
  effect.lowered_95 = {0.12, 0.20};
  EXPECT_FALSE(effect.reproduced());
  EXPECT_THAT(text_of(effect), HasSubstr("less than there"));
  effect = {ScrewPairing::kToolsNC, ScrewFigure::kTime, 0.3, {0.25, 0.35}, 0.209};
  EXPECT_THAT(text_of(effect), HasSubstr("more than there"));
  effect = {ScrewPairing::kToolsNC, ScrewFigure::kTime, -0.05, {-0.12, 0.03}, 0.209};
  EXPECT_THAT(text_of(effect),
              HasSubstr("completion time, with tools, without protection: 5 % higher"));
  EXPECT_THAT(text_of(effect), HasSubstr("-3 to 12 %"));
  EXPECT_THAT(text_of(effect), HasSubstr("the other way there"));
}

TEST(ScrewVerdict, TargetsAreMetByNumbers) {
  ScrewStudy study = five_people();
  result_of(study, 0, ScrewMode::kNCNV).measured.max_force = 450.0;
  const std::vector<ScrewTarget> targets = targets_of(study, 1);
  for (const ScrewTarget& one : targets) {
    EXPECT_TRUE(one.met) << one.what << ": " << one.found;
  }
  EXPECT_EQ(target(targets, "30 to 70 % lower with protection, with tools").found, "50 % lower");
  EXPECT_EQ(target(targets, "at least 20 % shorter with tools, with prot").found, "40 % lower");
  EXPECT_EQ(target(targets, "over 400 N").found, "450 N");
  EXPECT_EQ(target(targets, "under 200 N").found, "52 N");
}

TEST(ScrewVerdict, TargetsAreMissedByNumbers) {
  ScrewStudy study = five_people();
  for (ScrewStudyTrial& trial : study.trials) {
    if (has_tools(trial.mode)) trial.result.completion_time *= 2.0;
    if (has_tools(trial.mode)) trial.result.measured.path *= 1.5;
    if (trial.mode == ScrewMode::kNCNV) trial.result.completion_time *= 0.7;
    if (trial.mode == ScrewMode::kCNV) trial.result.measured.mean_force *= 0.5;
    if (trial.mode == ScrewMode::kCV) trial.result.measured.mean_force *= 1.5;
  }
  result_of(study, 0, ScrewMode::kCV).measured.max_force = 200.0;
  result_of(study, 0, ScrewMode::kCV).end = ScrewEnd::kKeyLost;
  const std::vector<ScrewTarget> targets = targets_of(study, 1);
  for (const char* what :
       {"NC-NV: completion time", "lower with protection, without tools",
        "lower with protection, with tools", "shorter with tools, without protection",
        "not longer with tools, with protection", "over 400 N", "under 200 N",
        "failed trials fewer with tools, with protection",
        "completion time lower for 90 % of operators with tools, without protection",
        "no more failures for 90 % of operators with protection, with tools"}) {
    EXPECT_FALSE(target(targets, what).met) << what;
  }
  EXPECT_EQ(target(targets, "failed trials fewer with tools, with protection").found,
            "1, without 0");
  EXPECT_EQ(target(targets, "no more failures for 90 % of operators with protection, with t").found,
            "80.0 %");
  EXPECT_TRUE(target(targets, "NC-NV: path").met);
}

TEST(ScrewVerdict, NothingIsMetWhereMostTrialsFailed) {
  ScrewStudy study = five_people();
  for (ScrewStudyTrial& trial : study.trials) trial.result.end = ScrewEnd::kTimeOut;
  const std::vector<ScrewTarget> targets = targets_of(study, 1);
  for (const char* what :
       {"NC-NV: completion time", "shorter with tools, without protection",
        "not longer with tools, without protection", "not longer with tools, with protection"}) {
    EXPECT_FALSE(target(targets, what).met) << what;
  }
  EXPECT_EQ(target(targets, "not longer with tools, with protection").found, "most trials failed");
  EXPECT_THAT(text_of(effects_of(study, 1)[4]), HasSubstr("cannot be told"));
  EXPECT_TRUE(target(targets, "30 to 70 % lower with protection, without").met)
      << "forces count all the same";
}

}  // namespace
}  // namespace handrail
