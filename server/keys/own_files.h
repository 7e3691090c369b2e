// Files that only their owner reads and changes, each whole or not at all.
#pragma once

#include <sys/stat.h>

#include <string>
#include <string_view>
#include <utility>

#include "server/base/status.h"

namespace handrail {

// "PATH: WHAT", and the system's word for `cause`, an errno.
Status file_error(const std::string& path, const std::string& what);
Status file_error(const std::string& path, const char* what, int cause);

// "0640".
std::string mode_text(mode_t mode);

// Whether `path` is a regular file of ours (or root's) that has none of the rights in
// `not_for_others`. `expected` ends "so others can ...".
Status check_file(const std::string& path, mode_t not_for_others, const char* expected);

// Makes it with mode 0700, and what is above it, if need be. Refused: one of somebody else.
Status make_own_folder(const std::string& path);

// Writes a file of its own, mode 0600, and leaves it at `path`: with `fresh` only where none is.
Status write_whole(const std::string& path, std::string_view text, bool fresh);

// While it lives no other program of this user that takes it changes the folder. Made if need be.
class FolderLock {
 public:
  static Result<FolderLock> take(const std::string& folder);
  FolderLock(FolderLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FolderLock& operator=(FolderLock&&) = delete;
  ~FolderLock();

 private:
  explicit FolderLock(int fd) : fd_(fd) {}
  int fd_;
};

}  // namespace handrail
