// The signals that end a program.
#pragma once

#include <vector>

namespace handrail {

// SIGINT and SIGTERM, and SIGHUP for a terminal that was closed, unless that is ignored: it is for
// who was started by nohup.
std::vector<int> ending_signals();

}  // namespace handrail
