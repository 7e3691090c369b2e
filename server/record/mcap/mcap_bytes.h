// Numbers and texts as MCAP has them. Part of writer and reader.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "server/record/mcap/mcap.h"

namespace handrail {

// Appends; nothing is bounded here.
class McapBytes {
 public:
  template <typename Number>
  void number(Number value) {
    static_assert(std::is_unsigned_v<Number>);
    for (std::size_t i = 0; i < sizeof(value); ++i) {
      bytes_ += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xff);
    }
  }
  void text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
  }
  void raw(std::string_view value) { bytes_ += value; }
  // A whole record.
  void record(McapKind kind, std::string_view content) {
    number(static_cast<std::uint8_t>(kind));
    number(static_cast<std::uint64_t>(content.size()));
    bytes_ += content;
  }

  std::size_t size() const { return bytes_.size(); }
  const std::string& bytes() const { return bytes_; }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// Takes from the front. After the first piece that is not there everything is 0 or empty, and
// failed() is true.
class McapTake {
 public:
  explicit McapTake(std::string_view bytes) : bytes_(bytes) {}

  template <typename Number>
  Number number() {
    const std::string_view raw = piece(sizeof(Number));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      value |= static_cast<std::uint64_t>(static_cast<std::uint8_t>(raw[i])) << (8 * i);
    }
    return static_cast<Number>(value);
  }
  std::string_view text() { return piece(number<std::uint32_t>()); }
  std::string_view piece(std::uint64_t size) {
    failed_ = failed_ || size > bytes_.size();
    if (failed_) return {};
    const std::string_view out = bytes_.substr(0, static_cast<std::size_t>(size));
    bytes_.remove_prefix(out.size());
    return out;
  }

  std::string_view rest() const { return failed_ ? std::string_view() : bytes_; }
  bool failed() const { return failed_; }

 private:
  std::string_view bytes_;
  bool failed_ = false;
};

}  // namespace handrail
