#include "server/record/mcap/mcap_reader.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>

#include "server/record/mcap/mcap_bytes.h"

namespace handrail {
namespace {

constexpr std::size_t kPiece = std::size_t{1}
                               << 16;  // of what a length promises, at a time [bytes]

// At most `size` bytes, in pieces: a length that lies costs no more memory than the file is long.
bool read_some(std::istream& in, std::uint64_t size, std::string& out) {
  out.clear();
  while (out.size() < size) {
    const std::size_t piece =
        std::min<std::size_t>(kPiece, static_cast<std::size_t>(size) - out.size());
    const std::size_t before = out.size();
    out.resize(before + piece);
    in.read(out.data() + before, static_cast<std::streamsize>(piece));
    const auto got = static_cast<std::size_t>(in.gcount());
    out.resize(before + got);
    if (got < piece) return false;
  }
  return true;
}

// Puts `value` to its number, from 1, with empty ones where some were left out.
template <typename Value>
void put_at(std::uint16_t number, Value value, std::vector<Value>& out) {
  if (out.size() < number) out.resize(number);
  out[number - 1u] = std::move(value);
}

}  // namespace

void McapReader::fail(const std::string& what) {
  if (damage_.empty()) damage_ = "byte " + std::to_string(at_) + ": " + what;
  ended_ = true;
  inside_ = {};
}

bool McapReader::begin() {
  if (begun_) return !ended_;
  begun_ = true;
  if (!read_some(in_, kMcapMagic.size(), buffer_) || buffer_ != kMcapMagic) {
    fail("expected the beginning of an MCAP file");
    return false;
  }
  read_ = at_ = buffer_.size();
  return true;
}

std::optional<McapReader::Record> McapReader::record() {
  at_ = read_;
  std::string head;
  if (!read_some(in_, 9, head)) {
    fail(head.empty() ? "the file has no end: it was cut, or is being written"
                      : "the file is cut within a record");
    return std::nullopt;
  }
  McapTake take(head);
  const auto kind = static_cast<McapKind>(take.number<std::uint8_t>());
  const auto length = take.number<std::uint64_t>();
  if (length > kLongest) {
    fail("a record of " + std::to_string(length) + " bytes, expected at most " +
         std::to_string(kLongest));
    return std::nullopt;
  }
  if (!read_some(in_, length, buffer_)) {
    fail("the file is cut within a record");
    return std::nullopt;
  }
  read_ += head.size() + buffer_.size();
  return Record{kind, buffer_};
}

std::optional<McapMessage> McapReader::next() {
  if (!begin()) return std::nullopt;
  while (!ended_) {
    if (inside_.empty()) {
      sound_ = read_;
      const auto found = record();
      if (!found) return std::nullopt;
      if (auto out = take(*found)) return out;
      continue;
    }
    McapTake rest(inside_);
    const auto kind = static_cast<McapKind>(rest.number<std::uint8_t>());
    const std::string_view content = rest.piece(rest.number<std::uint64_t>());
    if (rest.failed()) {
      fail("a record reaches beyond its chunk");
      return std::nullopt;
    }
    inside_ = rest.rest();
    if (kind == McapKind::kChunk) {
      fail("a chunk within a chunk");
      return std::nullopt;
    }
    if (auto out = take({kind, content})) return out;
  }
  return std::nullopt;
}

std::optional<McapMessage> McapReader::take(const Record& record) {
  switch (record.kind) {
    case McapKind::kSchema: schema(record.content); break;
    case McapKind::kChannel: channel(record.content); break;
    case McapKind::kMessage: return message(record.content);
    case McapKind::kChunk: chunk(record.content); break;
    case McapKind::kDataEnd:
      ended_ = complete_ = true;
      sound_ = read_;
      break;
    case McapKind::kFooter: fail("the file's end before that of its data"); break;
    default: break;  // nothing that is needed here
  }
  return std::nullopt;
}

std::optional<McapMessage> McapReader::message(std::string_view content) {
  McapTake take(content);
  McapMessage out;
  out.channel = take.number<std::uint16_t>();
  out.sequence = take.number<std::uint32_t>();
  out.log_time = take.number<std::uint64_t>();
  out.publish_time = take.number<std::uint64_t>();
  out.data = take.rest();
  if (take.failed()) {
    fail("a message without its beginning");
    return std::nullopt;
  }
  const bool known = out.channel > 0 && out.channel <= layout_.channels.size() &&
                     !layout_.channels[out.channel - 1u].topic.empty();
  if (!known) {
    fail("a message of channel " + std::to_string(out.channel) +
         ", which the file does not tell of");
    return std::nullopt;
  }
  return out;
}

void McapReader::schema(std::string_view content) {
  McapTake take(content);
  const auto number = take.number<std::uint16_t>();
  McapSchema out{std::string(take.text()), std::string(take.text()), {}};
  out.data = std::string(take.text());
  if (take.failed() || number == 0) return fail("a schema that is not whole");
  put_at(number, std::move(out), layout_.schemas);
}

void McapReader::channel(std::string_view content) {
  McapTake take(content);
  const auto number = take.number<std::uint16_t>();
  McapChannel out;
  out.schema = take.number<std::uint16_t>();
  out.topic = std::string(take.text());
  out.encoding = std::string(take.text());
  if (take.failed() || number == 0) return fail("a channel that is not whole");
  if (out.schema > layout_.schemas.size()) {
    return fail("channel " + out.topic + " of schema " + std::to_string(out.schema) +
                ", which the file does not tell of");
  }
  put_at(number, std::move(out), layout_.channels);
}

void McapReader::chunk(std::string_view content) {
  McapTake take(content);
  (void)take.number<std::uint64_t>();  // first
  (void)take.number<std::uint64_t>();  // last
  const auto plain = take.number<std::uint64_t>();
  const auto sum = take.number<std::uint32_t>();
  const std::string_view packing = take.text();
  const std::string_view packed = take.piece(take.number<std::uint64_t>());
  if (take.failed()) return fail("a chunk that is not whole");
  if (plain > kLongest) {
    return fail("a chunk of " + std::to_string(plain) + " bytes, expected at most " +
                std::to_string(kLongest));
  }
  if (packing == "zstd") {
    unpacked_.assign(static_cast<std::size_t>(plain), '\0');
    const std::size_t got =
        ZSTD_decompress(unpacked_.data(), unpacked_.size(), packed.data(), packed.size());
    if (ZSTD_isError(got) != 0 || got != plain) return fail("a chunk that cannot be unpacked");
  } else if (packing.empty()) {
    unpacked_ = std::string(packed);
  } else {
    return fail("a chunk packed as '" + std::string(packing) + "', expected zstd or nothing");
  }
  const auto found = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(unpacked_.data()), unpacked_.size()));
  // 0: the writer has made none.
  if (sum != 0 && sum != found)
    return fail("a chunk that is not as it was written: its checksum differs");
  inside_ = unpacked_;
}

const McapSchema* McapReader::schema_of(std::uint16_t channel) const {
  if (channel == 0 || channel > layout_.channels.size()) return nullptr;
  const std::uint16_t schema = layout_.channels[channel - 1u].schema;
  return schema == 0 ? nullptr : &layout_.schemas[schema - 1u];
}

}  // namespace handrail
