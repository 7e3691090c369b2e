// What programs write for a person: a file whole or not at all, and an exit code that tells of a
// full disk.
#pragma once

#include <string>

#include "server/base/status.h"

namespace handrail {

// A file that takes the place of what was there when it is whole; until then, and where it cannot
// be written, what was there stays. What is no regular file (/dev/stdout, a pipe) is written to as
// it is. A link is followed. Not real-time safe.
class NewFile {
 public:
  // Opens it: what cannot be written is known before long work begins.
  explicit NewFile(const std::string& path);
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile();

  // Whether it could be opened: "PATH: cannot write: why".
  const Status& opened() const { return opened_; }
  // Writes the text to the disk and puts the file in its place.
  Status finish(const std::string& text);

 private:
  std::string path_;  // as given
  std::string goes_to_, part_;
  int file_ = -1;
  Status opened_ = Status::ok();
};

// Writes all of it, for as long as it takes; 0, or the error (errno) that keeps the rest. `file`:
// open for writing.
int write_all(int file, const std::string& text);

Status write_file(const std::string& path, const std::string& text);

// To be called last in main: what was printed is written out. `code`, or 1 with a line on the
// error output that begins with `program` where the standard output takes no more.
int end_output(const std::string& program, int code);

}  // namespace handrail
