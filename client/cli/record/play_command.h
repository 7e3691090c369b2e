// handrail play FILE
#pragma once

#include <optional>
#include <string>

#include "server/base/status.h"

namespace handrail {

struct PlayWords {
  std::string file;  // of a recording
  // Where a browser finds it, as handrail-console has it; empty: this computer, any free port.
  std::optional<std::string> listen;
  bool json = false;
};

// Becomes handrail-console, from this program's own folder, with that recording: its output, its
// signals and its exit code are the program's. Returns only where that cannot be; the error names
// the option or the program at fault.
Status become_player(const PlayWords& words);

}  // namespace handrail
