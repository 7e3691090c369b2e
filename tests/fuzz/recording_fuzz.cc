// Recordings: files of whoever it may be, read, done again and played.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

#include "client/console/play/played_status.h"
#include "server/lab/replay/replay.h"
#include "server/record/mcap/mcap_reader.h"
#include "server/record/mcap/mcap_writer.h"
#include "server/record/record_feed.h"
#include "server/record/recording_reader.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail {
namespace {

// The input as a file; or, where it begins with 'm', as the messages of one: for each its channel
// (a byte), its length (two), its content. So the fuzzer need not find checksums.
std::string file_of(fuzz::Bytes bytes) {
  if (bytes.empty() || bytes[0] != 'm') return std::string(fuzz::text_of(bytes));
  bytes = bytes.subspan(1);
  const McapLayout layout = record_layout();
  McapFile file(layout);
  std::string out = file.begin();
  McapChunkBuilder chunk;
  for (std::uint32_t sequence = 1; bytes.size() >= 3; ++sequence) {
    const auto channel = static_cast<std::uint16_t>(1 + bytes[0] % layout.channels.size());
    const std::size_t length = std::min<std::size_t>(bytes[1] + 256u * bytes[2], bytes.size() - 3);
    chunk.add({channel, sequence, sequence, sequence, fuzz::text_of(bytes.subspan(3, length))});
    bytes = bytes.subspan(3 + length);
  }
  if (chunk.empty()) return out;
  const McapChunk closed = chunk.close();
  file.add(closed);
  return out + closed.bytes + file.end();
}

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
  const std::string file = file_of(bytes);
  std::istringstream in(file);
  McapReader reader(in);
  std::uint64_t messages = 0;
  while (const auto message = reader.next()) {
    ++messages;
    fuzz::require(message->channel >= 1 && message->channel <= reader.layout().channels.size(),
                  "a message is of a channel that there is");
    (void)reader.schema_of(message->channel);
  }
  fuzz::require(reader.complete() || !reader.damage().empty(), "what is not whole is said");
  fuzz::require(reader.sound() <= file.size(), "what is sound is in the file");
  ReplayOptions options;
  options.images = false;
  std::istringstream again(file);
  const auto result = replay(again, options);
  fuzz::require(result || !result.message().empty(), "a refusal says why");
  if (result) fuzz::require(result->entries <= messages, "no more ticks than messages");
  play_file(file);
}

}  // namespace handrail
