// A daemon's recorder as its configuration asks for it.
#pragma once

#include <memory>
#include <string>

#include "proto/config.pb.h"
#include "server/record/recorder.h"

namespace handrail {

// `program`: its name. `configuration`: of the daemon, as a message.
pb::RecordedStart recorded_start(const std::string& program, std::uint64_t run,
                                 const google::protobuf::Message& configuration);

RecorderOptions recorder_options(const pb::RecordingConfig& config,
                                 std::function<void(bool bad, const std::string& line)> say);

// At the end of a program: what came is written out, or, where the disk does not answer, it ends
// without. Stands after what the recorder reads and before all that must end in order, so that this
// is last.
class RecorderEnd {
 public:
  // `recorder`: null, there is none; outlives this.
  explicit RecorderEnd(Recorder* recorder) : recorder_(recorder) {}
  ~RecorderEnd();
  RecorderEnd(const RecorderEnd&) = delete;
  RecorderEnd& operator=(const RecorderEnd&) = delete;

 private:
  Recorder* recorder_;
};

}  // namespace handrail
