// A Unix socket whose file permissions are the lock: claimed safely, left clean.
#pragma once

#include <sys/types.h>

#include <string>

#include "server/base/status.h"

namespace handrail {

// A listening socket bound to a path, mode 0600 from the moment anyone can connect. Its folder is
// created with mode 0700 when missing. The file is removed on destruction if it is still ours.
class OperatorSocket {
 public:
  OperatorSocket() = default;
  ~OperatorSocket() { remove(); }
  OperatorSocket(const OperatorSocket&) = delete;
  OperatorSocket& operator=(const OperatorSocket&) = delete;

  // Claims `path`. A file left by a master that ended is replaced; refuses when another one answers
  // on it, when it is no socket, or when its folder is a link, somebody else's or others may write
  // to it. The error names the path.
  Status claim(const std::string& path);
  // The listening descriptor, non-blocking; the caller owns it from here on.
  int release() noexcept;
  // Removes the file if it is still the one claimed. Safe to call twice.
  void remove() noexcept;

 private:
  std::string path_;
  int fd_ = -1;
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

}  // namespace handrail
