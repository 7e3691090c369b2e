// handrail keys ...: who may reach the programs of this user over the network.
#pragma once

#include "client/cli/command.h"

namespace handrail {

ExitCode run_keys_new(const Options& options, const Console& console);
ExitCode run_keys_show(const Options& options, const Console& console);
ExitCode run_keys_trust(const Options& options, const Console& console);
ExitCode run_keys_list(const Options& options, const Console& console);
ExitCode run_keys_remove(const Options& options, const Console& console);

}  // namespace handrail
