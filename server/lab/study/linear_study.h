// The linear-movement study (dissertation 3.4.1): every operator in both modes.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "server/lab/study/linear_trial.h"
#include "server/lab/study/population.h"

namespace handrail {

struct StudyOptions {
  int operators = 7;
  int trials = 2;    // successful ones wanted of each operator in each mode
  int practice = 1;  // trials in each mode before: they count as practice and are not run
  std::uint64_t seed = 1;
  int threads = 0;         // 0: one a core
  bool with_tools = true;  // false: mode NV alone, as the fit needs it
  bool tools_act = true;
  int traced = 0;  // operators, from the first, of whose trials the traces are kept
  std::function<void(std::size_t done)> progress;  // operators done, from one thread at a time
  const std::atomic<bool>* cancelled = nullptr;
};

struct StudyTrial {
  int person = 0;  // from 0
  StudyMode mode = StudyMode::kFree;
  // Among all this operator makes, practice included, from 1. The second mode's start where they
  // would without failures in the first.
  int number = 1;
  int attempt = 1;  // among the counted ones in this mode, from 1
  TrialResult result;
};

struct StudyResult {
  std::vector<StudyTrial> trials;  // counted ones: by operator, in the order made
  double simulated_time = 0.0;     // of everything run [s]
};

// Each operator is drawn from the population, works with an arm of its own (joint lags drawn from
// the rig's spread) and meets the modes in random order, trials until `trials` have succeeded or
// three times as many were made. All that one trial leaves behind for the next is practice, which
// shortens the pause for decisions; so practice trials are counted, not run. Operator i of a seed
// is the same whatever the number of operators or threads. The error says what the machine lacks,
// or that it was cancelled.
Result<StudyResult> run_linear_study(const StudyMachine& machine, const Population& population,
                                     const StudyOptions& options);

}  // namespace handrail
