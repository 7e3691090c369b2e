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

}  // namespace handrail
