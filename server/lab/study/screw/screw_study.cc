#include "server/lab/study/screw/screw_study.h"

namespace handrail {

Result<ScrewStudy> run_screw_study(const StudyMachine& machine, const Population& population,
                                   const ScrewStudyOptions& options) {
  ScrewTrialOptions trial;
  trial.bumper = options.bumper;
  return run_study<ScrewStudy>(
      options, kScrewModes, population, trial,
      [&](const ScrewTrialOptions& one) { return run_screw_trial(machine, one); });
}

}  // namespace handrail
