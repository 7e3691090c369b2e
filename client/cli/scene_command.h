// handrail scene ...
#pragma once

#include "client/cli/command.h"

namespace handrail {

// These three read files and need no master.
ExitCode run_scene_list(const Options& options, const Console& console);
ExitCode run_scene_show(const Options& options, const Console& console);
ExitCode run_scene_check(const Options& options, const Console& console);

// These run in handrail-lab, started from this program's own folder: its output and its exit code
// are passed on. Without it: kExitUsage, and which program is missing.
ExitCode run_scene_preview(const Options& options, const Console& console);
ExitCode run_scene_explain(const Options& options, const Console& console);
ExitCode run_scene_resolve(const Options& options, const Console& console);

ExitCode run_scene_load(const Options& options, const Console& console);

}  // namespace handrail
