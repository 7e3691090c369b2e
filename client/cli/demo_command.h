// handrail demo: the simulated hand drives the arm from A to B to C, without and with tools.
#pragma once

#include "client/cli/command.h"

namespace handrail {

ExitCode run_demo(const Options& options, const Console& console);

}  // namespace handrail
