#include "server/lab/study/pattern_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "server/lab/study/population_io.h"
#include "tests/unit/lab_study/population_samples.h"

namespace handrail {
namespace {

// Free: gain, 0.25 to 1 as all are, and depth of memory.
Population people() {
  auto out = parse_population("p", population_text());
  EXPECT_TRUE(out) << out.message();
  if (!out) return Population();
  out->find("gain")->fitted = out->find("practice")->fitted = true;
  return std::move(*out);
}

TEST(PatternSearch, FindsTheMediansThatGiveTheAims) {
  // Two measures that depend on both parameters.
  const auto medians_of = [](const Population& candidate) -> Result<std::vector<double>> {
    const OperatorParameters person = candidate.median();
    return std::vector<double>{10.0 * person.gain * person.practice, person.gain / person.practice};
  };
  const auto fit = fit_population(people(), {10.0 * 0.8 * 0.4, 2.0}, medians_of, FitOptions());
  ASSERT_TRUE(fit) << fit.message();
  EXPECT_NEAR(fit->population.median().gain, 0.8, 0.03);
  EXPECT_NEAR(fit->population.median().practice, 0.4, 0.015);
  EXPECT_NEAR(fit->medians[0], 3.2, 0.15);
  EXPECT_LT(fit->misfit, 0.05);
}

TEST(PatternSearch, TheMisfitIsTheRootMeanSquareOfLogarithms) {
  const auto medians_of = [](const Population&) -> Result<std::vector<double>> {
    return std::vector<double>{2.0 * std::exp(0.3), 5.0 * std::exp(-0.4)};
  };
  FitOptions options;
  options.evaluations = 1;
  const auto fit = fit_population(people(), {2.0, 5.0}, medians_of, options);
  ASSERT_TRUE(fit) << fit.message();
  EXPECT_NEAR(fit->misfit, std::sqrt((0.09 + 0.16) / 2.0), 1e-12);
  EXPECT_EQ(fit->evaluations, 1);
}

TEST(PatternSearch, StaysWithinBoundsAndTriesNoMoreThanAllowed) {
  int tried = 0;
  const auto medians_of = [&](const Population& candidate) -> Result<std::vector<double>> {
    ++tried;
    for (const ParameterRange& p : candidate.parameters) {
      EXPECT_GE(p.median, p.low) << p.name;
      EXPECT_LE(p.median, p.high) << p.name;
    }
    return std::vector<double>{candidate.median().gain};
  };
  FitOptions options;
  options.evaluations = 7;
  const auto fit = fit_population(people(), {100.0}, medians_of, options);
  ASSERT_TRUE(fit) << fit.message();
  EXPECT_EQ(tried, 7);
  EXPECT_EQ(fit->evaluations, 7);
  EXPECT_DOUBLE_EQ(fit->population.median().gain, 1.0) << "as near as it may be";
}

TEST(PatternSearch, AnErrorOfACandidateEndsIt) {
  int tried = 0;
  const auto medians_of = [&](const Population&) -> Result<std::vector<double>> {
    if (++tried == 3) return Status::error("cancelled");
    return std::vector<double>{1.0};
  };
  EXPECT_EQ(fit_population(people(), {2.0}, medians_of, FitOptions()).message(), "cancelled");
  EXPECT_EQ(tried, 3);
}

}  // namespace
}  // namespace handrail
