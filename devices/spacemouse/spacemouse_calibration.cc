#include "devices/spacemouse/spacemouse_calibration.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>

#include "devices/spacemouse/spacemouse_driver.h"

namespace handrail {
namespace {

// Our choice.
constexpr Nanos kCapLeftAlone = 1500 * kMillisecond;
constexpr Nanos kLongestCalibration = 60 * kSecond;
constexpr Nanos kGrownOut = 3 * kSecond;
// The cap goes as far each way, but for what springs and hands differ.
constexpr double kLeastShare = 0.5;
// As the configuration has it; below it a single count is a jump of a tenth.
constexpr std::int32_t kLeastFull = 10;
// Of 350 at full deflection a twentieth: the hand would creep by 2.5 mm/s.
constexpr std::int32_t kMostAtRest = 17;

constexpr std::array kAxisWords = {"right and left", "up and down", "toward and away",
                                   "tipping",        "turning",     "leaning"};

}  // namespace

SpaceMouseCalibration::SpaceMouseCalibration(int fd, const SpaceMouseOptions& options)
    : fd_(fd), options_(options) {}

SpaceMouseCalibration::~SpaceMouseCalibration() { ::close(fd_); }

// False: spacenavd has gone.
bool SpaceMouseCalibration::receive() {
  std::array<std::uint8_t, 16 * kSpnavRecord> bytes;
  const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
  if (n < 0) return errno == EAGAIN || errno == EINTR;
  return n > 0 && stream_.take({bytes.data(), static_cast<std::size_t>(n)});
}

bool SpaceMouseCalibration::turn(Nanos now) {
  if (!started_) {
    started_ = true;
    began_ = grew_at_ = now;
  }
  if (over_) return false;
  lost_ = !receive() || stream_.state().unplugged;
  if (!lost_) learn(now);
  over_ = lost_ || now - began_ >= kLongestCalibration ||
          (!resting_ && complete() && now - grew_at_ >= kGrownOut);
  return !over_;
}

void SpaceMouseCalibration::learn(Nanos now) {
  const auto& counts = stream_.state().counts;
  if (resting_) {
    for (const std::int32_t c : counts) rest_ = std::max(rest_, std::abs(c));
    resting_ = now - began_ < kCapLeftAlone;
    grew_at_ = now;
    return;
  }
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (counts[i] >= least_[i] && counts[i] <= most_[i]) continue;
    least_[i] = std::min(least_[i], counts[i]);
    most_[i] = std::max(most_[i], counts[i]);
    grew_at_ = now;
  }
}

int SpaceMouseCalibration::full_counts() const {
  std::int32_t out = most_[0];
  for (std::size_t i = 0; i < kAxes; ++i) out = std::min({out, most_[i], -least_[i]});
  return out;
}

// Each way has been pushed about as far as the farthest.
bool SpaceMouseCalibration::complete() const {
  std::int32_t farthest = 0;
  for (std::size_t i = 0; i < kAxes; ++i) farthest = std::max({farthest, most_[i], -least_[i]});
  return full_counts() >= kLeastFull && full_counts() >= kLeastShare * farthest;
}

std::string SpaceMouseCalibration::asks() const {
  if (over_) return {};
  if (resting_) return "leave the cap alone";
  return complete() ? "go on, or wait 3 s: each way was pushed"
                    : "push the cap as far as it goes, then turn it, both ways of each axis";
}

std::vector<TestItem> SpaceMouseCalibration::items() const {
  std::vector<TestItem> out;
  if (lost_) {
    out.push_back({"spacenavd", Verdict::kBad, "it has ended, or the device was unplugged",
                   "plug it in, see that spacenavd runs, and try anew"});
  }
  const bool creeps = rest_ > kMostAtRest;
  out.push_back(
      {"rest", creeps ? Verdict::kBad : Verdict::kOk,
       "at most " + std::to_string(rest_) + " counts while left alone, at most " +
           std::to_string(kMostAtRest) + " expected",
       creeps ? "let go of it; else set spacenavd's dead zone (dead-zone in /etc/spnavrc)" : ""});
  for (std::size_t i = 0; i < kAxes; ++i) {
    const std::int32_t least = std::min(most_[i], -least_[i]);
    const bool seen = least >= kLeastFull;
    out.push_back({"axis." + std::to_string(i + 1), seen ? Verdict::kOk : Verdict::kNotSeen,
                   std::string(kAxisWords[i]) + ": " + std::to_string(least_[i]) + " to " +
                       std::to_string(most_[i]) + " counts",
                   seen ? "" : "push it both ways, as far as it goes"});
  }
  if (over_ && !lost_ && !complete()) {
    out.push_back({"full_counts", Verdict::kNotSeen,
                   "one way was pushed less than half as far as another",
                   "try anew, each way as far as it goes"});
  }
  return out;
}

std::string SpaceMouseCalibration::block() const {
  if (!complete()) return {};
  SpaceMouseOptions found = options_;
  found.full_counts = full_counts();
  return spacemouse_block(found);
}

}  // namespace handrail
