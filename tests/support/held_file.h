// A file whose disk takes its time: whoever opens it stands in open() until the test lets him.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <sys/fanotify.h>
#include <unistd.h>

#include <string>

#include "server/base/time.h"

namespace handrail::test {

class HeldFile {
 public:
  // The file must exist. Nobody is held any more when this goes out of scope.
  explicit HeldFile(const std::string& path)
      : held_(::fanotify_init(FAN_CLASS_CONTENT | FAN_CLOEXEC | FAN_NONBLOCK, O_RDONLY)) {
    if (held_ < 0) return;
    works_ = ::fanotify_mark(held_, FAN_MARK_ADD, FAN_OPEN_PERM, AT_FDCWD, path.c_str()) == 0;
  }
  ~HeldFile() {
    let_go();
    if (held_ >= 0) ::close(held_);
  }
  HeldFile(const HeldFile&) = delete;
  HeldFile& operator=(const HeldFile&) = delete;

  // False: the system does not let us.
  bool works() const { return works_; }
  // The process that stands in open() now, 0 where none comes within `patience`.
  pid_t holds(Nanos patience) {
    pollfd ready{held_, POLLIN, 0};
    fanotify_event_metadata event{};
    if (::poll(&ready, 1, static_cast<int>(patience / kMillisecond)) != 1) return 0;
    if (::read(held_, &event, sizeof event) != sizeof event) return 0;
    event_ = event.fd;
    return event.pid;
  }
  void let_go() {
    if (event_ < 0) return;
    const fanotify_response answer{event_, FAN_ALLOW};
    (void)!::write(held_, &answer, sizeof answer);
    ::close(event_);
    event_ = -1;
  }

 private:
  int held_ = -1;
  int event_ = -1;
  bool works_ = false;
};

}  // namespace handrail::test
