#include "server/lab/replay/recording_join.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "proto/record.pb.h"
#include "server/record/mcap/mcap_reader.h"
#include "server/record/record_feed.h"
#include "server/record/recording_sink.h"

namespace handrail {
namespace {

constexpr std::uint64_t kChunkSpan = 100 * kMillisecond;

// What one side's file says of the clocks.
struct Side {
  bool is_master = false;
  pb::RecordedStart start;
  Nanos first = 0, last = 0;  // of its ticks or cycles, own clock
  // Of the datagram whose round trip was the shortest.
  Nanos shortest = std::numeric_limits<Nanos>::max();
  Nanos ahead = 0;  // the other clock minus this one, half of that round trip being the way here
  std::uint64_t measures = 0;

  void see(Nanos at, const pb::RecordedLink& link) {
    if (first == 0) first = at;
    last = at;
    if (!link.has_received_at_ns() || link.round_trip_ns() < 0) return;
    ++measures;
    if (link.round_trip_ns() >= shortest) return;
    shortest = link.round_trip_ns();
    ahead = link.peer_sent_ns() - (link.received_at_ns() - shortest / 2);
  }
};

template <typename Message>
bool parsed(const McapMessage& message, Message& out) {
  return out.ParseFromArray(message.data.data(), static_cast<int>(message.data.size()));
}

Result<Side> read_side(std::istream& in, const char* which) {
  McapReader reader(in);
  Side out;
  pb::RecordedTick tick;
  pb::RecordedCycle cycle;
  bool begun = false;
  while (const auto message = reader.next()) {
    const McapSchema* schema = reader.schema_of(message->channel);
    if (schema == nullptr) continue;
    if (schema->name == "handrail.pb.RecordedStart" && parsed(*message, out.start)) {
      begun = true;
      out.is_master = out.start.has_device();
    } else if (schema->name == "handrail.pb.RecordedTick" && parsed(*message, tick)) {
      out.see(tick.at_ns(), tick.link());
    } else if (schema->name == "handrail.pb.RecordedCycle" && parsed(*message, cycle)) {
      out.see(cycle.at_ns(), cycle.link());
    }
  }
  if (begun) return out;
  return Status::error(std::string("the ") + which + " file is no recording of Handrail" +
                       (reader.damage().empty() ? "" : ": " + reader.damage()));
}

// The messages of one file, its times moved by `later`.
class Stream {
 public:
  // `places`: the number that a topic gets.
  Stream(std::istream& in, Nanos later, const std::map<std::string, std::uint16_t>& places)
      : reader_(in), later_(later), places_(places) {
    next();
  }
  bool ended() const { return !message_; }
  const McapMessage& message() const { return *message_; }
  void next() {
    // What a later version writes, and is not known here, is left out.
    while ((message_ = reader_.next()) && place() == places_.end()) continue;
    if (!message_) return;
    message_->channel = place()->second;
    const auto move = [this](std::uint64_t time) {
      return static_cast<std::uint64_t>(std::max<Nanos>(static_cast<Nanos>(time) + later_, 0));
    };
    message_->log_time = move(message_->log_time);
    message_->publish_time = move(message_->publish_time);
  }

 private:
  std::map<std::string, std::uint16_t>::const_iterator place() const {
    return places_.find(reader_.layout().channels[message_->channel - 1u].topic);
  }

  McapReader reader_;
  Nanos later_;
  const std::map<std::string, std::uint16_t>& places_;
  std::optional<McapMessage> message_;
};

void rewind(std::istream& in) {
  in.clear();
  in.seekg(0);
}

// Channels of both sides beside each other: the slave's begin with /slave.
McapLayout joined_layout() {
  McapLayout out = record_layout();
  const std::size_t one = out.channels.size();
  for (std::size_t i = 0; i < one; ++i) {
    McapChannel slave = out.channels[i];
    slave.topic = "/slave" + slave.topic;
    out.channels[i].topic = "/master" + out.channels[i].topic;
    out.channels.push_back(std::move(slave));
  }
  return out;
}

Result<std::uint64_t> write_both(std::istream& master, std::istream& slave, Nanos later,
                                 const std::string& path) {
  rewind(master);
  rewind(slave);
  auto made = RecordingSink::make(path, joined_layout());
  if (!made) return made.status();
  RecordingSink file = std::move(*made);
  std::map<std::string, std::uint16_t> places[2];
  const McapLayout one = record_layout();
  for (std::size_t i = 0; i < one.channels.size(); ++i) {
    places[0][one.channels[i].topic] = static_cast<std::uint16_t>(i + 1);
    places[1][one.channels[i].topic] = static_cast<std::uint16_t>(i + 1 + one.channels.size());
  }
  Stream streams[] = {{master, 0, places[0]}, {slave, later, places[1]}};
  McapChunkBuilder chunk;
  std::uint64_t count = 0;
  while (!streams[0].ended() || !streams[1].ended()) {
    const bool second =
        streams[0].ended() ||
        (!streams[1].ended() && streams[1].message().log_time < streams[0].message().log_time);
    Stream& from = streams[second ? 1 : 0];
    McapMessage message = from.message();
    message.sequence = static_cast<std::uint32_t>(++count);
    if (!chunk.empty() && message.log_time > chunk.first() + kChunkSpan) {
      if (Status done = file.write(chunk.close()); !done) return done;
    }
    chunk.add(message);
    from.next();
  }
  if (!chunk.empty()) {
    if (Status done = file.write(chunk.close()); !done) return done;
  }
  if (Status done = file.finish(); !done) return done;
  return count;
}

}  // namespace

Result<RecordingJoin> join_recordings(std::istream& first, std::istream& second,
                                      const std::string& path) {
  auto a = read_side(first, "first");
  if (!a) return a.status();
  auto b = read_side(second, "second");
  if (!b) return b.status();
  if (a->is_master == b->is_master) {
    return Status::error(std::string("both are of a ") + (a->is_master ? "master" : "slave") +
                         ", expected one of each");
  }
  const Side& master = a->is_master ? *a : *b;
  const Side& slave = a->is_master ? *b : *a;
  RecordingJoin out;
  out.measures = master.measures + slave.measures;
  if (out.measures == 0) {
    return Status::error("neither has heard the other side: their clocks cannot be compared");
  }
  // Each has its own best; the better of them is meant.
  const bool by_master = master.shortest <= slave.shortest;
  out.offset = by_master ? master.ahead : -slave.ahead;
  out.bound = std::min(master.shortest, slave.shortest) / 2;
  const Nanos begin = std::max(master.first, slave.first - out.offset);
  const Nanos end = std::min(master.last, slave.last - out.offset);
  out.both = end - begin;
  if (out.both <= 0) {
    return Status::error("they are of different times: the slave's begins " +
                         std::to_string(to_seconds(slave.first - out.offset - master.last)) +
                         " s after the master's end");
  }
  if (path.empty()) return out;
  // From the slave's calendar to its clock, to the master's clock, to the master's calendar.
  const Nanos later = (master.start.calendar_ns() - master.start.monotonic_ns()) - out.offset -
                      (slave.start.calendar_ns() - slave.start.monotonic_ns());
  std::istream& of_master = a->is_master ? first : second;
  std::istream& of_slave = a->is_master ? second : first;
  const auto written = write_both(of_master, of_slave, later, path);
  if (!written) return written.status();
  out.messages = *written;
  return out;
}

}  // namespace handrail
