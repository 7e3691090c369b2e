// The haptic thread's work: device, step, device, a thousand times a second.
#pragma once

#include <atomic>

#include "devices/haptic_device.h"
#include "server/base/pacer.h"
#include "server/master/loop_scene.h"
#include "server/master/mailboxes.h"

namespace handrail {

// One tick at a time; who calls it decides when. Real-time safe after construction.
class HapticLoop {
 public:
  static constexpr Nanos kPeriod = kMillisecond;

  // Device and mailboxes must outlive the loop; the device is open.
  HapticLoop(HapticDevice& device, const LoopScene& scene, MasterMailboxes& boxes, Nanos start);

  // When the next tick should run.
  Nanos due() const noexcept { return pacer_.due(); }
  // One tick at `now`: read the device, step, write the device, publish.
  void tick(Nanos now) noexcept;

  // Asks the loop to disengage and let the force go. From any thread.
  void request_stop() noexcept { stop_requested_.store(true, std::memory_order_relaxed); }
  // True once the slave has had time to hear of it and the force is gone. From any thread.
  bool finished() const noexcept { return finished_.load(std::memory_order_acquire); }

 private:
  void let_go() noexcept;
  void take_scene() noexcept;
  void set_device() noexcept;
  void take_slave(Nanos now) noexcept;
  // The force of the scene's walls in place of an arm's.
  void feel_walls(double dt) noexcept;
  // The next order of the queue, after those for the hand were carried out.
  OrderTicket next_order() noexcept;
  void publish(Nanos now) noexcept;

  HapticDevice& device_;
  LoopScene scene_;
  MasterMailboxes& boxes_;
  Pacer pacer_;
  HapticInput input_;
  HapticState state_;
  HapticReport report_;
  WallInput wall_in_;
  WallOutput wall_out_;
  SlaveNews news_;
  LoopScene next_scene_;
  CursorSample cursor_;
  Nanos last_tick_;
  Nanos stop_since_ = -1;
  std::atomic<bool> stop_requested_{false};
  std::atomic<bool> finished_{false};
};

}  // namespace handrail
