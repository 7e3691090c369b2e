// From what was written down of people at a gearshift or a wrench to a table, JSON and drawings.
#pragma once

#include <string>
#include <vector>

#include "client/experiment/experiment_file_io.h"
#include "server/base/status.h"

namespace handrail {

// Of the trials that count: practice and interrupted ones are left out, failed ones are the worst
// rank. And of the questionnaires; simulated people have none. All people are simulated, or none.
std::string wall_results_text(const std::vector<ExperimentRecord>& people, bool json);

// Box plots of the same as EXPERIMENT-people.svg, into a folder that exists. The error names what
// could not be written.
Status draw_wall_results(const std::string& folder, const std::vector<ExperimentRecord>& people);

}  // namespace handrail
