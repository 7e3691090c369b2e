// Debian's spacenavd, which believes that a Magellan is at a serial port: a pseudo-terminal of
// ours.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <string>

#include "devices/spacemouse/spacemouse_device.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/loopback/program.h"

namespace handrail {
namespace {

constexpr char kDaemon[] = "/usr/bin/spacenavd";

// The serial end of a Magellan. Says what it is when it is asked.
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

  const std::string& path() const { return path_; }
  // True from when the daemon has set its mode.
  bool answer() {
    std::array<char, 256> bytes;
    const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
    if (n > 0) heard_.append(bytes.data(), static_cast<std::size_t>(n));
    if (!told_ && heard_.find("vQ\r") != std::string::npos) {
      told_ = true;
      say("vMAGELLAN  Version 6.60  \r");
    }
    return heard_.find("m3\r") != std::string::npos;
  }
  const std::string& heard() const { return heard_; }
  void push(const std::array<int, 6>& counts) {
    std::string line = "d";
    for (const int count : counts) line += nibbles(count + 0x8000, 4);
    say(line + "\r");
  }
  void press(int buttons) { say("k" + nibbles(buttons, 3) + "\r"); }

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
  void say(const std::string& line) {
    EXPECT_EQ(::write(fd_, line.data(), line.size()), static_cast<ssize_t>(line.size()));
  }

  int fd_;
  std::string path_, heard_;
  bool told_ = false;
};

class RealSpacenavd : public ::testing::Test {
 protected:
  void SetUp() override {
    if (::access(kDaemon, X_OK) != 0) {
      GTEST_SKIP() << kDaemon << " is not installed: client/install --tests";
    }
    ASSERT_FALSE(magellan.path().empty());
    // Not as a daemon it has its socket below the folder in which it was started.
    ASSERT_EQ(::mkdir((folder.path() + "/run").c_str(), 0700), 0);
    folder.write("rc", "serial = " + magellan.path() + "\n");
    const std::string& at = folder.path();
    daemon = std::make_unique<Program>(
        folder, "/bin/sh",
        std::vector<std::string>{"-c", "cd '" + at + "' && exec " + kDaemon + " -d -v -c '" + at +
                                           "/rc' -l '" + at + "/log'"});
    options.socket = at + "/run/spnav.sock";
    device = std::make_unique<SpaceMouseDevice>(options);
    const Nanos give_up = monotonic_now() + Program::kPatience;
    while (!(there = magellan.answer() && device->open().is_ok()) && monotonic_now() < give_up) {
      ASSERT_TRUE(daemon->running()) << daemon->output();
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    ASSERT_TRUE(there) << "heard: " << magellan.heard() << "\n" << daemon->output();
  }
  // Until `is` holds of a reading, at most for the patience; pushes anew every 20 ms if asked to.
  template <typename Is>
  bool becomes(Is is, const std::array<int, 6>* push = nullptr) {
    const Nanos give_up = monotonic_now() + Program::kPatience;
    Nanos next = 0;
    while (monotonic_now() < give_up) {
      if (push != nullptr && monotonic_now() >= next) {
        magellan.push(*push);
        next = monotonic_now() + 20 * kMillisecond;
      }
      last = device->read(monotonic_now());
      if (is(last)) return true;
      sleep_until(monotonic_now() + kMillisecond);
    }
    return false;
  }

  TempFolder folder;
  Magellan magellan;
  SpaceMouseOptions options;
  std::unique_ptr<Program> daemon;
  std::unique_ptr<SpaceMouseDevice> device;
  HapticSample last;
  bool there = false;
};

TEST_F(RealSpacenavd, ThePushOfEachAxisMovesThatOfMAndEnds) {
  for (int axis = 0; axis < 3; ++axis) {
    std::array<int, 6> counts{};
    counts[static_cast<std::size_t>(axis)] = 350;
    const auto goes = [axis](const HapticSample& s) {
      return s.valid && s.v_MH[axis] > 0.04 && s.v_MH[axis] <= 0.05 + 1e-9;
    };
    EXPECT_TRUE(becomes(goes, &counts)) << axis << ": " << last.v_MH.transpose();
    const Vec3 others = last.v_MH - last.v_MH[axis] * Vec3::Unit(axis);
    EXPECT_LT(others.norm(), 1e-3) << axis;
    // It is held and never let go of: the daemon says nothing more.
    EXPECT_TRUE(becomes([](const HapticSample& s) { return s.v_MH.norm() < 1e-4; })) << axis;
  }
}

TEST_F(RealSpacenavd, ButtonsGoDownAndUpAndItsEndIsNoReading) {
  EXPECT_TRUE(becomes([](const HapticSample& s) { return s.valid && s.buttons == 0; }));
  magellan.press(1);
  EXPECT_TRUE(becomes([](const HapticSample& s) { return s.buttons == 1; })) << last.buttons;
  magellan.press(2);
  EXPECT_TRUE(becomes([](const HapticSample& s) { return s.buttons == 2; })) << last.buttons;
  magellan.press(0);
  EXPECT_TRUE(becomes([](const HapticSample& s) { return s.buttons == 0; })) << last.buttons;
  daemon->kill();
  EXPECT_TRUE(becomes([](const HapticSample& s) { return !s.valid; }));
}

}  // namespace
}  // namespace handrail
