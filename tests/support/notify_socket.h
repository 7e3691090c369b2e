// A service manager's socket (sd_notify(3)), for tests: what programs say to it, and when.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <string>

#include "server/base/clock.h"

namespace handrail::test {

// While it lives, programs that are started find it in their environment.
class NotifySocket {
 public:
  NotifySocket(const std::string& path, const std::string& watchdog_us) {
    ::sockaddr_un address{};
    address.sun_family = AF_UNIX;
    EXPECT_LT(path.size(), sizeof address.sun_path);
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const ::sockaddr*>(&address), sizeof address), 0);
    ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
    ::setenv("WATCHDOG_USEC", watchdog_us.c_str(), 1);
  }
  ~NotifySocket() {
    ::unsetenv("NOTIFY_SOCKET");
    ::unsetenv("WATCHDOG_USEC");
    ::close(socket_);
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  // The next word, within `patience`; empty when none comes.
  std::string next(Nanos patience) {
    ::pollfd ready{socket_, POLLIN, 0};
    if (::poll(&ready, 1, static_cast<int>(patience / kMillisecond)) != 1) return {};
    std::array<char, 256> text{};
    const ssize_t n = ::recv(socket_, text.data(), text.size(), MSG_DONTWAIT);
    return n > 0 ? std::string(text.data(), static_cast<std::size_t>(n)) : std::string();
  }
  // Whether `word` comes within `patience`, whatever else does.
  bool hears(const std::string& word, Nanos patience) {
    for (const Nanos end = monotonic_now() + patience; monotonic_now() < end;) {
      if (next(kMillisecond) == word) return true;
    }
    return false;
  }
  void forget() {
    while (!next(0).empty()) {
    }
  }

 private:
  int socket_ = -1;
};

}  // namespace handrail::test
