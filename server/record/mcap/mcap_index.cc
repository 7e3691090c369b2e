#include "server/record/mcap/mcap_index.h"

#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "server/record/mcap/mcap_bytes.h"

namespace handrail {
namespace {

constexpr std::uint64_t kRecordHead = 1 + 8;  // kind, length [bytes]
constexpr std::uint64_t kFooter = 8 + 8 + 4;  // what a footer has
constexpr std::uint64_t kChunkTimes = 8 + 8;  // what a chunk begins with
constexpr std::uint64_t kWindow = 4096;       // read at once while heads are looked for: a page
constexpr std::uint64_t kMostChannel = 63;    // a bit each; a recording has 20 at most
constexpr std::uint64_t kAllChannels = ~std::uint64_t{0};

std::string place_text(std::uint64_t at) { return "byte " + std::to_string(at) + ": "; }

std::uint32_t crc_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string hex_of(std::string_view bytes) {
  std::string out;
  for (const char c : bytes) {
    char two[4];
    std::snprintf(two, sizeof(two), "%02x ", static_cast<unsigned>(static_cast<unsigned char>(c)));
    out += two;
  }
  if (!out.empty()) out.pop_back();
  return out;
}

// Whether a file that begins so is one of MCAP's.
Status check_magic(std::string_view begin) {
  if (begin == kMcapMagic) return Status::ok();
  if (begin.empty()) {
    return Status::error(
        "is empty, expected a recording: an MCAP file of handrail-master or "
        "handrail-slave");
  }
  constexpr std::size_t kVersion = 5;  // of the magic's bytes
  const bool other = begin.size() == kMcapMagic.size() &&
                     begin.substr(0, kVersion) == kMcapMagic.substr(0, kVersion) &&
                     begin.substr(kVersion + 1) == kMcapMagic.substr(kVersion + 1);
  if (other) {
    return Status::error(
        "byte 5: is MCAP of version '" +
        std::string(1, begin[kVersion] < ' ' || begin[kVersion] > '~' ? '?' : begin[kVersion]) +
        "', expected '0'");
  }
  return Status::error("byte 0: begins with " + hex_of(begin) + ", expected " + hex_of(kMcapMagic) +
                       ": is no recording");
}

}  // namespace

// The bytes of a file around where one reads, a page at a time.
class McapIndex::Window {
 public:
  explicit Window(const FileBytes& file) : file_(file) {}
  // `size` bytes from `at` on; fewer at the file's end. `size` at most a page.
  Result<std::string_view> at(std::uint64_t at, std::uint64_t size) {
    if (at < from_ || at + size > from_ + bytes_.size()) {
      const std::uint64_t there = file_.size() - std::min(file_.size(), at);
      from_ = at;
      if (Status read = file_.read(at, std::min(there, kWindow), bytes_); !read) {
        bytes_.clear();
        return read;
      }
    }
    return std::string_view(bytes_).substr(static_cast<std::size_t>(at - from_),
                                           static_cast<std::size_t>(size));
  }

