// One side's step, done again. Part of the replay.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>

#include "proto/record.pb.h"
#include "server/lab/replay/replay.h"
#include "server/record/mcap/mcap.h"
#include "server/record/recorded_scenes.h"

namespace handrail {

class ReplaySide {
 public:
  virtual ~ReplaySide() = default;
  // What the step remembers before the tick or cycle of that number.
  virtual Status image(const pb::RecordedImage& image) = 0;
  // A tick or cycle. The error says what of it is none.
  virtual Status entry(std::string_view bytes, ReplayResult& result) = 0;
  // Some ticks are missing: nothing can be done again until the next image.
  virtual void interrupt() = 0;
};

// The error names what of the recorded start cannot be used.
Result<std::unique_ptr<ReplaySide>> make_replay_side(const pb::RecordedStart& start,
                                                     const RecordedScenes& scenes,
                                                     const ReplayOptions& options);

// The same by side, for make_replay_side.
Result<std::unique_ptr<ReplaySide>> replay_master(const pb::RecordedStart& start,
                                                  const RecordedScenes& scenes,
                                                  const ReplayOptions& options);
Result<std::unique_ptr<ReplaySide>> replay_slave(const pb::RecordedStart& start,
                                                 const RecordedScenes& scenes,
                                                 const ReplayOptions& options);

// Counts what differs and keeps the first; `exact`: to the bit, else to kOtherBuild.
class ReplayCompare {
 public:
  explicit ReplayCompare(bool exact) : exact_(exact) {}
  // Messages of the same kind.
  void compare(const google::protobuf::Message& was, const google::protobuf::Message& is,
               std::uint64_t number, Nanos at, ReplayResult& result);

 private:
  bool exact_;
  Nanos first_at_ = -1;
  std::string was_, is_;
};

}  // namespace handrail
