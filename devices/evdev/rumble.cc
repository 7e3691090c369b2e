#include "devices/evdev/rumble.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

constexpr double kRumbleFull = 65535.0;  // [counts]
// An effect that goes on is played anew before the kernel ends it.
constexpr Nanos kRumbleRefresh = 100 * kMillisecond;

std::uint16_t rumble_counts(double share) {
  if (!(share > 0.0)) return 0;
  return static_cast<std::uint16_t>(std::lround(kRumbleFull * std::min(share, 1.0)));
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
  if (share_ <= 0.0) return;
  motors_ = std::make_shared<Motors>(kernel_, share_);
  thread_.start(motors_);
}

void Rumble::Motors::use(const FixedText<256>& path) noexcept {
  end();
  if (!text_of(path).empty()) (void)motors_.open(path.data());
}

void Rumble::Motors::turn(Nanos now) noexcept {
  (void)told.take(felt_);
  const bool late = now - felt_.at > kForceStands;
  if (motors_.is_open()) show(late ? RumbleStrength{} : rumble_of(felt_.cue, share_), now);
}

void Rumble::Motors::show(const RumbleStrength& wanted, Nanos now) noexcept {
  const bool goes_on = !wanted.off() && now - shown_at_ >= kRumbleRefresh;
  if (wanted == shown_ && !goes_on) return;
  shown_ = wanted;
  shown_at_ = now;
  if (wanted.off()) {
    (void)motors_.play(effect_, false);
    return;
  }
  effect_.type = FF_RUMBLE;
  effect_.replay.length = kRumbleLasts;
  effect_.u.rumble.strong_magnitude = wanted.strong;
  effect_.u.rumble.weak_magnitude = wanted.weak;
  // One that is unplugged meanwhile is told by use().
  if (!motors_.upload(effect_)) return;
  // It may have taken so long that nobody feels anything any more.
  (void)told.take(felt_);
  const bool late = monotonic_now() - felt_.at > kForceStands;
  if (late) shown_ = {};
  (void)motors_.play(effect_, !late);
}

void Rumble::Motors::end() noexcept {
  if (!shown_.off()) (void)motors_.play(effect_, false);
  motors_.close();
  effect_ = {};
  effect_.id = -1;  // not uploaded yet
  shown_ = {};
}

}  // namespace handrail
