#include "server/record/recording_reader.h"

#include <algorithm>
#include <utility>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr std::size_t kMostBadEnds = 100;  // chunks at either end that are not sound; chosen
// Ticks or cycles that the other side's state is looked for: every 5 s it stands with an image, and
// a tick is a millisecond. Twice that.
constexpr std::uint64_t kMostBack = 10'000;

template <typename Message>
bool parse_bytes(std::string_view bytes, Message& out) {
  return out.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
}

Status no_message(const google::protobuf::Message& type) {
  return Status::error("a message that is no " + type.GetTypeName());
}

}  // namespace

Result<std::unique_ptr<RecordingReader>> RecordingReader::open(const std::string& path) {
  auto file = FileBytes::open(path);
  if (!file) return file.status();
  const auto at_path = [&path](const Status& why) {
    return Status::error(path + ": " + why.message());
  };
  auto index = McapIndex::of(*file);
  if (!index) return at_path(index.status());
  std::unique_ptr<RecordingReader> out(new RecordingReader(std::move(*file), std::move(*index)));
  for (const auto step : {&RecordingReader::find_channels, &RecordingReader::read_heads,
                          &RecordingReader::find_ends}) {
    if (Status done = ((*out).*step)(); !done) return at_path(done);
  }
  return Result<std::unique_ptr<RecordingReader>>(std::move(out));
}

// 0: there is none.
std::uint16_t RecordingReader::channel_of(const std::string& topic) const {
  const auto& channels = index_.layout().channels;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].topic == topic) return static_cast<std::uint16_t>(i + 1);
  }
  return 0;
}

// Of two sides in one file the master's, whose channels begin with its name.
Status RecordingReader::find_channels() {
  struct Side {
    const char* prefix;
    const char* entry;
    bool of_master;
  };
  constexpr Side kSides[] = {{"/master", "/tick", true},
                             {"", "/tick", true},
                             {"/slave", "/cycle", false},
                             {"", "/cycle", false}};
  for (const Side& side : kSides) {
    const std::string prefix = side.prefix;
    entries_ = channel_of(prefix + side.entry);
    const bool any = entries_ != 0 && std::any_of(index_.chunks().begin(), index_.chunks().end(),
                                                  [this](const McapChunkPlace& chunk) {
                                                    return chunk.has(entries_);
                                                  });
    if (!any) continue;
    of_master_ = side.of_master;
    starts_ = channel_of(prefix + "/start");
    images_ = channel_of(prefix + "/image");
    scenes_ = channel_of(prefix + "/scene");
    events_channel_ = channel_of(prefix + "/event");
    for (const McapChunkPlace& chunk : index_.chunks()) {
      if (chunk.has(entries_)) chunks_.push_back(chunk);
    }
    std::stable_sort(
        chunks_.begin(), chunks_.end(),
        [](const McapChunkPlace& a, const McapChunkPlace& b) { return a.first < b.first; });
    return Status::ok();
  }
  const bool ours = channel_of("/start") != 0 || channel_of("/master/start") != 0;
  if (!ours) {
    return Status::error(
        "is an MCAP file of somebody else: expected the channels /start and /tick or /cycle" +
        (damage().empty() ? "" : "; " + damage()));
  }
  return Status::error("holds neither a tick nor a cycle" +
                       (damage().empty() ? "" : ": " + damage()));
}

// What stands in few chunks: the start, scenes, events. One that is not sound is left out here, and
// said where its time is asked for.
Status RecordingReader::read_heads() {
  bool started = false;
  McapOpenChunk open;
  for (const McapChunkPlace& chunk : index_.chunks()) {
    const bool wanted = (chunk.has(starts_) && !started) ||
                        (chunk.has(scenes_) && scene_at_.size() < kMostScenes) ||
                        (chunk.has(events_channel_) && events_.size() < kMostEvents);
    if (!wanted) {
      left_out_ += chunk.has(events_channel_) ? 1 : 0;
      continue;
    }
    if (!index_.open(file_, chunk, open)) continue;
    for (const McapMessage& message : open.messages) {
      pb::RecordedScene scene;
      if (message.channel == starts_ && !started) {
        if (!parse_bytes(message.data, start_)) return no_message(start_);
        started = true;
      } else if (message.channel == scenes_ && parse_bytes(message.data, scene)) {
        if (scene_at_.size() < kMostScenes) scene_at_.emplace(scene.number(), chunk);
      } else if (message.channel == events_channel_) {
        take_event(message);
      }
    }
  }
  std::stable_sort(events_.begin(), events_.end(),
                   [](const auto& a, const auto& b) { return a.calendar < b.calendar; });
  if (!started)
    return Status::error("has no message of channel /start, which tells of its program");
  const std::string program = of_master_ ? "handrail-master" : "handrail-slave";
  if (start_.program() == program) return Status::ok();
  return Status::error("/start: program is '" + shown(start_.program()) + "', expected '" +
                       program + "'");
}

