#include "server/daemon/fd_sink.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <string>

#include "server/base/clock.h"

namespace handrail {
namespace {

// Between two looks whether the program ends, while nobody takes a line.
constexpr Nanos kLook = 20 * kMillisecond;
// Before the next try where poll() promised more than there was.
constexpr int kPauseMs = 1;

}  // namespace

FdSink::FdSink(int fd) : fd_(fd) {
  struct stat what {};
  if (::fstat(fd, &what) != 0) return;
  socket_ = S_ISSOCK(what.st_mode);
  // O_NONBLOCK belongs to all who share a description; so it gets one of its own.
  if (!S_ISFIFO(what.st_mode) && ::isatty(fd) == 0) return;
  own_ = ::open(("/proc/self/fd/" + std::to_string(fd)).c_str(),
                O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
}

FdSink::~FdSink() {
  if (own_ >= 0) ::close(own_);
}

bool FdSink::drained_by(Nanos at) noexcept {
  return drained_.try_acquire_for(
      std::chrono::nanoseconds(std::max<Nanos>(at - monotonic_now(), 0)));
}

bool FdSink::give(std::string_view text) noexcept {
  while (!text.empty()) {
    if (!writable()) return false;
    const ssize_t count = put(text.substr(0, PIPE_BUF));  // what is free at once
    if (count > 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
    } else if (count < 0 && errno == EAGAIN) {
      // Another program was quicker.
      if (monotonic_now() > end_by_) return false;
      ::poll(nullptr, 0, kPauseMs);
    } else if (count < 0 && errno != EINTR) {
      return false;
    }
  }
  return true;
}

ssize_t FdSink::put(std::string_view text) const noexcept {
  if (socket_) return ::send(fd_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  return ::write(own_ >= 0 ? own_ : fd_, text.data(), text.size());
}

bool FdSink::writable() const noexcept {
  for (;;) {
    const Nanos left = std::clamp<Nanos>(end_by_ - monotonic_now(), 0, kLook);
    pollfd wanted{own_ >= 0 ? own_ : fd_, POLLOUT, 0};
    const int ready = ::poll(&wanted, 1, static_cast<int>(left / kMillisecond));
    if (ready > 0) return true;  // or broken, as write() will say
    if (left == 0) return false;
  }
}

}  // namespace handrail
