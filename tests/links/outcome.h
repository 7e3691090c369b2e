// What the operator on the near side writes down.
#pragma once

#include <string>

#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail::links {

// Moments are of the machine's monotonic clock, which both sides have.
struct NearOutcome {
  Nanos launched = 0;    // the master was started; the slave runs already
  Nanos started = 0;     // it said that it was ready: its hand began to move about then
  Nanos engaged_at = 0;  // both sides; 0: never
  Nanos ended = 0;
  int ends = 0;         // engagements that ended by themselves
  double behind = 0.0;  // arm's command from where the hand wants it, root of the mean square [mm]
};

std::string outcome_text(const NearOutcome& outcome);
// The error says what was expected.
Result<NearOutcome> read_outcome(const std::string& text);

}  // namespace handrail::links
