#include "server/lab/study/linear/linear_fit.h"

#include <gtest/gtest.h>

#include "server/lab/study/study_setup_io.h"

namespace handrail {
namespace {

StudySetup fit_setup() {
  auto out = study_setup("linear-movement", "linear-movement", {});
  EXPECT_TRUE(out) << out.message();
  return out ? std::move(*out) : StudySetup();
}

FitOptions small() {
  FitOptions options;
  options.operators = 2;
  options.evaluations = 8;
  return options;
}

FitResult fit(const StudySetup& s, const FitOptions& options) {
  auto out = fit_linear(s.machine, s.population, options);
  EXPECT_TRUE(out) << out.message();
  return out ? std::move(*out) : FitResult();
}

std::vector<double> free_medians(const Population& population) {
  std::vector<double> out;
  for (const ParameterRange& p : population.parameters) {
    if (p.fitted) out.push_back(p.median);
  }
  return out;
}

TEST(LinearFit, DoesNotDependOnThePresentMediansNorOnThreads) {
  StudySetup s = fit_setup();
  FitOptions options = small();
  options.threads = 1;
  const FitResult first = fit(s, options);
  for (ParameterRange& p : s.population.parameters) {
    if (p.fitted) p.median = p.low;
  }
  options.threads = 2;
  const FitResult second = fit(s, options);
  EXPECT_EQ(free_medians(first.population), free_medians(second.population));
  EXPECT_EQ(first.misfit, second.misfit);
}

TEST(LinearFit, ComesNearerToThePublishedMediansThanWhereItStarted) {
  const StudySetup s = fit_setup();
  FitOptions options = small();
  double at_start = -1.0;
  options.progress = [&](int evaluation, double misfit) {
    if (evaluation == 1) at_start = misfit;
  };
  const FitResult result = fit(s, options);
  EXPECT_LT(result.misfit, at_start);
  EXPECT_LE(result.evaluations, options.evaluations);
}

TEST(LinearFit, ChangesNothingButFreeMediansAndKeepsThemInBounds) {
  const StudySetup s = fit_setup();
  const FitResult result = fit(s, small());
  for (std::size_t i = 0; i < s.population.parameters.size(); ++i) {
    const ParameterRange& before = s.population.parameters[i];
    const ParameterRange& after = result.population.parameters[i];
    EXPECT_EQ(before.spread, after.spread);
    EXPECT_EQ(before.source, after.source);
    if (!before.fitted) {
      EXPECT_EQ(before.median, after.median) << before.name;
    }
    EXPECT_GE(after.median, after.low) << after.name;
    EXPECT_LE(after.median, after.high) << after.name;
  }
}

// What is only used with tools cannot change a fit that never runs them.
TEST(LinearFit, DoesNotSeeWhatToolsDo) {
  StudySetup s = fit_setup();
  const FitResult before = fit(s, small());
  for (const char* name : {"call_homing_ms", "call_key_ms", "stop_force_n", "touch_delay_ms"}) {
    ParameterRange* parameter = s.population.find(name);
    ASSERT_NE(parameter, nullptr);
    parameter->median = parameter->high;
  }
  s.machine.scene.guidance.stiffness *= 3.0;
  EXPECT_EQ(free_medians(before.population), free_medians(fit(s, small()).population));
}

TEST(LinearFit, NeedsSomethingToFit) {
  StudySetup s = fit_setup();
  for (ParameterRange& p : s.population.parameters) p.fitted = false;
  EXPECT_NE(fit_linear(s.machine, s.population, small()).message().find("fitted"),
            std::string::npos);
}

}  // namespace
}  // namespace handrail
