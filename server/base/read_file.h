// Files that a user names, read whole.
#pragma once

#include <string>

#include "server/base/status.h"

namespace handrail {

// The whole of a regular file of at most `max_bytes`. The error names path and cause.
Result<std::string> read_file(const std::string& path, std::size_t max_bytes);

}  // namespace handrail
