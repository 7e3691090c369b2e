// Screw-fastening studies made by hand, for tests.
#pragma once

#include "server/base/units.h"
#include "server/lab/study/screw/screw_study.h"

namespace handrail {

// One trial: `time` s, `path_mm`, a mean force of `force` N with twice that at most.
inline ScrewStudyTrial screw_trial(int person, ScrewMode mode, double time, double path_mm,
                                   double force, ScrewEnd end = ScrewEnd::kDone) {
  ScrewStudyTrial out;
  out.person = person;
  out.mode = mode;
  out.result.end = end;
  out.result.completion_time = time;
  out.result.measured = {path_mm * kMm, force, 2.0 * force, 8.0 * force, 8.0};
  out.result.misses = 2;
  return out;
}

// Five people, one trial in each mode. Tools take 20 % off times and 40 % off paths, protection
// half of the force; person k is k times 1 % slower, goes k times 1 % further and pushes k times 1
// % harder.
inline ScrewStudy five_people() {
  ScrewStudy out;
  for (int person = 0; person < 5; ++person) {
    const double own = 1.0 + 0.01 * person;
    for (int i = 0; i < kScrewModes; ++i) {
      const auto mode = static_cast<ScrewMode>(i);
      out.trials.push_back(screw_trial(person, mode, 40.0 * own * (has_tools(mode) ? 0.8 : 1.0),
                                       250.0 * own * (has_tools(mode) ? 0.6 : 1.0),
                                       50.0 * own * (has_protection(mode) ? 0.5 : 1.0)));
    }
  }
  return out;
}

// The trial of a person in a mode of five_people().
inline ScrewResult& result_of(ScrewStudy& study, int person, ScrewMode mode) {
  return study.trials[static_cast<std::size_t>(person * kScrewModes + static_cast<int>(mode))]
      .result;
}

}  // namespace handrail
