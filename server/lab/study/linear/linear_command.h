// The lab's commands for the linear movement: the study and the fit.
#pragma once

#include <atomic>

#include "server/lab/study/study_command.h"

namespace handrail {

// Exit codes as run_study_command() and run_fit() say.
int run_linear_command(const StudyCommand& command, const std::atomic<bool>& cancelled);
int run_linear_fit(const FitCommand& command, const std::atomic<bool>& cancelled);

}  // namespace handrail
