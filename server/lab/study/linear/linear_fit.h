// Fits the population's free parameters to mode NV's published medians, and to nothing else.
#pragma once

#include <vector>

#include "server/lab/study/pattern_search.h"
#include "server/lab/study/study_bench.h"

namespace handrail {

// The published measures' medians.
std::vector<FitAim> linear_aims();

// As fit_population() says, with the same operators for every candidate; the medians reached are
// those of the published measures. Mode V is never run. Same answer whatever the number of threads.
Result<FitResult> fit_linear(const StudyMachine& machine, const Population& population,
                             const FitOptions& options);

}  // namespace handrail
