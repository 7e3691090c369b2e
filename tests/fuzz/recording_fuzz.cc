// Recordings: files of whoever it may be, done again and played. What reads them is mcap_fuzz.cc.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

#include "client/console/play/played_status.h"
#include "server/lab/replay/replay.h"
#include "server/record/record_sink.h"
#include "server/record/recording_reader.h"
#include "tests/fuzz/recording_input.h"

namespace handrail {
namespace {

// As `handrail play` looks into it: first, last, in between and first again.
void play_file(const std::string& file) {
  const int fd = ::memfd_create("recording", MFD_CLOEXEC);
  const bool written =
      fd >= 0 && ::write(fd, file.data(), file.size()) == static_cast<ssize_t>(file.size());
  const auto reader = RecordingReader::open("/proc/self/fd/" + std::to_string(fd));
  if (fd >= 0) ::close(fd);
  if (!written) return;
  fuzz::require(reader || !reader.message().empty(), "a refusal says why");
  if (!reader) return;
  RecordingReader& in = **reader;
  fuzz::require(in.begins() <= in.ends(), "a recording does not end before it begins");
  std::string first;
  for (const Nanos time :
       {in.begins(), in.ends(), in.begins() + (in.ends() - in.begins()) / 2, in.begins()}) {
    const auto moment = in.at(time);
    if (!moment) continue;
    const std::string text =
        (*moment)->tick.SerializeAsString() + (*moment)->cycle.SerializeAsString();
    if (time == in.begins() && first.empty()) first = text;
    if (time == in.begins()) fuzz::require(text == first, "a moment is what it was");
    const auto status = played_status(in.start(), in.of_master(), **moment, nullptr);
    fuzz::require(status || !status.message().empty(), "a refusal says why");
    (void)in.scene(scene_number(in.of_master(), **moment));
  }
}

}  // namespace

HANDRAIL_FUZZ(recording) {
  static const McapLayout layout = record_layout();
  const std::string file = fuzz::recording_of(bytes, layout);
  ReplayOptions options;
  options.images = false;
  std::istringstream again(file);
  const auto result = replay(again, options);
  fuzz::require(result || !result.message().empty(), "a refusal says why");
  play_file(file);
}

}  // namespace handrail
