// A Unix socket whose file permissions are the lock: claimed safely, left clean.
#pragma once

#include <sys/types.h>

#include <string>

#include "server/base/status.h"

namespace handrail {

struct PathSocketKind {
  int type;           // SOCK_STREAM, which then listens, or SOCK_DGRAM
  const char* role;   // what errors call it, such as "operator socket"
  const char* rival;  // who may have the path already, such as "another master"
};

// A socket bound to a path, mode 0600 from the moment it is there (given that the umask leaves the
// owner its rights). Its folder is created with mode 0700 when missing. The file is removed on
// destruction if it is still ours. A datagram socket is told by the kernel who sends
// (SCM_CREDENTIALS).
class PathSocket {
 public:
  explicit PathSocket(PathSocketKind kind) : kind_(kind) {}
  ~PathSocket() { remove(); }
  PathSocket(const PathSocket&) = delete;
  PathSocket& operator=(const PathSocket&) = delete;

  // Claims `path`. A file left by a program that ended is replaced; refuses when another one
  // answers on it, when it is no socket, or when its folder is a link, somebody else's or others
  // may write to it. The error names the path.
  Status claim(const std::string& path);
  // The descriptor, non-blocking; the caller owns it from here on.
  int release() noexcept;
  // Where it is bound; empty: nowhere. For datagrams without links and from the root on: it is the
  // address that others see and answer to.
  const std::string& path() const noexcept { return path_; }
  // Removes the file if it is still the one claimed. Safe to call twice.
  void remove() noexcept;

 private:
  PathSocketKind kind_;
  std::string path_;
  int fd_ = -1;
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

}  // namespace handrail
