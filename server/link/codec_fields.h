// The fields of link.proto against the states they carry. Part of the codec.
#pragma once

#include "proto/link.pb.h"
#include "server/link/reject.h"
#include "server/model/link_state.h"

namespace handrail {

// Writes every field of `s` into the cleared message `m`, behind the header's.
void put(const MasterState& s, pb::MasterDatagram& m);
void put(const SlaveState& s, pb::SlaveDatagram& m);

// True when every field of the state is there, repeated ones with their number of elements.
bool present(const pb::MasterDatagram& m);
bool present(const pb::SlaveDatagram& m);

// Reads a message whose fields are present, normalising quaternions; codes out of range come out as
// kCount. Says what no state can hold: kScene a name that is too long, kRange a mark that is none,
// kSurface one of no stiffness that is somewhere; nothing else is checked.
Reject take(const pb::MasterDatagram& m, MasterState& s);
// True when each tool's hash is that of the definition taken. A slave sends no tools.
bool tools_match(const pb::MasterDatagram& m, const MasterState& s);
inline bool tools_match(const pb::SlaveDatagram&, const SlaveState&) { return true; }
Reject take(const pb::SlaveDatagram& m, SlaveState& s);

}  // namespace handrail
