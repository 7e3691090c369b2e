// Inputs of the fuzzers that read recordings.
#pragma once

#include <algorithm>
#include <string>

#include "server/record/mcap/mcap_writer.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail::fuzz {

// The input as a file; or, where it begins with 'm', as the messages of one of that layout: for
// each its channel (a byte), its length (two), its content. So the fuzzer need not find checksums.
inline std::string recording_of(Bytes bytes, const McapLayout& layout) {
  if (bytes.empty() || bytes[0] != 'm') return std::string(text_of(bytes));
  bytes = bytes.subspan(1);
  McapFile file(layout);
  std::string out = file.begin();
  McapChunkBuilder chunk;
  for (std::uint32_t sequence = 1; bytes.size() >= 3; ++sequence) {
    const auto channel = static_cast<std::uint16_t>(1 + bytes[0] % layout.channels.size());
    const std::size_t length = std::min<std::size_t>(bytes[1] + 256u * bytes[2], bytes.size() - 3);
    chunk.add({channel, sequence, sequence, sequence, text_of(bytes.subspan(3, length))});
    bytes = bytes.subspan(3 + length);
  }
  if (chunk.empty()) return out;
  const McapChunk closed = chunk.close();
  file.add(closed);
  return out + closed.bytes + file.end();
}

}  // namespace handrail::fuzz
