#include "server/lab/study/linear/linear_fit.h"

#include "server/lab/study/linear/linear_figure.h"

namespace handrail {

std::vector<FitAim> linear_aims() {
  return fit_aims<LinearFigure>(kPublishedFigures,
                                [](const LinearFigureInfo& info) { return info.published[0]; });
}

Result<FitResult> fit_linear(const StudyMachine& machine, const Population& population,
                             const FitOptions& options) {
  const auto run = [&](const Population& candidate, const StudyPlan& plan) {
    return run_linear_study(machine, candidate, {plan});
  };
  return fit_study<LinearFigure>(population, linear_aims(), StudyMode::kFree, run, options);
}

}  // namespace handrail
