// The linear-movement study (dissertation 3.4.1): every operator in both modes.
#pragma once

#include "server/lab/study/linear/linear_trial.h"
#include "server/lab/study/study_run.h"

namespace handrail {

using LinearStudy = StudyResult<StudyMode, TrialResult>;
using LinearStudyTrial = LinearStudy::Trial;

struct StudyOptions : StudyPlan {
  bool tools_act = true;
};

// As run_study() says. The error says what the machine lacks, or that it was cancelled.
Result<LinearStudy> run_linear_study(const StudyMachine& machine, const Population& population,
                                     const StudyOptions& options);

}  // namespace handrail
