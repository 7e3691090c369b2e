#include "server/record/mcap/mcap_reader.h"

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

std::optional<McapRecord> McapReader::record() {
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
  return McapRecord{kind, buffer_};
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
    McapRecord inside;
    if (const Status sound = next_in_chunk(inside_, inside); !sound) {
      fail(sound.message());
      return std::nullopt;
    }
    if (auto out = take(inside)) return out;
  }
  return std::nullopt;
}

std::optional<McapMessage> McapReader::take(const McapRecord& record) {
  switch (record.kind) {
    case McapKind::kSchema: hold(take_schema(record.content, layout_)); break;
    case McapKind::kChannel: hold(take_channel(record.content, layout_)); break;
    case McapKind::kMessage: return message(record.content);
    case McapKind::kChunk:
      if (hold(unpack_chunk(record.content, unpacked_))) inside_ = unpacked_;
      break;
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
  McapMessage out;
  if (!hold(take_message(content, layout_, out))) return std::nullopt;
  return out;
}

bool McapReader::hold(const Status& sound) {
  if (!sound) fail(sound.message());
  return sound.is_ok();
}

const McapSchema* McapReader::schema_of(std::uint16_t channel) const {
  if (channel == 0 || channel > layout_.channels.size()) return nullptr;
  const std::uint16_t schema = layout_.channels[channel - 1u].schema;
  return schema == 0 ? nullptr : &layout_.schemas[schema - 1u];
}

}  // namespace handrail
