#include "server/lab/study/screw/screw_fit.h"

#include "server/lab/study/screw/screw_figure.h"

namespace handrail {

std::vector<FitAim> screw_aims() {
  return fit_aims<ScrewFigure>(kImpliedFigures,
                               [](const ScrewFigureInfo& info) { return info.implied[0]; });
}

Result<FitResult> fit_screw(const StudyMachine& machine, const Population& population,
                            const FitOptions& options) {
  const auto run = [&](const Population& candidate, const StudyPlan& plan) {
    return run_screw_study(machine, candidate, {plan});
  };
  return fit_study<ScrewFigure>(population, screw_aims(), ScrewMode::kNCNV, run, options);
}

}  // namespace handrail
