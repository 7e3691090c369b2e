// handrail hand ...: steers the hand of a simulated device.
#pragma once

#include "client/cli/command.h"

namespace handrail {

ExitCode run_hand_to(const Options& options, const Console& console);
ExitCode run_hand_home(const Options& options, const Console& console);

}  // namespace handrail
