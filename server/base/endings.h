// The signals that end a program.
#pragma once

#include <vector>

namespace handrail {

// SIGINT and SIGTERM, and SIGHUP for a terminal that was closed, unless that is ignored: it is for
// who was started by nohup.
std::vector<int> ending_signals();

// From here on they wait until take_endings(): what drives the arm is started in between, and must
// not be killed for want of somebody who hears them. In the thread that starts the others.
void hold_endings();
// Those that came meanwhile come now, in this thread.
void take_endings();

}  // namespace handrail
