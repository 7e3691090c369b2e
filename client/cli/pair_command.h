// handrail keys pair: two computers trust each other by a code that one person tells the other.
#pragma once

#include "client/cli/command.h"

namespace handrail {

ExitCode run_keys_pair(const Options& options, const Console& console);

}  // namespace handrail
