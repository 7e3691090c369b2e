// A file of which any part can be read.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "server/base/status.h"

namespace handrail {

// Held open: one that is removed or renamed meanwhile can be read on. For one thread; blocks.
class FileBytes {
 public:
  // A regular file. The error names path and cause.
  static Result<FileBytes> open(const std::string& path);
  FileBytes(FileBytes&& other) noexcept
      : path_(std::move(other.path_)),
        fd_(std::exchange(other.fd_, -1)),
        size_(other.size_),
        taken_(other.taken_) {}
  FileBytes& operator=(FileBytes&&) = delete;
  ~FileBytes();

  const std::string& path() const { return path_; }
  // When it was opened [bytes].
  std::uint64_t size() const { return size_; }
  // `size` bytes from `at` on. The error says where the file ends by now, or what the disk says.
  Status read(std::uint64_t at, std::uint64_t size, std::string& out) const;
  // Read so far, of all calls together [bytes].
  std::uint64_t taken() const { return taken_; }

 private:
  FileBytes(std::string path, int fd, std::uint64_t size)
      : path_(std::move(path)), fd_(fd), size_(size) {}

  std::string path_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
  mutable std::uint64_t taken_ = 0;
};

}  // namespace handrail
