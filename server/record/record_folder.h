// The folder that recordings stand in: their names, and which of them go.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// The end of every recording's name.
inline constexpr std::string_view kRecordingExtension = ".mcap";

struct RecordingEntry {
  std::string file;         // its path
  std::uint64_t bytes = 0;  // as long as it is
  Nanos written = 0;        // when last, since 1970
};

// The recordings of a folder, the oldest first; of none that cannot be read. May block.
std::vector<RecordingEntry> recordings_in(const std::string& folder);

// "20261128T012821.345Z-master-LABEL.mcap"; without a label the last part is left out.
std::string recording_name(Nanos calendar, const std::string& side, const std::string& label);

// True for a file's name as recording_name() makes it for that side.
bool is_recording_of(const std::string& side, const std::string& file);

// Of what recording_name() has named for that side: removes the oldest until those that are left
// have at most `most_bytes` together, and all that were written before `oldest`; never `but`, and
// nothing that somebody else has put there. Returns the names of those that went. May block.
std::vector<std::string> prune(const std::string& folder, const std::string& side,
                               std::uint64_t most_bytes, Nanos oldest, const std::string& but);

}  // namespace handrail
