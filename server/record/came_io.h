// What came of a recorded tick, back from its message: for who shows it.
#pragma once

#include "proto/record.pb.h"
#include "server/base/status.h"
#include "server/record/record_tap.h"

namespace handrail {

// All that put() has written of a tick: its inputs into `out.given`, as take() has them, its
// outputs into `out.came` and `out.turned`. What a message does not have is as if it were not
// known: what the link was like over the last second, the orientations between hand and command
// (they are the command's), and how the force was shared. Of that only the ledger's stages are
// there: `shares` has tool, walls and clamp as the tool's, the spring as it was asked for, and all
// that changed them as limited; they add up. The error names the field that is missing or no value
// of its kind. May allocate.
Status take_all(const pb::RecordedTick& in, KeptTick& out);

// Of a cycle its inputs, and the state that the slave told.
Status take_all(const pb::RecordedCycle& in, KeptCycle& out);

}  // namespace handrail
