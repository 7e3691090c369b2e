#include "server/lab/study/screw/screw_figure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/lab_study_screw/screw_samples.h"

namespace handrail {
namespace {

TEST(ScrewFigure, AFailedTrialIsTheWorstRankInWhatGrowsWithTime) {
  const ScrewResult failed =
      screw_trial(0, ScrewMode::kNCNV, 20.0, 100.0, 60.0, ScrewEnd::kForce).result;
  for (const ScrewFigure figure :
       {ScrewFigure::kTime, ScrewFigure::kPath, ScrewFigure::kImpulse, ScrewFigure::kContactTime}) {
    EXPECT_TRUE(std::isinf(value_of(failed, figure))) << info_of(figure).name;
    EXPECT_TRUE(std::isfinite(measured_of(failed, figure))) << info_of(figure).name;
  }
}

TEST(ScrewFigure, AFailedTrialsForcesCountAsMeasured) {
  for (const ScrewEnd end : {ScrewEnd::kForce, ScrewEnd::kKeyLost, ScrewEnd::kTimeOut}) {
    const ScrewResult failed = screw_trial(0, ScrewMode::kNCNV, 20.0, 100.0, 60.0, end).result;
    EXPECT_DOUBLE_EQ(value_of(failed, ScrewFigure::kMeanForce), 60.0);
    EXPECT_DOUBLE_EQ(value_of(failed, ScrewFigure::kMaxForce), 120.0);
  }
}

TEST(ScrewFigure, WhoNeverTouchedAnythingDidNotPushGently) {
  ScrewResult failed;
  failed.end = ScrewEnd::kSession;
  EXPECT_TRUE(std::isinf(value_of(failed, ScrewFigure::kMeanForce)));
  EXPECT_TRUE(std::isinf(value_of(failed, ScrewFigure::kMaxForce)));
}

TEST(ScrewFigure, PairsDifferInOneThing) {
  for (int i = 0; i < kScrewPairs; ++i) {
    const auto pairing = static_cast<ScrewPairing>(i);
    const ScrewPair pair = pair_of(pairing);
    const bool tools = pairing == ScrewPairing::kToolsNC || pairing == ScrewPairing::kToolsC;
    EXPECT_EQ(has_tools(pair.with) != has_tools(pair.without), tools);
    EXPECT_EQ(has_protection(pair.with) != has_protection(pair.without), !tools);
    EXPECT_TRUE(tools ? has_tools(pair.with) : has_protection(pair.with));
  }
  EXPECT_EQ(pair_of(ScrewPairing::kToolsC).with, ScrewMode::kCV);
  EXPECT_EQ(pair_of(ScrewPairing::kProtectionNV).with, ScrewMode::kCNV);
}

TEST(ScrewFigure, ComparesModesOfTheSamePeople) {
  const ScrewStudy study = five_people();
  const Paired path = comparison_of(study, ScrewPairing::kToolsNC, ScrewFigure::kPath, 1);
  EXPECT_NEAR(path.ratio, 0.6, 1e-12);
  EXPECT_DOUBLE_EQ(path.helped, 1.0);
  EXPECT_EQ(path.people, 5u);
  const Paired force = comparison_of(study, ScrewPairing::kProtectionV, ScrewFigure::kMeanForce, 1);
  EXPECT_NEAR(force.ratio, 0.5, 1e-12);
  EXPECT_NEAR(comparison_of(study, ScrewPairing::kToolsC, ScrewFigure::kMaxForce, 1).ratio, 1.0,
              1e-12);
}

TEST(ScrewFigure, TheDissertationsRatiosAreThoseOfItsImpliedMedians) {
  EXPECT_NEAR(implied_ratio(ScrewPairing::kToolsNC, ScrewFigure::kPath), 0.566, 1e-3);
  EXPECT_NEAR(implied_ratio(ScrewPairing::kToolsC, ScrewFigure::kPath), 0.648, 1e-3);
  EXPECT_NEAR(implied_ratio(ScrewPairing::kToolsC, ScrewFigure::kTime), 0.784, 1e-3);
  EXPECT_NEAR(implied_ratio(ScrewPairing::kProtectionNV, ScrewFigure::kMeanForce), 0.532, 1e-3);
  EXPECT_EQ(implied_ratio(ScrewPairing::kProtectionNV, ScrewFigure::kMaxForce), 0.0);
}

TEST(ScrewFigure, FailuresAreComparedByTheirNumberPersonByPerson) {
  ScrewStudy study = five_people();
  result_of(study, 0, ScrewMode::kNCNV).end = ScrewEnd::kForce;
  result_of(study, 1, ScrewMode::kNCNV).end = ScrewEnd::kTimeOut;
  result_of(study, 1, ScrewMode::kCNV).end = ScrewEnd::kKeyLost;
  result_of(study, 2, ScrewMode::kCNV).end = ScrewEnd::kForce;
  const FailureComparison failed = failures_of(study, ScrewPairing::kProtectionNV);
  EXPECT_EQ(failed.without, 2);
  EXPECT_EQ(failed.with, 2);
  EXPECT_DOUBLE_EQ(failed.no_more.value, 0.8) << "all but person 2";
  EXPECT_LT(failed.no_more.value_95.low, 0.8);
  // Exact: with a share of p all five are so in 2.5 % of such studies.
  EXPECT_NEAR(failed.no_more.value_95.high, std::pow(0.975, 0.2), 1e-9);
}

TEST(ScrewFigure, TheWorstForceIsThatOfAnyTrialFailedToo) {
  ScrewStudy study = five_people();
  result_of(study, 3, ScrewMode::kNCV).measured.max_force = 501.0;
  result_of(study, 3, ScrewMode::kNCV).end = ScrewEnd::kForce;
  EXPECT_DOUBLE_EQ(worst_force(study, ScrewMode::kNCV), 501.0);
  EXPECT_NEAR(worst_force(study, ScrewMode::kCV), 52.0, 1e-9);
}

}  // namespace
}  // namespace handrail
