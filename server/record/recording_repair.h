// A recording that was cut, as a whole file again.
#pragma once

#include <cstdint>
#include <istream>
#include <string>

#include "server/base/status.h"

namespace handrail {

struct RepairedRecording {
  std::uint64_t messages = 0;  // that were sound, and are in the copy
  double seconds = 0.0;        // from the first to the last
  std::string damage;          // what ended the reading; empty: the file was whole
};

// Writes all that is sound of `in` to a new file at `path`, with an index. The error says what of
// either cannot be read or written; then there is no file. Whatever wrote the recording: nothing is
// asked of its messages.
Result<RepairedRecording> repair_recording(std::istream& in, const std::string& path);

}  // namespace handrail
