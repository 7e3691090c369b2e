// From a tap to messages: what a daemon's thread has left, as it stands in a file.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "proto/record.pb.h"
#include "server/record/mcap/mcap_writer.h"
#include "server/record/record_tap.h"

namespace handrail {

// The channels of every recording, by their numbers in McapLayout.
enum class RecordChannel : std::uint16_t { kStart = 1, kScene, kImage, kTick, kCycle, kEvent };

// The kinds of messages of both sides' files.
McapLayout record_layout();

// What is to be done with messages, in their order.
class RecordSink {
 public:
  virtual ~RecordSink() = default;
  virtual void message(RecordChannel channel, Nanos at, std::string_view bytes) = 0;
  // The step's memory follows: whoever reads can begin here.
  virtual void beginning() = 0;
  // Something happened for whose sake what came before is kept. Said after its tick.
  virtual void happened(pb::RecordedEvent::Kind kind, Nanos at, const std::string& text) = 0;
  // The other side wants a recording, or none.
  virtual void wanted(bool recording) = 0;
};

// A side's tap. One thread, but for the real-time one that fills the tap.
class RecordFeed {
 public:
  virtual ~RecordFeed() = default;
  // What has come since. Bounded by the tap's size. May allocate.
  virtual void pull(RecordSink& sink) = 0;
  virtual const char* side() const = 0;  // "master" or "slave"
  // Ticks or cycles that could not be kept, so far.
  virtual std::uint64_t lost() const = 0;
};

std::unique_ptr<RecordFeed> make_feed(MasterTap& tap);
std::unique_ptr<RecordFeed> make_feed(SlaveTap& tap);

// Of this build: recordings with the same one can be gone on with from any image.
std::string record_build();

}  // namespace handrail
