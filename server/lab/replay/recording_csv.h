// A recording as a table.
#pragma once

#include <cstdint>
#include <istream>
#include <ostream>

#include "server/base/status.h"

namespace handrail {

// A row a tick or cycle, after a line with the columns' names, which carry their units; `hz` > 0:
// at most so many a second, the nearest ticks; `trial` > 0: from the mark `trial begins: ...` to
// `trial ends: ...` of that trial of the experiment alone, its times from its first row. Returns
// the number of rows. The error says what of the file is no recording, or that `out` takes no more.
Result<std::uint64_t> write_recording_csv(std::istream& in, std::ostream& out, double hz,
                                          int trial = 0);

// A row a datagram, in the file's order: when it was taken from its socket or given to it, whence
// or where to, its length [bytes] and what is kept of it, in hexadecimal digits. Times are from the
// first of them. Returns and errors as above.
Result<std::uint64_t> write_packets_csv(std::istream& in, std::ostream& out);

}  // namespace handrail
