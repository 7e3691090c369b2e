// Where what stands in an MCAP file, so that a time is found without reading all before it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/record/mcap/file_bytes.h"
#include "server/record/mcap/mcap.h"
#include "server/record/mcap/mcap_parts.h"

namespace handrail {

// A chunk of the file, without its content.
struct McapChunkPlace {
  std::uint64_t at = 0, length = 0;   // of its record [bytes]
  std::uint64_t first = 0, last = 0;  // log times of its messages [ns since 1970]
  std::uint64_t channels = 0;         // whose messages it has, a bit for each number

  bool has(std::uint16_t channel) const { return channel < 64 && (channels >> channel & 1u) != 0; }
};

// An open chunk. The messages' `data` lie in `plain`.
struct McapOpenChunk {
  std::string plain;
  std::vector<McapMessage> messages;
};

// Of a file with its end the index that stands there; of one that was cut, or is being written, one
// that is made of the records' beginnings, up to where they are sound. 48 bytes a chunk are kept.
class McapIndex {
 public:
  // The error says what the file is instead, and at which byte.
  static Result<McapIndex> of(const FileBytes& file);

  const McapLayout& layout() const { return layout_; }
  // In the file's order.
  const std::vector<McapChunkPlace>& chunks() const { return chunks_; }
  // What ends the file before its end, and at which byte; empty: it is whole.
  const std::string& damage() const { return damage_; }

  // The error names byte and cause.
  Status open(const FileBytes& file, const McapChunkPlace& chunk, McapOpenChunk& out) const;

 private:
  bool summary(const FileBytes& file);
  bool take_summary(std::string_view records, std::uint64_t data_end);
  class Window;
  void scan(const FileBytes& file);
  Status scan_record(const FileBytes& file, Window& window, std::uint64_t& at);
  Status scan_chunk(McapKind kind, std::string_view begin, McapChunkPlace chunk);

  McapLayout layout_;
  std::vector<McapChunkPlace> chunks_;
  std::string damage_;
};

}  // namespace handrail