void RecordingReader::take_event(const McapMessage& message) {
  RecordingEvent out;
  if (events_.size() >= kMostEvents || !parse_bytes(message.data, out.event)) {
    ++left_out_;
    return;
  }
  out.calendar = static_cast<Nanos>(message.log_time);
  events_.push_back(std::move(out));
}

Status RecordingReader::find_ends() {
  const auto first_of = [this](auto chunk, std::size_t count, Nanos& out, bool last) {
    Status why = Status::error("holds neither a tick nor a cycle");
    for (std::size_t i = 0; i < std::min(count, kMostBadEnds); ++i, ++chunk) {
      const auto index = static_cast<std::size_t>(&*chunk - chunks_.data());
      why = open_chunk(index, here_);
      if (!why) continue;
      if (here_.entries.empty()) continue;
      out = last ? here_.entries.back().calendar : here_.entries.front().calendar;
      return Status::ok();
    }
    return why ? Status::error("holds neither a tick nor a cycle") : why;
  };
  if (Status found = first_of(chunks_.begin(), chunks_.size(), begins_, false); !found) {
    return found;
  }
  if (Status found = first_of(chunks_.rbegin(), chunks_.size(), ends_, true); !found) return found;
  ends_ = std::max(begins_, ends_);
  constexpr Nanos kLongest = 10 * 365 * 24 * 3600 * kSecond;  // chosen; a bit flipped makes more
  if (begins_ >= 0 && ends_ - begins_ <= kLongest) return Status::ok();
  return Status::error("goes from " + std::to_string(begins_) + " to " + std::to_string(ends_) +
                       " ns since 1970, expected ten years at most");
}

Status RecordingReader::open_chunk(std::size_t chunk, Opened& out) {
  if (out.chunk == chunk) return Status::ok();
  out.chunk = kNone;
  out.entries.clear();
  if (Status done = index_.open(file_, chunks_[chunk], out.content); !done) return done;
  bool image = false;
  for (const McapMessage& message : out.content.messages) {
    if (message.channel == images_) image = true;
    if (message.channel != entries_) continue;
    out.entries.push_back(
        {static_cast<Nanos>(message.log_time), message.data, std::exchange(image, false)});
  }
  out.chunk = chunk;
  return Status::ok();
}

Result<const RecordingMoment*> RecordingReader::at(Nanos calendar) {
  const auto time = static_cast<std::uint64_t>(std::clamp(calendar, begins_, ends_));
  const auto after = std::upper_bound(
      chunks_.begin(), chunks_.end(), time,
      [](std::uint64_t t, const McapChunkPlace& chunk) { return t < chunk.first; });
  // A chunk may begin with something else: the entry is in the one before then.
  for (auto chunk = static_cast<std::size_t>(after - chunks_.begin()); chunk-- > 0;) {
    if (Status done = open_chunk(chunk, here_); !done) return done;
    const auto& entries = here_.entries;
    const auto late = std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) {
      return entry.calendar > static_cast<Nanos>(time);
    });
    if (late == entries.begin()) continue;
    const auto entry = static_cast<std::size_t>(late - entries.begin()) - 1;
    if (Status done = complete(entry, moment_); !done) return done;
    return &moment_;
  }
  return Status::error("the recording has no tick or cycle of that time");
}

