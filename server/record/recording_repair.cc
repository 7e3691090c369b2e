#include "server/record/recording_repair.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

#include "server/base/time.h"
#include "server/record/mcap/mcap_reader.h"
#include "server/record/recording_sink.h"

namespace handrail {
namespace {

// As the recorder's own chunks have it, or when as much has been gathered.
constexpr std::uint64_t kChunkTime = 100 * kMillisecond;
constexpr std::uint64_t kChunkBytes = std::uint64_t{1} << 22;

}  // namespace

Result<RepairedRecording> repair_recording(std::istream& in, const std::string& path) {
  // All channels stand at the file's beginning: they are read first.
  const auto begin = in.tellg();
  McapLayout layout;
  RepairedRecording out;
  {
    McapReader reader(in);
    while (reader.next()) ++out.messages;
    layout = reader.layout();
    out.damage = reader.damage();
  }
  if (out.messages == 0) {
    return Status::error(out.damage.empty() ? "holds no message" : out.damage);
  }
  in.clear();
  in.seekg(begin);
  auto made = RecordingSink::make(path, layout);
  if (!made) return made.status();
  RecordingSink file = std::move(*made);
  const auto fail = [&path](const Status& why) {
    std::remove(path.c_str());
    return why;
  };
  McapReader reader(in);
  McapChunkBuilder chunk;
  std::uint64_t gathered = 0, first = 0, last = 0;
  for (std::uint64_t i = 0; i < out.messages; ++i) {
    const auto message = reader.next();
    if (!message) return fail(Status::error("the file changed while it was read"));
    if (i == 0) first = last = message->log_time;
    first = std::min(first, message->log_time);
    last = std::max(last, message->log_time);
    const bool full = gathered >= kChunkBytes ||
                      message->log_time - std::min(chunk.first(), message->log_time) > kChunkTime;
    if (!chunk.empty() && full) {
      if (Status done = file.write(chunk.close()); !done) return fail(done);
      gathered = 0;
    }
    chunk.add(*message);
    gathered += message->data.size();
  }
  if (Status done = file.write(chunk.close()); !done) return fail(done);
  if (Status done = file.finish(); !done) return fail(done);
  out.seconds = to_seconds(static_cast<Nanos>(last - first));
  return out;
}

}  // namespace handrail
