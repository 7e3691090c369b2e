// Fits a population's free parameters to published medians.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "server/base/status.h"
#include "server/lab/study/study_run.h"

namespace handrail {

struct FitOptions {
  int operators = 40;
  std::uint64_t seed = 1001;  // other people than a study's with its default seed
  int threads = 0;
  int evaluations = 150;  // at most
  std::function<void(int evaluation, double misfit)> progress;
  const std::atomic<bool>* cancelled = nullptr;
};

struct FitResult {
  Population population;        // with the fitted medians, rounded to three digits in file's units
  std::vector<double> medians;  // reached, as the aims
  double misfit = 0.0;          // root mean square of the logarithms of median over aim
  int evaluations = 0;
};

// A median that is known.
struct FitAim {
  const char* title;
  const char* unit;
  double value;
};

// A candidate's medians, one for each aim and in its unit.
using MediansOf = std::function<Result<std::vector<double>>(const Population& candidate)>;

// Pattern search (Hooke and Jeeves 1961) over the logarithms of the free medians, within their
// bounds, from the middle of each: the present medians do not matter. Aims are above 0. The error
// is that of `medians_of`, or says that nothing is free. Same arguments, same answer.
Result<FitResult> fit_population(const Population& population, const std::vector<double>& aims,
                                 const MediansOf& medians_of, const FitOptions& options);

// `Figure`: the study's measures, with info_of() and values_of(). Of its first `figures`,
// `known_of(info)` is the value known, in the measure's unit.
template <typename Figure, typename KnownOf>
std::vector<FitAim> fit_aims(int figures, const KnownOf& known_of) {
  std::vector<FitAim> aims;
  for (int i = 0; i < figures; ++i) {
    const auto& info = info_of(static_cast<Figure>(i));
    aims.push_back({info.title, info.unit, known_of(info)});
  }
  return aims;
}

// As fit_population() says, in `mode` alone, with the same operators for every candidate:
// `run(candidate, plan)` gives a Result of their study. The aims are those of the first measures.
template <typename Figure, typename Mode, typename Run>
Result<FitResult> fit_study(const Population& population, const std::vector<FitAim>& aims,
                            Mode mode, const Run& run, const FitOptions& options) {
  StudyPlan plan;
  plan.operators = options.operators;
  plan.seed = options.seed;
  plan.threads = options.threads;
  plan.cancelled = options.cancelled;
  plan.only = {static_cast<int>(mode)};
  std::vector<double> values;
  for (const FitAim& aim : aims) values.push_back(aim.value);
  const auto medians_of = [&](const Population& candidate) -> Result<std::vector<double>> {
    const auto study = run(candidate, plan);
    if (!study) return study.status();
    std::vector<double> medians;
    for (std::size_t i = 0; i < aims.size(); ++i) {
      const auto figure = static_cast<Figure>(i);
      medians.push_back(median(pooled(values_of(*study, mode, figure))) * info_of(figure).per_si);
    }
    return medians;
  };
  return fit_population(population, values, medians_of, options);
}

}  // namespace handrail
