// Both sides' recordings of one time as one: how far their clocks are apart.
#pragma once

#include <cstdint>
#include <istream>
#include <string>

#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

struct RecordingJoin {
  // The slave's monotonic clock minus the master's [ns], by the datagrams with the shortest round
  // trips that either side saw.
  Nanos offset = 0;
  // It is right to this, whatever the two ways are like: half of the least round trip [ns].
  Nanos bound = 0;
  std::uint64_t measures = 0;  // datagrams it is from
  Nanos both = 0;              // time that both were recording [ns]
  std::uint64_t messages = 0;  // of the joined file, if one was written
};

// One of a master and one of a slave, in either order; they must be of one time. With `path` both
// are written there as one file, the slave's times on the master's calendar. The error says which
// is at fault and why.
Result<RecordingJoin> join_recordings(std::istream& first, std::istream& second,
                                      const std::string& path);

}  // namespace handrail
