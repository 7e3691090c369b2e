// The screw-fastening study's figures, after Fig. 3.13 to 3.15 of the dissertation, as SVG files.
#pragma once

#include <string>

#include "server/base/status.h"
#include "server/lab/study/screw/screw_study.h"
#include "server/model/simulate.h"

namespace handrail {

// Writes into `folder`, which exists: screw-fastening-measures.svg (box plots of time, path, mean
// and largest force in all modes, with the medians implied), screw-fastening-trajectories.svg and
// screw-fastening-forces.svg (the first successful trial of the first traced operator in each mode:
// the tip from the operator's left; contact and spring force along the screw against time; both
// only where there is a trace). The error names what could not be written.
Status draw_screw(const std::string& folder, const StudyHeader& header, const ScrewStudy& study,
                  const HexSocketSpec& socket);

}  // namespace handrail
