// Trials among walls in virtual time: the runner's own task and simulated person, the page's device
// and the master's tick on one clock. What the running programs make of a trial is compared with
// this.
#pragma once

#include <functional>
#include <string>

#include "client/experiment/experiment_file_io.h"
#include "server/base/status.h"

namespace handrail {

// One counted trial of a gearshift or a wrench by the simulated person who is called `subject`, as
// a file would have it. The error says that the experiment has no walls, or what its scene lacks.
Result<ExperimentRecord> rehearse(const std::string& experiment, const std::string& subject);

// So many of them, p1 and so on, as a report's table or JSON; `cancelled` is asked between two.
Result<std::string> rehearsal_text(const std::string& experiment, int people, bool json,
                                   const std::function<bool()>& cancelled);

}  // namespace handrail
