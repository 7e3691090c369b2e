// Reads MCAP files from their beginning, as far as they are sound.
#pragma once

#include <cstdint>
#include <istream>
#include <optional>
#include <string>

#include "server/base/status.h"
#include "server/record/mcap/mcap.h"
#include "server/record/mcap/mcap_parts.h"

namespace handrail {

// Takes a file record by record, in the order in which it was written, and needs nothing of its
// end: one that was cut at any byte gives all that stands before the chunk that was cut. Nothing of
// what the file says is believed: lengths are held to what can be there, a chunk to its checksum.
// May allocate; a record is at most kLongest, a chunk at most that after it was unpacked.
class McapReader {
 public:
  static constexpr std::uint64_t kLongest = kLongestMcapRecord;

  // `in` must outlive the reader and be read by nobody else.
  explicit McapReader(std::istream& in) : in_(in) {}

  // The next message, its `data` valid until the next call; nothing at the end, or where the file
  // is not sound: damage() tells.
  std::optional<McapMessage> next();

  // The schemas and channels so far: those of a message that was given are there. A number that the
  // file has left out is there with an empty name.
  const McapLayout& layout() const { return layout_; }
  // A message's schema; null if it has none.
  const McapSchema* schema_of(std::uint16_t channel) const;
  // The file said that it ends here, and had all its parts.
  bool complete() const { return complete_; }
  // What was not sound, and at which byte; empty while nothing was. A file without its end is said
  // here, too.
  const std::string& damage() const { return damage_; }
  // Where the chunk of the newest message begins, or its record: all before it was sound [bytes].
  std::uint64_t sound() const { return sound_; }

 private:
  bool begin();
  // The next record of the file itself, in `buffer_`.
  std::optional<McapRecord> record();
  std::optional<McapMessage> take(const McapRecord& record);
  std::optional<McapMessage> message(std::string_view content);
  // What is not sound ends the file.
  bool hold(const Status& sound);
  void fail(const std::string& what);

  std::istream& in_;
  McapLayout layout_;
  std::string buffer_;
  std::string unpacked_;     // the chunk that is being read
  std::string_view inside_;  // what is left of it
  std::uint64_t at_ = 0;     // of the record that is being read [bytes]
  std::uint64_t read_ = 0;   // so far [bytes]
  std::uint64_t sound_ = 0;
  bool begun_ = false;
  bool ended_ = false;
  bool complete_ = false;
  std::string damage_;
};

}  // namespace handrail
