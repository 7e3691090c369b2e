#include "devices/comedi/comedi_ft_sensor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/realtime.h"
#include "server/base/signals.h"

namespace handrail {
namespace {

constexpr Nanos kSaysNothing = 10 * kMillisecond;  // between two records that say there is none
// The kernel's driver takes about 12 s to find a sensor and its offsets.
constexpr Nanos kLongestSettling = 20 * kSecond;
// Below the robot's loop, above what is not urgent.
constexpr int kSensorPriority = 60;  // of SCHED_FIFO

}  // namespace

ComediFtSensor::ComediFtSensor(const ComediFtOptions& options, Say say)
    : options_(options),
      say_(std::move(say)),
      capabilities_{options.kind == ComediFtKind::kJr3 ? "JR3" : "analog force sensor",
                    options.range_n, options.range_n_m} {}

Status ComediFtSensor::start() {
  stop();
  source_ = make_ft_source(options_);
  if (!options_.waits) {
    if (const Status opened = open_source(); !opened) {
      source_.reset();
      return Status::error("force sensor: " + opened.message());
    }
  }
  FtSample left;
  (void)samples_.take(left);  // of the last session
  zero_ = newest_ = Wrench();
  sequence_ = 0;
  counts_from_ = said_at_ = -kForever;
  waiting_since_ = monotonic_now();
  waiting_ = true;
  named_ = false;
  stopping_.store(false, std::memory_order_relaxed);
  const SignalsBlocked blocked;
  thread_ = std::thread([this] { run(); });
  return Status::ok();
}

Status ComediFtSensor::open_source() {
  if (!loaded_) {
    const auto api = load_comedi(options_.place.library);
    if (!api) return api.status();
    api_ = *api;
    loaded_ = true;
  }
  return source_->open(api_);
}

void ComediFtSensor::stop() noexcept {
  if (!thread_.joinable()) return;
  stopping_.store(true, std::memory_order_relaxed);
  thread_.join();
  source_.reset();
  FtSample left;
  (void)samples_.take(left);
}

bool ComediFtSensor::waits_until(Nanos time) noexcept {
  while (!stopping_.load(std::memory_order_relaxed)) {
    const Nanos now = monotonic_now();
    if (now >= time) return true;
    sleep_until(std::min(time, now + kSaysNothing));
    note(FtTaken::kLost, {});
  }
  return false;
}

void ComediFtSensor::run() {
  (void)enter_realtime(kSensorPriority);
  open_again(!options_.waits);
  while (!stopping_.load(std::memory_order_relaxed)) {
    FtReading reading;
    std::uint32_t periods = 0;
    const FtTaken taken = source_->take(reading, periods);
    sequence_ += periods;
    note(taken, reading);
    if (taken != FtTaken::kLost) continue;
    say(true, "card or sensor is gone; it is looked for again");
    source_->close();
    open_again(false);
  }
  source_->close();
}

// Until it is open, or the thread ends.
void ComediFtSensor::open_again(bool already) {
  std::string last;
  while (!already) {
    if (!waits_until(monotonic_now() + options_.reopen_pause)) return;
    const Status opened = open_source();
    if (opened) break;
    if (opened.message() != last) say(true, opened.message());
    last = opened.message();
  }
  waiting_ = true;
  waiting_since_ = monotonic_now();
  named_ = false;
  say(false, source_->text());
}

void ComediFtSensor::note(FtTaken taken, const FtReading& reading) noexcept {
  const Nanos now = monotonic_now();
  if (taken == FtTaken::kReading) {
    if (std::exchange(waiting_, false)) {
      counts_from_ = now + source_->settling();
      const auto [force, torque] = source_->full_scale();
      full_force_.store(force, std::memory_order_relaxed);
      full_torque_.store(torque, std::memory_order_relaxed);
      say(false, source_->text() + ": readings come");
    }
    return publish(reading, reading.saturated | (now < counts_from_ ? kFtSettling : 0));
  }
  if (taken == FtTaken::kNothing) return;
  if (!std::exchange(waiting_, true)) waiting_since_ = now;
  if (taken == FtTaken::kNotYet && now - waiting_since_ > kLongestSettling &&
      !std::exchange(named_, true)) {
    say(true,
        "the card gives no readings after 20 s, and a sensor that settles takes 12; is it plugged "
        "in? sudo dmesg | grep jr3");
  }
  if (now - said_at_ < kSaysNothing) return;
  said_at_ = now;
  if (taken == FtTaken::kLost) ++sequence_;
  publish({}, taken == FtTaken::kLost ? kFtLost : kFtSettling);
}

void ComediFtSensor::publish(const FtReading& reading, std::uint32_t status) noexcept {
  FtSample sample;
  sample.wrench = at_tip(options_.mount, {reading.value.head<3>(), reading.value.tail<3>()});
  sample.sequence = sequence_;
  sample.status = status;
  // What settles may pass full scale on its way.
  sample.overrange = reading.saturated != 0 && (status & kFtSettling) == 0;
  samples_.publish(sample);
}

void ComediFtSensor::say(bool bad, const std::string& line) {
  {
    const std::lock_guard lock(mutex_);
    if (text_ == line) return;
    text_ = line;
  }
  if (say_) say_(bad, "force sensor: " + line);
}

std::string ComediFtSensor::text() const {
  const std::lock_guard lock(mutex_);
  return text_;
}

bool ComediFtSensor::poll(Nanos, FtSample& sample) noexcept {
  if (!thread_.joinable() || !samples_.take(sample)) return false;
  if ((sample.status & (kFtLost | kFtSettling)) == 0) newest_ = sample.wrench;
  sample.wrench.force -= zero_.force;
  sample.wrench.torque -= zero_.torque;
  return true;
}

void ComediFtSensor::bias() noexcept { zero_ = newest_; }

}  // namespace handrail
