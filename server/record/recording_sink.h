// One recording on the disk, while it is written.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/status.h"
#include "server/record/mcap/mcap_writer.h"

namespace handrail {

// What the disk does not take is not there, and nothing else is spoilt by it: a chunk stands whole
// or not at all, unless the program ends in between. For one thread; blocks as the disk does.
class RecordingSink {
 public:
  // A new file; the error names it and what the system says.
  static Result<RecordingSink> make(const std::string& path, const McapLayout& layout);
  ~RecordingSink();
  RecordingSink(RecordingSink&& other) noexcept;
  RecordingSink& operator=(RecordingSink&&) = delete;

  Status write(const McapChunk& chunk);
  // After the last chunk, once.
  Status finish();

  // The file has no name any more: what is written to it nobody will find.
  bool removed() const noexcept;
  const std::string& path() const { return path_; }
  std::uint64_t size() const { return file_.size(); }

 private:
  RecordingSink(int fd, std::string path, const McapLayout& layout)
      : fd_(fd), path_(std::move(path)), file_(layout) {}
  Status put(std::string_view bytes, std::uint64_t at);

  int fd_;
  std::string path_;
  McapFile file_;
};

}  // namespace handrail
