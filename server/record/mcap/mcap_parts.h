// What is within the records of MCAP files. Part of the readers; nothing of it is believed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/base/status.h"
#include "server/record/mcap/mcap.h"

namespace handrail {

// A record, and a chunk after it was unpacked, is at most so long [bytes]. 64 MiB; chosen.
inline constexpr std::uint64_t kLongestMcapRecord = std::uint64_t{1} << 26;

// Put to their number in the layout, with empty ones where some were left out. The errors say what
// is not sound, without its place.
Status take_schema(std::string_view content, McapLayout& out);
Status take_channel(std::string_view content, McapLayout& out);
// A message's `data` lies in `content`. The error: the layout has no such channel, too.
Status take_message(std::string_view content, const McapLayout& layout, McapMessage& out);

// The records of a chunk, unpacked and held to their checksum.
Status unpack_chunk(std::string_view content, std::string& out);

// The next record of an unpacked chunk, which is taken from `inside`.
struct McapRecord {
  McapKind kind = McapKind::kHeader;
  std::string_view content;
};
Status next_in_chunk(std::string_view& inside, McapRecord& out);

}  // namespace handrail