 private:
  const FileBytes& file_;
  std::uint64_t from_ = 0;
  std::string bytes_;
};

Result<McapIndex> McapIndex::of(const FileBytes& file) {
  std::string begin;
  const std::uint64_t size = std::min<std::uint64_t>(file.size(), kMcapMagic.size());
  if (Status read = file.read(0, size, begin); !read) return read;
  if (Status known = check_magic(begin); !known) return known;
  McapIndex out;
  if (out.summary(file)) return out;
  out = McapIndex();
  out.scan(file);
  return out;
}

// The index at the end. False where it is not whole: then nothing of it counts.
bool McapIndex::summary(const FileBytes& file) {
  const std::uint64_t tail = kRecordHead + kFooter + kMcapMagic.size();
  if (file.size() < kMcapMagic.size() + tail) return false;
  const std::uint64_t footer_at = file.size() - tail;
  std::string end;
  if (!file.read(footer_at, tail, end) || !end.ends_with(kMcapMagic)) return false;
  McapTake take(end);
  const auto kind = static_cast<McapKind>(take.number<std::uint8_t>());
  const auto length = take.number<std::uint64_t>();
  const auto from = take.number<std::uint64_t>();
  (void)take.number<std::uint64_t>();  // where the summary's own index begins
  const auto sum = take.number<std::uint32_t>();
  if (kind != McapKind::kFooter || length != kFooter || from < kMcapMagic.size() ||
      from > footer_at || footer_at - from > kLongestMcapRecord) {
    return false;
  }
  std::string records;
  if (!file.read(from, footer_at - from, records)) return false;
  // It covers the summary and the footer up to it.
  const std::size_t covered = static_cast<std::size_t>(kRecordHead + kFooter) - sizeof(sum);
  if (sum != 0 && crc_of(records + end.substr(0, covered)) != sum) return false;
  return take_summary(records, from);
}

bool McapIndex::take_summary(std::string_view records, std::uint64_t data_end) {
  for (std::string_view rest = records; !rest.empty();) {
    McapRecord record;
    if (!next_in_chunk(rest, record)) return false;
    if (record.kind == McapKind::kSchema && !take_schema(record.content, layout_)) return false;
    if (record.kind == McapKind::kChannel && !take_channel(record.content, layout_)) return false;
    if (record.kind != McapKind::kChunkIndex) continue;
    McapTake take(record.content);
    McapChunkPlace chunk;
    chunk.first = take.number<std::uint64_t>();
    chunk.last = take.number<std::uint64_t>();
    chunk.at = take.number<std::uint64_t>();
    chunk.length = take.number<std::uint64_t>();
    const std::string_view indexes = take.text();
    for (McapTake each(indexes); !each.rest().empty();) {
      const auto channel = each.number<std::uint16_t>();
      (void)each.number<std::uint64_t>();  // where that index is
      if (each.failed() || channel > kMostChannel) return false;
      chunk.channels |= std::uint64_t{1} << channel;
    }
    if (indexes.empty()) chunk.channels = kAllChannels;  // who wrote it made none
    const std::uint64_t before =
        chunks_.empty() ? kMcapMagic.size() : chunks_.back().at + chunks_.back().length;
    const bool sound = !take.failed() && chunk.at >= before && chunk.length > kRecordHead &&
                       chunk.length <= kRecordHead + kLongestMcapRecord && chunk.at < data_end &&
                       chunk.length <= data_end - chunk.at;
    if (!sound) return false;
    chunks_.push_back(chunk);
  }
  return !chunks_.empty();
}

// Takes the records one after another, and of chunks their beginnings alone.
void McapIndex::scan(const FileBytes& file) {
  Window window(file);
  std::uint64_t at = kMcapMagic.size();
  for (Status sound = Status::ok(); sound;) {
    const std::uint64_t begun = at;
    sound = scan_record(file, window, at);
    if (!sound) damage_ = place_text(begun) + sound.message();
  }
  for (McapChunkPlace& chunk : chunks_) {
    if (chunk.channels == 0) chunk.channels = kAllChannels;  // who wrote it made no index
  }
  // Of the last chunk some indexes may be missing: it is looked into.
  if (chunks_.empty()) return;
  chunks_.back().channels = 0;
  McapOpenChunk last;
  if (!open(file, chunks_.back(), last)) return;
  for (const McapMessage& message : last.messages) {
    if (message.channel <= kMostChannel) {
      chunks_.back().channels |= std::uint64_t{1} << message.channel;
    }
  }
}

// The record at `at`, which goes on to the next. The error: nothing more can be read.
Status McapIndex::scan_record(const FileBytes& file, Window& window, std::uint64_t& at) {
  if (at == file.size()) {
    return Status::error("the file has no end: it was cut, or is being written");
  }
  Status cut = Status::error("the file is cut within a record");
  if (file.size() - at < kRecordHead) return cut;
  const auto head = window.at(at, kRecordHead);
  if (!head) return head.status();
  McapTake take(*head);
  const auto kind = static_cast<McapKind>(take.number<std::uint8_t>());
  const auto length = take.number<std::uint64_t>();
  if (length > kLongestMcapRecord) {
    return Status::error("a record of " + std::to_string(length) + " bytes, expected at most " +
                         std::to_string(kLongestMcapRecord));
  }
  const std::uint64_t inside = at + kRecordHead;
  if (length > file.size() - inside) return cut;
  if (kind == McapKind::kFooter) return Status::error("the file's end before that of its data");
  if (kind == McapKind::kDataEnd) {
    return Status::error("the index at the file's end is not as it was written");
  }
  if (kind == McapKind::kSchema || kind == McapKind::kChannel) {
    std::string content;
    if (Status read = file.read(inside, length, content); !read) return read;
    Status taken =
        kind == McapKind::kSchema ? take_schema(content, layout_) : take_channel(content, layout_);
    if (!taken) return taken;
  }
  if (kind == McapKind::kChunk || kind == McapKind::kMessageIndex) {
    const auto begin = window.at(inside, std::min(length, kChunkTimes));
    if (!begin) return begin.status();
    if (Status taken = scan_chunk(kind, *begin, {at, kRecordHead + length}); !taken) return taken;
  }
  at = inside + length;
  return Status::ok();
}

// A chunk's beginning, or that of an index, which says of a channel that the chunk has it.
Status McapIndex::scan_chunk(McapKind kind, std::string_view begin, McapChunkPlace chunk) {
  McapTake take(begin);
  if (kind == McapKind::kChunk) {
    chunk.first = take.number<std::uint64_t>();
    chunk.last = take.number<std::uint64_t>();
    if (take.failed()) return Status::error("a chunk that is not whole");
    chunks_.push_back(chunk);
    return Status::ok();
  }
  const auto channel = take.number<std::uint16_t>();
  if (channel > kMostChannel) return Status::error("a channel's number over 63");
  if (!chunks_.empty()) chunks_.back().channels |= std::uint64_t{1} << channel;
  return Status::ok();
}

Status McapIndex::open(const FileBytes& file, const McapChunkPlace& chunk,
                       McapOpenChunk& out) const {
  out.messages.clear();
  const auto fail = [&chunk](const std::string& what) {
    return Status::error(place_text(chunk.at) + what);
  };
  std::string packed;
  if (Status read = file.read(chunk.at, chunk.length, packed); !read) return read;
  std::string_view record = packed;
  McapTake head(record);
  const auto kind = static_cast<McapKind>(head.number<std::uint8_t>());
  const std::string_view content = head.piece(head.number<std::uint64_t>());
  if (kind != McapKind::kChunk || head.failed() || !head.rest().empty()) {
    return fail("is no chunk, and the file's index says that one is here");
  }
  if (Status done = unpack_chunk(content, out.plain); !done) return fail(done.message());
  for (std::string_view inside = out.plain; !inside.empty();) {
    McapRecord next;
    if (Status sound = next_in_chunk(inside, next); !sound) return fail(sound.message());
    if (next.kind != McapKind::kMessage) continue;  // kinds that stand in a chunk are known before
    McapMessage message;
    if (Status taken = take_message(next.content, layout_, message); !taken) {
      return fail(taken.message());
    }
    out.messages.push_back(message);
  }
  return Status::ok();
}

}  // namespace handrail
