// handrail play FILE
#pragma once

#include <optional>
#include <string>

#include "server/base/status.h"

namespace handrail {

struct PlayWords {
  std::string file;  // of a recording
  std::optional<std::string> address,
      port;  // where a browser finds it; 127.0.0.1, any that is free
  bool json = false;
};

// Becomes handrail-console, from this program's own folder, with that recording: its output, its
// signals and its exit code are the program's. Returns only where that cannot be; the error names
// the option or the program at fault.
Status become_player(const PlayWords& words);

}  // namespace handrail
