#include "server/record/mcap/mcap_parts.h"

#include <zlib.h>
#include <zstd.h>

#include <utility>
#include <vector>

#include "server/record/mcap/mcap_bytes.h"

namespace handrail {
namespace {

// Puts `value` to its number, from 1, with empty ones where some were left out.
template <typename Value>
void put_at(std::uint16_t number, Value value, std::vector<Value>& out) {
  if (out.size() < number) out.resize(number);
  out[number - 1u] = std::move(value);
}

}  // namespace

Status take_schema(std::string_view content, McapLayout& out) {
  McapTake take(content);
  const auto number = take.number<std::uint16_t>();
  McapSchema schema{std::string(take.text()), std::string(take.text()), {}};
  schema.data = std::string(take.text());
  if (take.failed() || number == 0) return Status::error("a schema that is not whole");
  put_at(number, std::move(schema), out.schemas);
  return Status::ok();
}

Status take_channel(std::string_view content, McapLayout& out) {
  McapTake take(content);
  const auto number = take.number<std::uint16_t>();
  McapChannel channel;
  channel.schema = take.number<std::uint16_t>();
  channel.topic = std::string(take.text());
  channel.encoding = std::string(take.text());
  if (take.failed() || number == 0) return Status::error("a channel that is not whole");
  if (channel.schema > out.schemas.size()) {
    return Status::error("channel " + channel.topic + " of schema " +
                         std::to_string(channel.schema) + ", which the file does not tell of");
  }
  put_at(number, std::move(channel), out.channels);
  return Status::ok();
}

Status take_message(std::string_view content, const McapLayout& layout, McapMessage& out) {
  McapTake take(content);
  out.channel = take.number<std::uint16_t>();
  out.sequence = take.number<std::uint32_t>();
  out.log_time = take.number<std::uint64_t>();
  out.publish_time = take.number<std::uint64_t>();
  out.data = take.rest();
  if (take.failed()) return Status::error("a message without its beginning");
  const bool known = out.channel > 0 && out.channel <= layout.channels.size() &&
                     !layout.channels[out.channel - 1u].topic.empty();
  if (known) return Status::ok();
  return Status::error("a message of channel " + std::to_string(out.channel) +
                       ", which the file does not tell of");
}

Status unpack_chunk(std::string_view content, std::string& out) {
  McapTake take(content);
  (void)take.number<std::uint64_t>();  // first
  (void)take.number<std::uint64_t>();  // last
  const auto plain = take.number<std::uint64_t>();
  const auto sum = take.number<std::uint32_t>();
  const std::string_view packing = take.text();
  const std::string_view packed = take.piece(take.number<std::uint64_t>());
  if (take.failed()) return Status::error("a chunk that is not whole");
  if (plain > kLongestMcapRecord) {
    return Status::error("a chunk of " + std::to_string(plain) + " bytes, expected at most " +
                         std::to_string(kLongestMcapRecord));
  }
  if (packing == "zstd") {
    out.assign(static_cast<std::size_t>(plain), '\0');
    const std::size_t got = ZSTD_decompress(out.data(), out.size(), packed.data(), packed.size());
    if (ZSTD_isError(got) != 0 || got != plain) {
      return Status::error("a chunk that cannot be unpacked");
    }
  } else if (packing.empty()) {
    out = std::string(packed);
  } else {
    return Status::error("a chunk packed as '" + std::string(packing) +
                         "', expected zstd or nothing");
  }
  const auto found = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(out.data()), out.size()));
  // 0: the writer has made none.
  if (sum == 0 || sum == found) return Status::ok();
  return Status::error("a chunk that is not as it was written: its checksum differs");
}

Status next_in_chunk(std::string_view& inside, McapRecord& out) {
  McapTake rest(inside);
  out.kind = static_cast<McapKind>(rest.number<std::uint8_t>());
  out.content = rest.piece(rest.number<std::uint64_t>());
  if (rest.failed()) return Status::error("a record reaches beyond its chunk");
  inside = rest.rest();
  if (out.kind == McapKind::kChunk) return Status::error("a chunk within a chunk");
  return Status::ok();
}

}  // namespace handrail
