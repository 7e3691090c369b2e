// The lab's commands for screw fastening: the study and the fit.
#pragma once

#include <atomic>

#include "server/lab/study/study_command.h"
#include "server/model/bumper_settings.h"

namespace handrail {

struct ScrewCommand : StudyCommand {
  ScrewCommand() : StudyCommand("screw-fastening") {}
  BumperSettings::Form bumper = BumperSettings::Form::kDefault;  // in the modes with protection
};

// Exit codes as run_study_command() and run_fit() say.
int run_screw_command(const ScrewCommand& command, const std::atomic<bool>& cancelled);
int run_screw_fit(const FitCommand& command, const std::atomic<bool>& cancelled);

}  // namespace handrail
