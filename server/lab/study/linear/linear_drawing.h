// The study's figures, after Fig. 3.10 and Fig. 3.11 of the dissertation, as SVG files.
#pragma once

#include <string>

#include "server/base/status.h"
#include "server/lab/study/linear/linear_study.h"
#include "server/model/linear_task.h"

namespace handrail {

// Writes linear-movement-measures.svg (box plots of the four measures in both modes, with the
// published medians) and linear-movement-trajectories.svg (the first successful trial of the first
// traced operator in each mode: seen along X, and from above) into `folder`, which exists. The
// error names what could not be written.
Status draw_linear(const std::string& folder, const StudyHeader& header, const LinearStudy& study,
                   const LinearTask& task);

}  // namespace handrail
