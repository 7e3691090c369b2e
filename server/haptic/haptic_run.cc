#include "server/haptic/haptic_run.h"

#include <cstring>

namespace handrail {

void HapticRun::change(const LoopScene& scene) noexcept {
  Arbiter& arbiter = memory_.state.force.arbiter;
  if (scene_.walls != nullptr) arbiter = scene_.walls->state.arbiter;
  scene_ = scene;
  if (scene_.walls != nullptr) scene_.walls->state.arbiter = arbiter;
  memory_.walls.stage = 0;
  memory_.walls.screw_c = -1.0;
}

void HapticRun::let_go() noexcept {
  ForceState& force = memory_.state.force;
  force.cut();
  force.cue.cut(Cue::kNone);
  force.torque.setZero();
  if (scene_.walls != nullptr) scene_.walls->state.cut();
}

const HapticResult& HapticRun::tick(const HapticTick& tick) noexcept {
  if (tick.let_go) let_go();
  in_ = tick.in;
  HapticOrder& order = in_.order;
  if (tick.ends) {
    order = HapticOrder();
    order.kind = OrderKind::kDisengage;
  }
  if (scene_.walls != nullptr && order.kind == OrderKind::kStage && order.stage >= 0 &&
      static_cast<std::size_t>(order.stage) < scene_.walls->settings.walls->stages.size()) {
    memory_.walls.stage = order.stage;
    ++memory_.walls.stage_orders;
    order = HapticOrder();
  }
  if (scene_.walls != nullptr && order.kind == OrderKind::kScrew) {
    memory_.walls.screw_c = order.screw_c;
    order = HapticOrder();
  }
  haptic_step(scene_.haptic, in_, tick.dt, memory_.state, memory_.result.out);
  memory_.result.has_walls = scene_.walls != nullptr;
  if (scene_.walls != nullptr) feel_walls(tick, in_);
  return memory_.result;
}

void HapticRun::feel_walls(const HapticTick& tick, const HapticInput& in) noexcept {
  WallRun& run = *scene_.walls;
  WallInput& wall_in = memory_.walls;
  WallOutput& felt = memory_.result.walls;
  wall_in.hand = in.hand;
  wall_in.unseen = in.unseen;
  // Whoever leads by a cursor feels walls while the dead-man is held; a hand on a device lets go of
  // it.
  const LeadState& lead = memory_.state.lead;
  wall_in.release = (tick.led_by_cursor && !lead.present) || lead.stop_latched() || tick.ends;
  wall_step(run.settings, wall_in, tick.dt, run.state, felt);
  HapticOutput& out = memory_.result.out;
  out.f_H_M = felt.f_H_M;
  out.shares = felt.shares;
  out.force = felt.ledger;
  out.energy_made = felt.energy_made;
  out.reasons.add(felt.reasons);
}

std::size_t HapticRun::save(std::span<std::byte> out) const noexcept {
  if (out.size() < kMostImage) return 0;
  std::byte* to = out.data();
  std::memcpy(to, static_cast<const void*>(&memory_), sizeof(memory_));
  to += sizeof(memory_);
  if (scene_.walls == nullptr) return sizeof(memory_);
  const WallMemory& walls = scene_.walls->state;
  std::memcpy(to, static_cast<const void*>(&walls), sizeof(walls));
  to += sizeof(walls);
  return sizeof(memory_) + sizeof(walls) +
         scene_.walls->state.proxy->save(
             std::span<std::byte, WallProxy::kMostImage>(to, WallProxy::kMostImage));
}

bool HapticRun::restore(std::span<const std::byte> image) noexcept {
  const std::size_t walls = scene_.walls == nullptr ? 0 : sizeof(WallMemory);
  if (image.size() < sizeof(memory_) + walls) return false;
  const auto proxy = image.subspan(sizeof(memory_) + walls);
  if (scene_.walls == nullptr ? !proxy.empty() : !scene_.walls->state.proxy->restore(proxy)) {
    return false;
  }
  std::memcpy(static_cast<void*>(&memory_), image.data(), sizeof(memory_));
  if (scene_.walls == nullptr) return true;
  WallMemory& state = scene_.walls->state;
  std::memcpy(static_cast<void*>(&state), image.data() + sizeof(memory_), sizeof(state));
  return true;
}

}  // namespace handrail
