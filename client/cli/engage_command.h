// handrail engage, with --hold while the command runs, and the short orders to arm and gripper.
#pragma once

#include "client/cli/command.h"

namespace handrail {

ExitCode run_engage(const Options& options, const Console& console);
ExitCode run_disengage(const Options& options, const Console& console);
ExitCode run_clutch(const Options& options, const Console& console);
ExitCode run_stop(const Options& options, const Console& console);
ExitCode run_reset(const Options& options, const Console& console);
ExitCode run_grip(const Options& options, const Console& console);
ExitCode run_release(const Options& options, const Console& console);

}  // namespace handrail
