// handrail scene ...
#pragma once

#include "client/cli/command.h"

namespace handrail {

// These three read files and need no master.
ExitCode run_scene_list(const Options& options, const Console& console);
ExitCode run_scene_show(const Options& options, const Console& console);
ExitCode run_scene_check(const Options& options, const Console& console);

ExitCode run_scene_load(const Options& options, const Console& console);

}  // namespace handrail
