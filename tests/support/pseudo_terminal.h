// A terminal at which a test sits.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <string>

#include "server/base/clock.h"

namespace handrail {

class PseudoTerminal {
 public:
  PseudoTerminal() {
    works_ = ::openpty(&user_, &program_, nullptr, nullptr, nullptr) == 0;
    for (const int end : {user_, program_}) ::fcntl(end, F_SETFD, FD_CLOEXEC);
  }
  ~PseudoTerminal() {
    ::close(user_);
    ::close(program_);
  }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  bool works() const { return works_; }
  // What a program has for its output.
  int program() const { return program_; }
  // For a child's Streams.
  std::string path() const { return ::ttyname(program_); }
  void type(const std::string& text) const { (void)!::write(user_, text.data(), text.size()); }
  // All that is shown from here on, until `part` has been `count` times; "" where it does not come
  // within `patience`.
  std::string shown_until(const std::string& part, int count, Nanos patience) {
    std::string shown;
    const Nanos give_up = monotonic_now() + patience;
    while (monotonic_now() < give_up) {
      pollfd wanted{user_, POLLIN, 0};
      if (::poll(&wanted, 1, 100) != 1) continue;
      std::array<char, 4096> text;
      const ssize_t n = ::read(user_, text.data(), text.size());
      if (n <= 0) break;
      shown.append(text.data(), static_cast<std::size_t>(n));
      int found = 0;
      for (std::size_t at = 0; (at = shown.find(part, at)) != shown.npos; ++at) ++found;
      if (found >= count) return shown;
    }
    return "";
  }

 private:
  int user_ = -1, program_ = -1;
  bool works_ = false;
};

}  // namespace handrail