Status RecordingReader::parse(const Opened& from, std::size_t entry, RecordingMoment& out) const {
  out.calendar = from.entries[entry].calendar;
  const std::string_view bytes = from.entries[entry].bytes;
  const bool done = of_master_ ? parse_bytes(bytes, out.tick) : parse_bytes(bytes, out.cycle);
  if (done) return Status::ok();
  const std::string place = "byte " + std::to_string(chunks_[from.chunk].at) + ": ";
  return Status::error(place +
                       (of_master_ ? no_message(out.tick) : no_message(out.cycle)).message());
}

// Ends where the state stands, where none is known, and where something is missing in between: then
// it may be another.
Status RecordingReader::look_at(const Opened& in, std::size_t entry, LookBack& look) {
  if (Status done = parse(in, entry, scratch_); !done) return done;
  const std::uint64_t number = number_of(scratch_);
  const bool has = has_other(scratch_);
  const bool follows = !look.begun || number + 1 == look.next;
  if (!look.begun) look.from = number;
  look.begun = true;
  look.next = number;
  look.ended = !follows || !knows_other(scratch_) || has || in.entries[entry].image ||
               look.from - number > kMostBack;
  if (!follows || !has || !knows_other(scratch_)) return Status::ok();
  look.found.number = number;
  if (of_master_) look.found.slave = scratch_.tick.slave();
  if (!of_master_) look.found.master = scratch_.cycle.master();
  return Status::ok();
}

// What the look back finds that begins with the last entry before that chunk. Of the chunk after
// it is what is known of this one, and what stands in between.
Status RecordingReader::remember_before(std::size_t chunk) {
  if (memory_.before == chunk) return Status::ok();
  LookBack look;
  for (std::size_t at = chunk; at-- > 0 && !look.ended;) {
    if (look.begun && memory_.before == at + 1) {
      const bool follows = memory_.look.begun && memory_.look.from + 1 == look.next;
      if (follows) look.found = memory_.look.found;
      break;
    }
    if (!open_chunk(at, before_)) break;  // what it held is not known
    for (std::size_t i = before_.entries.size(); i-- > 0 && !look.ended;) {
      if (Status done = look_at(before_, i, look); !done) return done;
    }
  }
  memory_.before = chunk;
  memory_.look = std::move(look);
  return Status::ok();
}

// Puts the other side's state to where it was left out.
Status RecordingReader::complete(std::size_t entry, RecordingMoment& out) {
  if (Status done = parse(here_, entry, out); !done) return done;
  if (!knows_other(out) || has_other(out) || here_.entries[entry].image) return Status::ok();
  LookBack look;
  look.begun = true;
  look.from = look.next = number_of(out);
  for (std::size_t i = entry; i-- > 0 && !look.ended;) {
    if (Status done = look_at(here_, i, look); !done) return done;
  }
  if (!look.ended) {
    if (Status done = remember_before(here_.chunk); !done) return done;
    if (memory_.look.begun && memory_.look.from + 1 == look.next) look.found = memory_.look.found;
  }
  if (look.from - look.found.number > kMostBack) return Status::ok();
  if (look.found.slave) *out.tick.mutable_slave() = *look.found.slave;
  if (look.found.master) *out.cycle.mutable_master() = *look.found.master;
  return Status::ok();
}

std::uint64_t RecordingReader::number_of(const RecordingMoment& of) const {
  return of_master_ ? of.tick.number() : of.cycle.number();
}
bool RecordingReader::knows_other(const RecordingMoment& of) const {
  return of_master_ ? of.tick.slave_known() : of.cycle.master_known();
}
bool RecordingReader::has_other(const RecordingMoment& of) const {
  return of_master_ ? of.tick.has_slave() : of.cycle.has_master();
}

Result<pb::RecordedScene> RecordingReader::scene(std::uint32_t number) {
  const auto place = scene_at_.find(number);
  if (place == scene_at_.end()) {
    return Status::error("the recording does not have scene " + std::to_string(number) +
                         ", which its ticks name");
  }
  McapOpenChunk open;
  if (Status done = index_.open(file_, place->second, open); !done) return done;
  for (const McapMessage& message : open.messages) {
    pb::RecordedScene out;
    if (message.channel != scenes_ || !parse_bytes(message.data, out)) continue;
    if (out.number() == number) return out;
  }
  return Status::error("the recording's scene " + std::to_string(number) + " is gone");
}

}  // namespace handrail
