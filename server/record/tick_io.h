// What was kept of a tick or cycle, as a message and back: exact, to the bit.
#pragma once

#include "proto/record.pb.h"
#include "server/record/record_tap.h"

namespace handrail {

// Every field, the other side's state too, as far as it is known. May allocate.
void put(const KeptTick& tick, pb::RecordedTick& out);
void put(const KeptCycle& cycle, pb::RecordedCycle& out);

// What was given to the step. A message without the other side's state leaves that of `out` as it
// is, unless none is known. The error names the field that is missing or no value of its kind.
Status take(const pb::RecordedTick& in, KeptTick& out);
Status take(const pb::RecordedCycle& in, KeptCycle& out);

}  // namespace handrail
