// Writes MCAP files: messages become chunks, chunks a file that can be read up to its last chunk
// whatever happens to its end.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/record/mcap/mcap.h"

namespace handrail {

// Messages of a short time, compressed, as they stand in a file of whatever else.
struct McapChunk {
  std::uint64_t first = 0, last = 0;  // log time of its messages [ns since 1970]
  std::string bytes;                  // the chunk, then an index for each of its channels
  std::uint64_t length = 0;           // of the chunk's own record [bytes]
  std::uint64_t plain = 0;            // of its messages, uncompressed [bytes]
  std::uint64_t packed = 0;           // compressed [bytes]
  std::map<std::uint16_t, std::uint64_t>
      index_at;                                   // of each channel's index, from the chunk's start
  std::map<std::uint16_t, std::uint64_t> counts;  // messages of each channel
};

// Gathers messages, in the order of their log times. For one thread; may allocate.
class McapChunkBuilder {
 public:
  void add(const McapMessage& message);
  bool empty() const { return messages_.empty(); }
  std::uint64_t first() const { return first_; }
  // What was gathered, compressed with zstd at its fastest level, with its checksum; then gathers
  // anew. Not to be called while empty.
  McapChunk close();

 private:
  std::string messages_;
  std::map<std::uint16_t, std::string> indexes_;
  std::map<std::uint16_t, std::uint64_t> counts_;
  std::uint64_t first_ = 0, last_ = 0;
};

// The bytes of one file, piece by piece; who calls writes them, in this order, whole.
class McapFile {
 public:
  explicit McapFile(McapLayout layout) : layout_(std::move(layout)) {}

  // Before all else.
  std::string begin();
  // `chunk.bytes` come next.
  void add(const McapChunk& chunk);
  // After the last chunk: what lets a reader find a time without reading all.
  std::string end() const;
  // Length of all so far [bytes].
  std::uint64_t size() const { return size_; }

 private:
  struct Entry {
    std::uint64_t at = 0;
    McapChunk chunk;  // without its bytes
    std::uint64_t index_length = 0;
  };
  std::string kinds() const;

  McapLayout layout_;
  std::vector<Entry> chunks_;
  std::uint64_t size_ = 0;
};

}  // namespace handrail
