// The screw-fastening study (dissertation 3.4.2): every operator in all four modes.
#pragma once

#include "server/lab/study/screw/screw_trial.h"
#include "server/lab/study/study_run.h"

namespace handrail {

using ScrewStudy = StudyResult<ScrewMode, ScrewResult>;
using ScrewStudyTrial = ScrewStudy::Trial;

struct ScrewStudyOptions : StudyPlan {
  BumperSettings::Form bumper = BumperSettings::Form::kDefault;  // in the modes with protection
};

// As run_study() says. The error says what the machine lacks, or that it was cancelled.
Result<ScrewStudy> run_screw_study(const StudyMachine& machine, const Population& population,
                                   const ScrewStudyOptions& options);

}  // namespace handrail
