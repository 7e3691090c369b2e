// handrail status
#pragma once

#include "client/cli/command.h"

namespace handrail {

// Once, or with --watch 5 times a second until SIGINT or SIGTERM, which end it with kExitDone.
ExitCode run_status(const Options& options, const Console& console);

// handrail why: one line, or the ledger as JSON.
ExitCode run_why(const Options& options, const Console& console);

}  // namespace handrail
