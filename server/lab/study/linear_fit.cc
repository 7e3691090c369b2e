#include "server/lab/study/linear_fit.h"

#include "server/lab/study/linear_figure.h"

namespace handrail {

Result<FitResult> fit_linear(const StudyMachine& machine, const Population& population,
                             const FitOptions& options) {
  StudyOptions study;
  study.operators = options.operators;
  study.seed = options.seed;
  study.threads = options.threads;
  study.cancelled = options.cancelled;
  study.only = {static_cast<int>(StudyMode::kFree)};
  std::vector<double> aims;
  for (int i = 0; i < kPublishedFigures; ++i) {
    aims.push_back(info_of(static_cast<LinearFigure>(i)).published[0]);
  }
  const auto medians_of = [&](const Population& candidate) -> Result<std::vector<double>> {
    const Result<LinearStudy> result = run_linear_study(machine, candidate, study);
    if (!result) return result.status();
    std::vector<double> medians;
    for (int i = 0; i < kPublishedFigures; ++i) {
      const auto figure = static_cast<LinearFigure>(i);
      medians.push_back(median(pooled(values_of(*result, StudyMode::kFree, figure))) *
                        info_of(figure).per_si);
    }
    return medians;
  };
  return fit_population(population, aims, medians_of, options);
}

}  // namespace handrail
