#include "server/lab/study/linear/linear_study.h"

namespace handrail {

Result<LinearStudy> run_linear_study(const StudyMachine& machine, const Population& population,
                                     const StudyOptions& options) {
  TrialOptions trial;
  trial.tools_act = options.tools_act;
  return run_study<LinearStudy>(
      options, kStudyModes, population, trial,
      [&](const TrialOptions& one) { return run_linear_trial(machine, one); });
}

}  // namespace handrail
