// handrail lease ...: who drives.
#pragma once

#include "client/cli/command.h"

namespace handrail {

// "anna has the lease for 42 s, last order 3 s ago; ben asks for it, 7 s left: ..."
std::string lease_text(const pb::LeaseStatus& lease);

ExitCode run_lease_show(const Options& options, const Console& console);
ExitCode send_lease(pb::LeaseOrder::Act act, const Options& options, const Console& console);

template <pb::LeaseOrder::Act kAct>
ExitCode run_lease(const Options& options, const Console& console) {
  return send_lease(kAct, options, console);
}

}  // namespace handrail
