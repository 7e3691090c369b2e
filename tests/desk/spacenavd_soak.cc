#include "tests/desk/spacenavd_soak.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "devices/spacemouse/spacemouse_device.h"
#include "devices/spacemouse/spnav_socket.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/support/real_spacenavd.h"

namespace handrail::desk {
namespace {

constexpr Nanos kDaemonPatience = 30 * kSecond;
constexpr Nanos kLastFrames = 500 * kMillisecond;  // for what is still on its way
// Of each count: above spacenavd's dead zone of 2, and below what a Magellan gives.
constexpr int kLeastCount = 10, kCountsEach = 300;
constexpr std::size_t kRecordBytes = 32;  // eight int32 (FreeSpacenav/spacenavd, src/proto_unix.c)
constexpr std::uint32_t kProtocolWord = 0x7faa5500;

// Reads the daemon's words by itself, not as the driver does.
class PlainClient {
 public:
  ~PlainClient() {
    if (fd_ >= 0) ::close(fd_);
  }
  bool connect(const std::string& path) {
    const auto connection = connect_spnav(path);
    if (connection) fd_ = connection->fd;
    return connection.is_ok();
  }
  // False: the daemon is gone.
  bool take(SoakFigures& figures) {
    std::array<char, 4096> bytes;
    for (;;) {
      const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
      if (n < 0) return errno == EAGAIN || errno == EINTR;
      if (n == 0) return false;
      left_.append(bytes.data(), static_cast<std::size_t>(n));
      while (take_one(figures)) {
      }
    }
  }

 private:
  bool take_one(SoakFigures& figures) {
    std::uint32_t word = 0;
    if (left_.size() < sizeof word) return false;
    std::memcpy(&word, left_.data(), sizeof word);
    const bool answer = (word & ~0xffu) == kProtocolWord;
    const std::size_t size = answer ? sizeof word : kRecordBytes;
    if (left_.size() < size) return false;
    std::array<std::int32_t, 8> words{};
    std::memcpy(words.data(), left_.data(), size);
    left_.erase(0, size);
    if (answer || words[0] != 0) return true;
    ++figures.told;
    const std::int64_t number =
        number_in({words[1], words[2], words[3], words[4], words[5], words[6]});
    const bool fits = number > last_ && number < static_cast<std::int64_t>(figures.pushed);
    figures.astray += fits ? 0 : 1;
    last_ = number;
    return true;
  }

  int fd_ = -1;
  std::string left_;
  std::int64_t last_ = -1;
};

// The daemon, our driver and who counts, a turn each millisecond.
class Soaking {
 public:
  explicit Soaking(const SpaceMouseOptions& options) : device_(options) {}

  Status begin(const std::string& socket) {
    if (Status opened = device_.open(); !opened) return opened;
    if (!plain_.connect(socket)) return Status::error("spacenavd takes no second client");
    // Both are known to the daemon before the first frame.
    return go(kLastFrames, [](Nanos) {}) ? Status::ok() : Status::error("spacenavd is gone");
  }
  // `each`: at the begin of every turn. False: the daemon is gone.
  template <typename Each>
  bool go(Nanos time, const Each& each) {
    Pacer pacer(kMillisecond, monotonic_now());
    for (Nanos now = monotonic_now(), end = now + time; now < end; now = monotonic_now()) {
      each(now);
      figures.invalid += device_.read(now).valid ? 0 : 1;
      if (!plain_.take(figures)) return false;
      sleep_until(pacer.due());
      (void)pacer.woke(monotonic_now());
    }
    figures.heard = device_.motions();
    late_ms = 1e3 * to_seconds(pacer.lateness().quantile(0.999));
    return true;
  }

  SoakFigures figures;
  double late_ms = 0.0;  // of the last go()

 private:
  SpaceMouseDevice device_;
  PlainClient plain_;
};

void push_until(test::Magellan& magellan, double due, SoakFigures& figures) {
  while (figures.pushed < static_cast<std::uint64_t>(due)) {
    if (!magellan.push(frame_of(figures.pushed))) {
      ++figures.waited;
      return;
    }
    ++figures.pushed;
  }
}

}  // namespace

bool whole(const SoakFigures& f) {
  return f.pushed > 0 && f.told > 0 && f.heard == f.told && f.astray == 0 && f.invalid == 0;
}

// In the first three counts, the rest pushed the other way so that signs are seen as well.
std::array<int, 6> frame_of(std::uint64_t number) {
  std::array<int, 6> out{};
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = kLeastCount + static_cast<int>(number % kCountsEach);
    out[i + 3] = -out[i];
    number /= kCountsEach;
  }
  return out;
}

// spacenavd reverses some of the axes.
std::int64_t number_in(const std::array<std::int32_t, 6>& counts) {
  std::int64_t out = 0;
  for (std::size_t i = 3; i-- > 0;) {
    const int digit = std::abs(counts[i]) - kLeastCount;
    if (digit < 0 || digit >= kCountsEach || std::abs(counts[i + 3]) != std::abs(counts[i])) {
      return -1;
    }
    out = out * kCountsEach + digit;
  }
  return out;
}

Result<SoakFigures> soak(const SoakPlan& plan, const std::function<bool()>& stopped) {
  if (!test::RealSpacenavd::installed()) return Status::error(test::RealSpacenavd::kMissing);
  test::RealSpacenavd daemon;
  if (!daemon.start(kDaemonPatience)) {
    return Status::error("spacenavd does not take the Magellan; " + daemon.log());
  }
  SpaceMouseOptions options;
  options.socket = daemon.socket();
  Soaking soaking(options);
  if (const Status begun = soaking.begin(options.socket); !begun) return begun;
  soaking.figures = SoakFigures();  // before the device was told of it was not valid
  const Nanos began = monotonic_now();
  for (double done = 0.0; done < plan.seconds && !stopped();) {
    // A second at a time, so that it can be stopped.
    const bool there =
        soaking.go(std::min(kSecond, from_seconds(plan.seconds - done)), [&](Nanos now) {
          push_until(daemon.magellan, to_seconds(now - began) * plan.rate, soaking.figures);
        });
    if (!there) return Status::error("spacenavd is gone; " + daemon.log());
    soaking.figures.late_ms = std::max(soaking.figures.late_ms, soaking.late_ms);
    done = to_seconds(monotonic_now() - began);
  }
  soaking.figures.seconds = to_seconds(monotonic_now() - began);
  if (!soaking.go(kLastFrames, [](Nanos) {})) return Status::error("spacenavd is gone");
  return soaking.figures;
}

}  // namespace handrail::desk
