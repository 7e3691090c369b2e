// Figures of wrench and gearshift, after Fig. 2.8 to 2.11 of the dissertation, as SVG files.
#pragma once

#include <string>

#include "server/base/status.h"
#include "server/lab/walls/wall_report_io.h"

namespace handrail {

// Write wrench.svg or gearshift.svg (the first person's run, whose trace was kept) and, with more
// than one person, wrench-people.svg or gearshift-people.svg (box plots of what was measured, the
// published scores beside them) into `folder`, which is made if it is not there. The error names
// what could not be written.
Status draw_wrench(const std::string& folder, const WallHeader& header, const Walls& walls,
                   const WrenchPath& path, const std::vector<WrenchResult>& people);
Status draw_gearshift(const std::string& folder, const WallHeader& header, const Walls& walls,
                      const GearGate& gate, const std::vector<GearshiftResult>& people);

}  // namespace handrail
