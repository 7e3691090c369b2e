// From a tap to messages: what a daemon's thread has left, as it stands in a file.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

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
  // Ticks or cycles that could not be kept, so far.
  virtual std::uint64_t lost() const = 0;
};

std::unique_ptr<RecordFeed> make_feed(MasterTap& tap);
std::unique_ptr<RecordFeed> make_feed(SlaveTap& tap);

// Of this build: recordings with the same one can be gone on with from any image.
std::string record_build();

}  // namespace handrail
