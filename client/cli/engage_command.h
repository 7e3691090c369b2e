// handrail engage: the hand drives the arm, with --hold while the command runs.
#pragma once

#include "client/cli/command.h"

namespace handrail {

ExitCode run_engage(const Options& options, const Console& console);

}  // namespace handrail
