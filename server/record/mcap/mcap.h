// What writer and reader of MCAP files share. The format: https://mcap.dev/spec, version 0; numbers
// are little-endian, a record is its kind (u8), its length (u64) and its content.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace handrail {

// At both ends of a file.
inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

// Kinds of records that are written or read here.
enum class McapKind : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kDataEnd = 0x0F,
};

// How the messages of a channel are to be read.
struct McapSchema {
  std::string name;      // of a protobuf schema: the message's full name
  std::string encoding;  // "protobuf"
  std::string data;      // of a protobuf schema: a FileDescriptorSet
};

struct McapChannel {
  std::uint16_t schema = 0;  // its number; 0: none
  std::string topic;
  std::string encoding;  // of the messages: "protobuf"
};

// What a file's messages are. The number of a schema or a channel is its place here, from 1.
struct McapLayout {
  std::string library;  // what has written the file
  std::vector<McapSchema> schemas;
  std::vector<McapChannel> channels;
};

struct McapMessage {
  std::uint16_t channel = 0;   // its number, as in McapLayout
  std::uint32_t sequence = 0;  // rises from message to message
  std::uint64_t log_time = 0;  // nanoseconds since 1970
  std::uint64_t publish_time = 0;
  std::string_view data;
};

}  // namespace handrail
