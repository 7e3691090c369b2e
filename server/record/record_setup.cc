#include "server/record/record_setup.h"

#include <google/protobuf/text_format.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include "server/base/version.h"

namespace handrail {

pb::RecordedStart recorded_start(const std::string& program, std::uint64_t run,
                                 const google::protobuf::Message& configuration) {
  pb::RecordedStart out;
  out.set_program(program);
  out.set_version(program_version());
  out.set_run(run);
  // A message of ours always has a text.
  (void)google::protobuf::TextFormat::PrintToString(configuration, out.mutable_configuration());
  return out;
}

RecorderOptions recorder_options(const pb::RecordingConfig& config,
                                 std::function<void(bool bad, const std::string& line)> say) {
  constexpr std::uint64_t kMegabyte = 1'000'000;
  constexpr Nanos kDay = 24 * 3600 * kSecond;
  RecorderOptions out;
  // Whoever is told of a file may have another working folder.
  std::error_code error;
  const auto folder = std::filesystem::absolute(config.folder(), error);
  out.folder = error ? config.folder() : folder.lexically_normal().string();
  out.keep_bytes = config.keep_mb() * kMegabyte;
  out.keep_for = config.keep_days() * kDay;
  out.say = std::move(say);
  return out;
}

RecorderEnd::~RecorderEnd() {
  constexpr Nanos kDiskPatience = 5 * kSecond;  // chosen: an operator would wait so long
  // The recorder's thread cannot be ended while the disk holds it, and what it reads would go.
  if (recorder_ == nullptr || recorder_->end(kDiskPatience)) return;
  // The log's thread has what was said last: as long as at any other end.
  constexpr auto kLogPatience = std::chrono::milliseconds(200);
  std::this_thread::sleep_for(kLogPatience);
  std::_Exit(EXIT_FAILURE);
}

}  // namespace handrail
