// What becomes of the messages that a recording is made of.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "proto/record.pb.h"
#include "server/base/time.h"
#include "server/record/mcap/mcap.h"

namespace handrail {

// The channels of every recording, by their numbers in McapLayout.
enum class RecordChannel : std::uint16_t {
  kStart = 1,
  kScene,
  kImage,
  kTick,
  kCycle,
  kEvent,
  kJointStates,
  kTip,
  kDesired,
  kLog,
  kPacket
};

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
  // What the calendar shows when the program's clock does `at` [ns since 1970].
  virtual Nanos calendar(Nanos at) const = 0;
  // The other side wants a recording, or none.
  virtual void wanted(bool recording) = 0;
};

}  // namespace handrail
