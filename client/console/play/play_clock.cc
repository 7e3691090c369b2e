#include "client/console/play/play_clock.h"

#include <algorithm>
#include <cmath>

namespace handrail {

PlayState PlayClock::state(Nanos now) const {
  PlayState out{PlayState::Is::kPaused, from_, speed_, jumps_, orders_};
  if (!playing_) return out;
  const double way = static_cast<double>(std::max<Nanos>(now - since_, 0)) * speed_;
  const auto left = static_cast<double>(length_ - from_);
  out.position = way < left ? std::min<Nanos>(from_ + std::llround(way), length_) : length_;
  out.is = way < left ? PlayState::Is::kPlaying : PlayState::Is::kEnded;
  return out;
}

Status PlayClock::take(const PlayOrder& order, Nanos now) {
  if (order.speed && !(*order.speed >= kSlowestPlay && *order.speed <= kFastestPlay)) {
    return Status::error("speed: " + std::to_string(*order.speed) + ", expected 0.1 to 10");
  }
  ++orders_;
  // From here on it goes from where it is.
  const PlayState was = state(now);
  from_ = was.position;
  since_ = now;
  if (order.position) {
    from_ = std::clamp<Nanos>(*order.position, 0, length_);
    ++jumps_;
  }
  if (order.speed) speed_ = *order.speed;
  if (order.playing && *order.playing && from_ == length_ && !order.position) {
    from_ = 0;
    ++jumps_;
  }
  if (order.playing) playing_ = *order.playing;
  return Status::ok();
}

}  // namespace handrail
