#include "server/daemon/service_socket.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace handrail {
namespace {

constexpr Nanos kLongestPause = 20 * kMillisecond;
constexpr int kSignsInTime = 4;

const char* variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

ServiceSocket::ServiceSocket() {
  const std::string_view path = variable("NOTIFY_SOCKET");
  ::sockaddr_un address{};
  // A path, or an abstract name after '@'.
  if (path.size() < 2 || path.size() >= sizeof address.sun_path) return;
  if (path[0] != '/' && path[0] != '@') return;
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), path.size());
  if (path[0] == '@') address.sun_path[0] = '\0';
  socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const auto length = static_cast<::socklen_t>(offsetof(::sockaddr_un, sun_path) + path.size());
  if (socket_ < 0) return;
  if (::connect(socket_, reinterpret_cast<const ::sockaddr*>(&address), length) != 0) {
    ::close(socket_);
    socket_ = -1;
    return;
  }
  const std::string_view text = variable("WATCHDOG_USEC");
  Nanos us = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), us);
  const bool asked = error == std::errc() && end == text.data() + text.size() && us > 0;
  if (asked)
    pause_ =
        std::min(us, kLongestPause / kMicrosecond * kSignsInTime) * kMicrosecond / kSignsInTime;
}

ServiceSocket::~ServiceSocket() {
  if (socket_ >= 0) ::close(socket_);
}

void ServiceSocket::tick(Nanos now, bool runs) noexcept {
  if (pause_ == 0 || !runs || now < next_) return;
  next_ = now + pause_;
  send("WATCHDOG=1");
}

void ServiceSocket::send(const char* text) noexcept {
  if (socket_ < 0) return;
  // A manager that does not read loses a sign, not us our time.
  (void)::send(socket_, text, std::strlen(text), MSG_NOSIGNAL | MSG_DONTWAIT);
}

}  // namespace handrail
