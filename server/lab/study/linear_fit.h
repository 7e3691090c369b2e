// Fits the population's free parameters to mode NV's published medians, and to nothing else.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "server/lab/study/linear_figure.h"

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
  Population population;  // with the fitted medians, rounded to three digits in the file's units
  std::array<double, kPublishedFigures> medians{};  // of NV [SI]
  double misfit = 0.0;  // root mean square of the logarithms of median over published
  int evaluations = 0;
};

// Pattern search (Hooke and Jeeves 1961) over the logarithms of the free medians, within their
// bounds, from the middle of each: the present medians do not matter. The same operators meet every
// candidate. Mode V is never run. Same arguments, same answer, whatever the number of threads.
Result<FitResult> fit_linear(const StudyMachine& machine, const Population& population,
                             const FitOptions& options);

}  // namespace handrail
