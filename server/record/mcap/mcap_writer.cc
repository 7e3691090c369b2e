#include "server/record/mcap/mcap_writer.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

#include "server/record/mcap/mcap_bytes.h"

namespace handrail {
namespace {

constexpr int kFastest = 1;  // of zstd's levels

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// Both kept from one chunk to the next: memory that is got and given back ten times a second is
// mapped and unmapped, for which the system keeps all threads of the program waiting.
struct Compressor {
  Compressor() : context(ZSTD_createCCtx(), ZSTD_freeCCtx) {
    if (!context) throw std::bad_alloc();
  }
  std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context;
  std::string room;
};

std::string compressed(const std::string& plain) {
  thread_local Compressor compressor;
  std::string& room = compressor.room;
  room.resize(std::max(room.size(), ZSTD_compressBound(plain.size())));
  const std::size_t size = ZSTD_compressCCtx(compressor.context.get(), room.data(), room.size(),
                                             plain.data(), plain.size(), kFastest);
  // Only memory can be missing: the room always suffices.
  if (ZSTD_isError(size) != 0) throw std::runtime_error(ZSTD_getErrorName(size));
  return room.substr(0, size);
}

std::string numbers(const std::map<std::uint16_t, std::uint64_t>& values) {
  McapBytes out;
  for (const auto& [channel, value] : values) {
    out.number(channel);
    out.number(value);
  }
  return out.take();
}

}  // namespace

void McapChunkBuilder::add(const McapMessage& message) {
  if (messages_.empty()) first_ = last_ = message.log_time;
  first_ = std::min(first_, message.log_time);
  last_ = std::max(last_, message.log_time);
  McapBytes index;
  index.number(message.log_time);
  index.number(static_cast<std::uint64_t>(messages_.size()));
  indexes_[message.channel] += index.bytes();
  ++counts_[message.channel];
  McapBytes content;
  content.number(message.channel);
  content.number(message.sequence);
  content.number(message.log_time);
  content.number(message.publish_time);
  content.raw(message.data);
  McapBytes record;
  record.record(McapKind::kMessage, content.bytes());
  messages_ += record.bytes();
}

McapChunk McapChunkBuilder::close() {
  McapChunk out;
  out.first = first_;
  out.last = last_;
  out.plain = messages_.size();
  out.counts = std::exchange(counts_, {});
  const std::string packed = compressed(messages_);
  out.packed = packed.size();
  McapBytes content;
  content.number(first_);
  content.number(last_);
  content.number(out.plain);
  content.number(checksum(messages_));
  content.text("zstd");
  content.number(static_cast<std::uint64_t>(packed.size()));
  content.raw(packed);
  McapBytes bytes;
  bytes.record(McapKind::kChunk, content.bytes());
  out.length = bytes.size();
  for (const auto& [channel, entries] : indexes_) {
    out.index_at[channel] = bytes.size();
    McapBytes index;
    index.number(channel);
    index.text(entries);
    bytes.record(McapKind::kMessageIndex, index.bytes());
  }
  out.bytes = bytes.take();
  messages_.clear();
  indexes_.clear();
  return out;
}

std::string McapFile::kinds() const {
  McapBytes out;
  for (std::size_t i = 0; i < layout_.schemas.size(); ++i) {
    const McapSchema& schema = layout_.schemas[i];
    McapBytes content;
    content.number(static_cast<std::uint16_t>(i + 1));
    content.text(schema.name);
    content.text(schema.encoding);
    content.text(schema.data);
    out.record(McapKind::kSchema, content.bytes());
  }
  for (std::size_t i = 0; i < layout_.channels.size(); ++i) {
    const McapChannel& channel = layout_.channels[i];
    McapBytes content;
    content.number(static_cast<std::uint16_t>(i + 1));
    content.number(channel.schema);
    content.text(channel.topic);
    content.text(channel.encoding);
    content.text("");  // no metadata
    out.record(McapKind::kChannel, content.bytes());
  }
  return out.take();
}

std::string McapFile::begin() {
  McapBytes header;
  header.text("");  // no profile
  header.text(layout_.library);
  McapBytes out;
  out.raw(kMcapMagic);
  out.record(McapKind::kHeader, header.bytes());
  out.raw(kinds());
  size_ = out.size();
  return out.take();
}

void McapFile::add(const McapChunk& chunk) {
  Entry entry;
  entry.at = size_;
  entry.index_length = chunk.bytes.size() - chunk.length;
  entry.chunk.first = chunk.first;
  entry.chunk.last = chunk.last;
  entry.chunk.length = chunk.length;
  entry.chunk.plain = chunk.plain;
  entry.chunk.packed = chunk.packed;
  entry.chunk.index_at = chunk.index_at;
  entry.chunk.counts = chunk.counts;
  chunks_.push_back(std::move(entry));
  size_ += chunk.bytes.size();
}

std::string McapFile::end() const {
  McapBytes out;
  McapBytes data_end;
  data_end.number(std::uint32_t{0});  // no checksum of the data
  out.record(McapKind::kDataEnd, data_end.bytes());
  const std::uint64_t summary = size_ + out.size();
  out.raw(kinds());
  std::map<std::uint16_t, std::uint64_t> counts;
  std::uint64_t all = 0, first = 0, last = 0;
  for (const Entry& entry : chunks_) {
    const McapChunk& chunk = entry.chunk;
    std::map<std::uint16_t, std::uint64_t> places = chunk.index_at;
    for (auto& place : places) place.second += entry.at;
    McapBytes content;
    content.number(chunk.first);
    content.number(chunk.last);
    content.number(entry.at);
    content.number(chunk.length);
    content.text(numbers(places));
    content.number(entry.index_length);
    content.text("zstd");
    content.number(chunk.packed);
    content.number(chunk.plain);
    out.record(McapKind::kChunkIndex, content.bytes());
    first = all == 0 ? chunk.first : std::min(first, chunk.first);
    last = std::max(last, chunk.last);
    for (const auto& [channel, count] : chunk.counts) {
      counts[channel] += count;
      all += count;
    }
  }
  McapBytes statistics;
  statistics.number(all);
  statistics.number(static_cast<std::uint16_t>(layout_.schemas.size()));
  statistics.number(static_cast<std::uint32_t>(layout_.channels.size()));
  statistics.number(std::uint32_t{0});  // attachments
  statistics.number(std::uint32_t{0});  // metadata
  statistics.number(static_cast<std::uint32_t>(chunks_.size()));
  statistics.number(first);
  statistics.number(last);
  statistics.text(numbers(counts));
  out.record(McapKind::kStatistics, statistics.bytes());
  // The footer's checksum covers the summary and the footer up to it.
  McapBytes footer;
  footer.number(summary);
  footer.number(std::uint64_t{0});  // no table of the summary's parts
  const std::uint64_t footer_length = 20;
  McapBytes covered;
  covered.raw(std::string_view(out.bytes()).substr(static_cast<std::size_t>(summary - size_)));
  covered.number(static_cast<std::uint8_t>(McapKind::kFooter));
  covered.number(footer_length);
  covered.raw(footer.bytes());
  footer.number(checksum(covered.bytes()));
  out.record(McapKind::kFooter, footer.bytes());
  out.raw(kMcapMagic);
  return out.take();
}

}  // namespace handrail
