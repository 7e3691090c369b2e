// Accuracy against time as figures.
#pragma once

#include <string>

#include "server/base/status.h"
#include "server/lab/scenes/row.h"

namespace handrail {

// Writes accuracy-CHOICE.svg for each choice into the folder, which is made where it is missing:
// error over cost, one series a method, the efficient settings joined and named.
Status draw_accuracy(const std::string& folder, const AccuracyRows& rows);

}  // namespace handrail
