#include "server/record/record_setup.h"

#include <google/protobuf/text_format.h>

#include <filesystem>
#include <system_error>
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

}  // namespace handrail
