#include "server/haptic/stage_watch.h"

#include <algorithm>
#include <utility>

#include "server/effects/effect_input.h"

namespace handrail {
namespace {

constexpr double kSettling = 5.0 * kEffectChange;  // 0.7 % of a change are left then [s]

bool holds(const StageCondition& when, const StageSigns& signs) noexcept {
  switch (when.kind) {
    case StageCondition::Kind::kNone: return false;
    case StageCondition::Kind::kInside: return signs.region == when.index;
    case StageCondition::Kind::kTurnedOver: return signs.turned > when.angle;
    case StageCondition::Kind::kTurnedUnder: return signs.turned < when.angle;
    case StageCondition::Kind::kLocked: return signs.place == when.index;
    case StageCondition::Kind::kUnlocked: return signs.place != when.index;
  }
  return false;
}

}  // namespace

int StageWatch::now(const Walls& walls, int ordered, std::uint32_t orders, double dt) noexcept {
  const int last = std::max(static_cast<int>(walls.stages.size()) - 1, 0);
  settled_ = std::min(settled_ + dt, kSettling);
  if (stage_ < 0 || ordered != ordered_ || orders != orders_) {
    led_to_ = std::clamp(ordered, 0, last);
    settled_ = kSettling;
  }
  ordered_ = ordered;
  orders_ = orders;
  if (led_to_ < 0 || settled_ < kSettling) return stage_;
  if (led_to_ != stage_) settled_ = 0.0;
  stage_ = std::exchange(led_to_, -1);
  return stage_;
}

void StageWatch::see(const Walls& walls, const StageSigns& signs) noexcept {
  const int count = static_cast<int>(walls.stages.size());
  for (int i = 0; i < std::min(count, kMostStages); ++i) {
    const std::uint64_t bit = std::uint64_t{1} << i;
    const bool now = holds(walls.stages[static_cast<std::size_t>(i)].when, signs);
    if (now && (true_ & bit) == 0) led_to_ = i;
    true_ = now ? true_ | bit : true_ & ~bit;
  }
}

}  // namespace handrail
