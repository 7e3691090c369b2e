// What a suite of stability came to, for a person and for a program.
#pragma once

#include <string>
#include <vector>

#include "server/lab/stability/stability_case.h"

namespace handrail {

struct CaseRun {
  const StabilityCase* of = nullptr;
  std::uint64_t seed = 1;
  CaseOutcome came_to;

  bool refused() const { return !came_to.refused.empty(); }
  bool holds() const { return !refused() && all_hold(came_to.figures); }
  bool failed() const { return of->must_hold && !refused() && !holds(); }
};

// How to run it again: "--case NAME --seed S".
std::string again(const CaseRun& run);

// A row a family: how many runs hold of those that must, and of the others; then every run that
// must hold and does not, with its figures. `every`: all runs with all their figures instead.
std::string stability_table(const std::vector<CaseRun>& runs, bool every);

// A line of JSON a run.
std::string stability_json(const std::vector<CaseRun>& runs);

}  // namespace handrail
