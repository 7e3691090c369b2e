// handrail calibrate payload: what hangs on the force sensor, from readings at rest.
#pragma once

#include "client/cli/command.h"

namespace handrail {

// Watches the master's status and moves nothing: takes a sample whenever the arm has stood for a
// second in a new orientation, until there are --poses of them, unlike enough for a fit. With
// --from FILE.csv the samples are a file's. Prints the payload, and writes its block for the
// slave's file (--out, a new file) and the samples (--record, a new file). kExitRefused: readings
// that are no calibration, a slave that already takes a payload out of them, or Ctrl-C before the
// end; nothing is written then.
ExitCode run_calibrate_payload(const Options& options, const Console& console);

}  // namespace handrail
