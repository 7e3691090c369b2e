#include "devices/rig/rig_feed.h"

#include "server/base/clock.h"
#include "server/base/pacer.h"

namespace handrail {

void RigFeed::tell(const Rig& rig) noexcept {
  RigMoment now;
  now.number = ++number_;
  now.workpiece = workpiece_;
  now.at = rig.sensed_at();
  now.X_ST = rig.true_tip();
  now.unbent = now.X_ST.p;
  if (const World* world = rig.world()) {
    now.unbent = world->untouched();
    now.on_tip = world->on_tip();
    now.has_socket = world->has_socket();
    now.turned = world->screw_angle();
    now.depth = world->depth();
    now.off_flats = world->off_flats();
    now.slipped = world->slipped();
    now.jammed = world->jammed();
  }
  (void)moments_.push(now);
}

void RigFeed::serve(Rig& rig) noexcept {
  if (wanted_.load(std::memory_order_relaxed) == nullptr) return;
  Wanted* wanted = wanted_.exchange(nullptr, std::memory_order_acquire);
  if (wanted == nullptr) return;
  wanted->inside = rig.play(wanted->piece);
  if (!wanted->inside) ++workpiece_;
  wanted->served.store(true, std::memory_order_release);
}

Result<std::optional<TipInside>> RigFeed::play(const Workpiece& piece, Nanos patience) {
  Wanted wanted;
  wanted.piece = piece;
  wanted_.store(&wanted, std::memory_order_release);
  const Nanos give_up = monotonic_now() + patience;
  while (!wanted.served.load(std::memory_order_acquire)) {
    // Taken back, unless it is being carried out right now.
    if (monotonic_now() > give_up && wanted_.exchange(nullptr) != nullptr)
      return Status::error("the rig's own thread has not come by for it");
    sleep_until(monotonic_now() + kMillisecond);
  }
  return wanted.inside;
}

}  // namespace handrail
