// The lab's commands for the linear movement: the study and the fit.
#pragma once

#include <atomic>
#include <string>

#include "server/lab/study/study_command.h"

namespace handrail {

struct LinearCommand : StudyCommand {
  LinearCommand() : StudyCommand{"linear-movement"} {}
  // Words that stand for a setting, beside --set itself.
  std::string smoother;     // published, low-lag, or a number of samples
  std::string rate;         // of the haptic loop [Hz]
  std::string tool_method;  // exact, published
};

// Exit codes as run_study_command() and run_fit() say.
int run_linear_command(const LinearCommand& words, const std::atomic<bool>& cancelled);
int run_linear_fit(const FitCommand& command, const std::atomic<bool>& cancelled);

}  // namespace handrail
