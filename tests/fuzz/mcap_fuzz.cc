// MCAP files of whoever it may be: read in their order, and by their index.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <sstream>

#include "server/record/mcap/mcap_index.h"
#include "server/record/mcap/mcap_reader.h"
#include "tests/fuzz/recording_input.h"

namespace handrail {
namespace {

using fuzz::require;

// What a program of ours reads of it, message by message; `ours`: it was written by ours, too.
std::uint64_t read_in_order(const std::string& file, bool ours) {
  std::istringstream in(file);
  McapReader reader(in);
  std::uint64_t messages = 0;
  while (const auto message = reader.next()) {
    ++messages;
    require(message->channel >= 1 && message->channel <= reader.layout().channels.size(),
            "a message is of a channel that there is");
    (void)reader.schema_of(message->channel);
  }
  require(reader.complete() || !reader.damage().empty(), "what is not whole is said");
  require(reader.sound() <= file.size(), "what is sound is in the file");
  require(!ours || reader.complete(), "a file of our own is whole");
  return messages;
}

// What the console's player finds by the index, or by the beginnings of the records.
void read_by_index(const std::string& file) {
  static const int fd = ::memfd_create("recording", MFD_CLOEXEC);
  static const std::string path = "/proc/self/fd/" + std::to_string(fd);
  if (::ftruncate(fd, 0) != 0 ||
      ::pwrite(fd, file.data(), file.size(), 0) != static_cast<ssize_t>(file.size()))
    return;
  const auto bytes = FileBytes::open(path);
  require(bytes.is_ok(), "a file of our own can be read");
  const auto index = McapIndex::of(*bytes);
  require(index || !index.message().empty(), "a refusal says why");
  if (!index) return;
  McapOpenChunk open;
  for (const McapChunkPlace& chunk : index->chunks()) {
    require(chunk.at + chunk.length <= file.size(), "a chunk is in the file");
    const Status opened = index->open(*bytes, chunk, open);
    require(opened || !opened.message().empty(), "a refusal says why");
    if (!opened) continue;
    for (const McapMessage& message : open.messages) {
      const char* const begin = open.plain.data();
      require(message.data.empty() ||
                  (message.data.data() >= begin &&
                   message.data.data() + message.data.size() <= begin + open.plain.size()),
              "a message lies in its chunk");
    }
  }
}

}  // namespace

HANDRAIL_FUZZ(mcap) {
  // What messages mean is nothing to it: a layout that is quickly written.
  static const McapLayout layout{
      "fuzz", {{"a", "", ""}, {"b", "", "c"}}, {{1, "/a", ""}, {2, "/b", ""}}};
  const std::string file = fuzz::recording_of(bytes, layout);
  const bool ours = bytes.size() >= 4 && bytes[0] == 'm';
  const std::uint64_t messages = read_in_order(file, ours);
  require(!ours || messages > 0, "its messages are found");
  read_by_index(file);
}

}  // namespace handrail
