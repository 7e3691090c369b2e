#include "devices/evdev/rumble.h"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/signals.h"

namespace handrail {
namespace {

constexpr double kRumbleFull = 65535.0;  // [counts]
constexpr Nanos kRumblePeriod = 10 * kMillisecond;
// An effect that goes on is played anew before the kernel ends it.
constexpr Nanos kRumbleRefresh = 100 * kMillisecond;
constexpr int kRumbleNice = 10;  // behind all that is not told otherwise

std::uint16_t rumble_counts(double share) {
  if (!(share > 0.0)) return 0;
  return static_cast<std::uint16_t>(std::lround(kRumbleFull * std::min(share, 1.0)));
}

// The thread that starts this one may be a real-time one, and is not to be kept waiting by it.
void become_unimportant() {
  sched_param none{};
  (void)pthread_setschedparam(pthread_self(), SCHED_OTHER, &none);
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), kRumbleNice);
}

}  // namespace

RumbleStrength rumble_of(const HapticCue& cue, double share) noexcept {
  const double strength = std::clamp(share, 0.0, 1.0) * cue.strength;
  switch (cue.what) {
    case Felt::kContact:
    case Felt::kLimit: return {rumble_counts(strength), 0};
    case Felt::kHold:
    case Felt::kSingularity: return {0, rumble_counts(strength)};
    case Felt::kLost: return {rumble_counts(strength), rumble_counts(strength)};
    case Felt::kNothing: break;
  }
  return {};
}

void Rumble::start() {
  stop();
  if (!(share_ > 0.0)) return;
  stopping_.store(false, std::memory_order_relaxed);
  const SignalsBlocked blocked;
  thread_ = std::thread([this] { run(); });
}

void Rumble::stop() noexcept {
  if (!thread_.joinable()) return;
  stopping_.store(true, std::memory_order_relaxed);
  thread_.join();
}

void Rumble::run() noexcept {
  become_unimportant();
  HapticCue felt;
  Nanos felt_at = 0;
  while (!stopping_.load(std::memory_order_relaxed)) {
    const Nanos now = monotonic_now();
    if (FixedText<256> path; path_.take(path)) open(path);
    if (cue_.take(felt)) felt_at = now;
    const bool late = now - felt_at > kForceStands;
    if (fd_ >= 0) show(late ? RumbleStrength{} : rumble_of(felt, share_), now);
    sleep_until(now + kRumblePeriod);
  }
  close();
}

void Rumble::open(const FixedText<256>& path) noexcept {
  close();
  if (text_of(path).empty()) return;
  fd_ = kernel_.open_to_write(path.data());
  if (fd_ < 0) return;
  constexpr std::size_t kWordBits = 8 * sizeof(unsigned long);
  std::array<unsigned long, (FF_CNT + kWordBits - 1) / kWordBits> can{};
  const bool known = kernel_.control(fd_, EVIOCGBIT(EV_FF, sizeof can), can.data()) >= 0;
  if (known && (can[FF_RUMBLE / kWordBits] >> FF_RUMBLE % kWordBits & 1) != 0) return;
  ::close(fd_);
  fd_ = -1;
}

void Rumble::show(const RumbleStrength& wanted, Nanos now) noexcept {
  const bool goes_on = !wanted.off() && now - shown_at_ >= kRumbleRefresh;
  if (wanted == shown_ && !goes_on) return;
  shown_ = wanted;
  shown_at_ = now;
  if (wanted.off()) return play(false);
  effect_.type = FF_RUMBLE;
  effect_.replay.length = kRumbleLasts;
  effect_.u.rumble.strong_magnitude = wanted.strong;
  effect_.u.rumble.weak_magnitude = wanted.weak;
  // One that is unplugged meanwhile is told by use().
  if (kernel_.control(fd_, EVIOCSFF, &effect_) >= 0) play(true);
}

void Rumble::play(bool on) noexcept {
  if (effect_.id < 0) return;
  input_event event{};
  event.type = EV_FF;
  event.code = static_cast<std::uint16_t>(effect_.id);
  event.value = on ? 1 : 0;
  (void)kernel_.write(fd_, event);
}

void Rumble::close() noexcept {
  if (fd_ >= 0) {
    if (!shown_.off()) play(false);
    ::close(fd_);  // the kernel forgets the effect
  }
  fd_ = -1;
  effect_ = {};
  effect_.id = -1;  // not uploaded yet
  shown_ = {};
}

}  // namespace handrail
