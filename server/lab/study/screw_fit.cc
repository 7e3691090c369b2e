#include "server/lab/study/screw_fit.h"

#include "server/lab/study/screw_figure.h"

namespace handrail {

Result<FitResult> fit_screw(const StudyMachine& machine, const Population& population,
                            const FitOptions& options) {
  ScrewStudyOptions study;
  study.operators = options.operators;
  study.seed = options.seed;
  study.threads = options.threads;
  study.cancelled = options.cancelled;
  study.only = {static_cast<int>(ScrewMode::kNCNV)};
  std::vector<double> aims;
  for (int i = 0; i < kImpliedFigures; ++i) {
    aims.push_back(info_of(static_cast<ScrewFigure>(i)).implied[0]);
  }
  const auto medians_of = [&](const Population& candidate) -> Result<std::vector<double>> {
    const Result<ScrewStudy> result = run_screw_study(machine, candidate, study);
    if (!result) return result.status();
    std::vector<double> medians;
    for (int i = 0; i < kImpliedFigures; ++i) {
      const auto figure = static_cast<ScrewFigure>(i);
      medians.push_back(median(pooled(values_of(*result, ScrewMode::kNCNV, figure))) *
                        info_of(figure).per_si);
    }
    return medians;
  };
  return fit_population(population, aims, medians_of, options);
}

}  // namespace handrail
