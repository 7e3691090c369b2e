// The serial end of a Magellan, at a pseudo-terminal: what spacenavd takes for a SpaceMouse.
//
// Source: FreeSpacenav/spacenavd, src/dev_serial.c.
#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <string>

namespace handrail::test {

// Says what it is when it is asked.
class Magellan {
 public:
  Magellan() : fd_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    if (fd_ < 0 || ::grantpt(fd_) != 0 || ::unlockpt(fd_) != 0) return;
    path_ = ::ptsname(fd_);
    termios raw{};
    ::tcgetattr(fd_, &raw);
    ::cfmakeraw(&raw);
    ::tcsetattr(fd_, TCSANOW, &raw);
  }
  ~Magellan() { ::close(fd_); }
  Magellan(const Magellan&) = delete;
  Magellan& operator=(const Magellan&) = delete;

  // Empty: there is no pseudo-terminal to be had.
  const std::string& path() const { return path_; }
  // True from when the daemon has set its mode.
  bool answer() {
    std::array<char, 256> bytes;
    const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
    if (n > 0) heard_.append(bytes.data(), static_cast<std::size_t>(n));
    if (!told_ && heard_.find("vQ\r") != std::string::npos) {
      told_ = say("vMAGELLAN  Version 6.60  \r");
    }
    return heard_.find("m3\r") != std::string::npos;
  }
  const std::string& heard() const { return heard_; }
  // False: the line is full, and nothing of it was taken.
  [[nodiscard]] bool push(const std::array<int, 6>& counts) {
    std::string line = "d";
    for (const int count : counts) line += nibbles(count + 0x8000, 4);
    return say(line + "\r");
  }
  [[nodiscard]] bool press(int buttons) { return say("k" + nibbles(buttons, 3) + "\r"); }

 private:
  // The low four bits of a character count; with its parity it is one of these.
  static std::string nibbles(int value, int count) {
    std::string out;
    // Of motion the highest is first, of buttons the lowest.
    for (int i = 0; i < count; ++i) {
      const int shift = count == 4 ? 4 * (3 - i) : 4 * i;
      out += "0AB3D56GH9:K<MN?"[value >> shift & 0xf];
    }
    return out;
  }
  bool say(const std::string& line) {
    return ::write(fd_, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  }

  int fd_;
  std::string path_, heard_;
  bool told_ = false;
};

}  // namespace handrail::test
