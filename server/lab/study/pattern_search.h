// Fits a population's free parameters to published medians.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "server/base/status.h"
#include "server/lab/study/population.h"

namespace handrail {

struct FitOptions {
  int operators = 40;
  std::uint64_t seed = 1001;  // other people than a study's with its default seed
  int threads = 0;
  int evaluations = 150;  // at most
  std::function<void(int evaluation, double misfit)> progress;
  const std::atomic<bool>* cancelled = nullptr;
};

struct FitResult {
  Population population;        // with the fitted medians, rounded to three digits in file's units
  std::vector<double> medians;  // reached, as the aims
  double misfit = 0.0;          // root mean square of the logarithms of median over aim
  int evaluations = 0;
};

// A candidate's medians, one for each aim and in its unit.
using MediansOf = std::function<Result<std::vector<double>>(const Population& candidate)>;

// Pattern search (Hooke and Jeeves 1961) over the logarithms of the free medians, within their
// bounds, from the middle of each: the present medians do not matter. Aims are above 0. The error
// is that of `medians_of`, or says that nothing is free. Same arguments, same answer.
Result<FitResult> fit_population(const Population& population, const std::vector<double>& aims,
                                 const MediansOf& medians_of, const FitOptions& options);

}  // namespace handrail
