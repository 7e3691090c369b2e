// From a tap to messages: what a daemon's thread has left, as it stands in a file.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/packets/packet_tap.h"
#include "server/record/record_sink.h"
#include "server/record/record_tap.h"

namespace handrail {

// A side's tap. One thread, but for the real-time one that fills the tap.
class RecordFeed {
 public:
  virtual ~RecordFeed() = default;
  // What has come since. Bounded by the tap's size. May allocate.
  virtual void pull(RecordSink& sink) = 0;
  virtual const char* side() const = 0;  // "master" or "slave"
  // Ticks, cycles and packets that could not be kept, so far.
  virtual std::uint64_t lost() const = 0;
};

// `packets`: of the side's threads that have datagrams; they outlive the feed.
std::unique_ptr<RecordFeed> make_feed(MasterTap& tap, std::vector<PacketTap*> packets = {});
std::unique_ptr<RecordFeed> make_feed(SlaveTap& tap, std::vector<PacketTap*> packets = {});

// Of this build: recordings with the same one can be gone on with from any image.
std::string record_build();

}  // namespace handrail
