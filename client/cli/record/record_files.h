// What the command line says of recordings on this computer.
#pragma once

#include <string>

#include "server/base/status.h"

namespace handrail {

// A line each, the oldest first, or as JSON; of a folder without any so much is said. The error
// names a folder that cannot be read.
Result<std::string> recordings_text(const std::string& folder, bool json);

// Writes the sound part of `file` to `out`, a new file, and says what is in it. The error names the
// file at fault, and why.
Result<std::string> repair_text(const std::string& file, const std::string& out);

}  // namespace handrail
