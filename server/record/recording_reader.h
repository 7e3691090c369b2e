// What a recording says of any moment, without reading all that comes before it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "proto/record.pb.h"
#include "server/base/status.h"
#include "server/base/time.h"
#include "server/record/mcap/file_bytes.h"
#include "server/record/mcap/mcap_index.h"

namespace handrail {

// A mark, a stop, a fault, or a gap of the recording.
struct RecordingEvent {
  Nanos calendar = 0;  // [ns since 1970]
  pb::RecordedEvent event;
};

// The newest tick or cycle of a time, with the other side's state in it as far as it is known:
// most messages leave out one that has not changed.
struct RecordingMoment {
  Nanos calendar = 0;       // of the tick or cycle [ns since 1970]
  pb::RecordedTick tick;    // of a master's recording
  pb::RecordedCycle cycle;  // of a slave's
};

// Of a file that holds both sides the master's. What at() gives depends on file and time alone, and
// not on what was asked before. Keeps two chunks, the index (48 bytes a chunk) and the events; of
// the file no more is read than the chunks back to where the other side's state stands, 5 s at
// most. For one thread; blocks.
class RecordingReader {
 public:
  // What a file that is no usual one may cost: more are counted and left out.
  static constexpr std::size_t kMostEvents = 2000, kMostScenes = 256;

  // The error names path, place and what was expected.
  static Result<std::unique_ptr<RecordingReader>> open(const std::string& path);

  const std::string& path() const { return file_.path(); }
  const pb::RecordedStart& start() const { return start_; }
  bool of_master() const { return of_master_; }
  // Of the first and the last tick or cycle [ns since 1970].
  Nanos begins() const { return begins_; }
  Nanos ends() const { return ends_; }
  // In their order.
  const std::vector<RecordingEvent>& events() const { return events_; }
  std::size_t events_left_out() const { return left_out_; }
  // What ends the file before its end, and at which byte; empty: it is whole.
  const std::string& damage() const { return index_.damage(); }
  std::uint64_t bytes_read() const { return file_.taken(); }

  // Before the first the first, after the last the last. Valid until the next call. The error names
  // byte and cause; other moments may be sound.
  Result<const RecordingMoment*> at(Nanos calendar);
  // The scene that ticks name so.
  Result<pb::RecordedScene> scene(std::uint32_t number);

 private:
  struct Entry {
    Nanos calendar = 0;
    std::string_view bytes;
    bool image = false;  // the step's memory stands before it: the other side's state is in it
  };
  struct Opened {
    std::size_t chunk = kNone;
    McapOpenChunk content;
    std::vector<Entry> entries;
  };
  // The other side's state, and the number of the entry that it stands in.
  struct Other {
    std::uint64_t number = 0;
    std::optional<pb::SlaveDatagram> slave;
    std::optional<pb::MasterDatagram> master;
  };
  // The look back for it, entry by entry.
  struct LookBack {
    bool begun = false;
    std::uint64_t from = 0;  // number of the first entry that was looked at
    std::uint64_t next = 0;  // ... of the last
    bool ended = false;
    Other found;
  };
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  RecordingReader(FileBytes file, McapIndex index)
      : file_(std::move(file)), index_(std::move(index)) {}

  Status find_channels();
  std::uint16_t channel_of(const std::string& topic) const;
  Status read_heads();
  void take_event(const McapMessage& message);
  Status find_ends();
  Status open_chunk(std::size_t chunk, Opened& out);
  Status parse(const Opened& from, std::size_t entry, RecordingMoment& out) const;
  Status look_at(const Opened& in, std::size_t entry, LookBack& look);
  Status remember_before(std::size_t chunk);
  Status complete(std::size_t entry, RecordingMoment& out);
  std::uint64_t number_of(const RecordingMoment& of) const;
  bool knows_other(const RecordingMoment& of) const;
  bool has_other(const RecordingMoment& of) const;

  FileBytes file_;
  McapIndex index_;
  pb::RecordedStart start_;
  bool of_master_ = true;
  std::uint16_t entries_ = 0, images_ = 0, scenes_ = 0, events_channel_ = 0, starts_ = 0;
  std::vector<McapChunkPlace> chunks_;  // with entries, by their first time
  std::map<std::uint32_t, McapChunkPlace> scene_at_;
  std::vector<RecordingEvent> events_;
  std::size_t left_out_ = 0;
  Nanos begins_ = 0, ends_ = 0;
  Opened here_, before_;
  // What a look back from before that chunk finds: who plays on asks for it again and again.
  struct {
    std::size_t before = kNone;
    LookBack look;
  } memory_;
  RecordingMoment moment_, scratch_;
};

}  // namespace handrail
