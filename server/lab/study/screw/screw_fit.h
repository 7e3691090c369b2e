// Fits the population's free parameters to what the dissertation implies for mode NC-NV, and to
// nothing else.
#pragma once

#include <vector>

#include "server/lab/study/pattern_search.h"
#include "server/lab/study/study_bench.h"

namespace handrail {

// The medians implied.
std::vector<FitAim> screw_aims();

// As fit_population() says, with the same operators for every candidate; the medians reached are
// those of the fitted measures. No other mode is ever run. Same answer whatever the number of
// threads.
Result<FitResult> fit_screw(const StudyMachine& machine, const Population& population,
                            const FitOptions& options);

}  // namespace handrail
