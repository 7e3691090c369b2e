// `handrail experiment`: its words.
#pragma once

#include "client/cli/command.h"

namespace handrail {

ExitCode run_experiment_command(const Options& options, const Console& console);

}  // namespace handrail
