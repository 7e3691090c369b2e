// The haptic thread's work: device, step, device, a thousand times a second.
#pragma once

#include <atomic>

#include "devices/hand/sim_handle_sensor.h"
#include "devices/haptic_device.h"
#include "server/base/pacer.h"
#include "server/master/mailboxes.h"
#include "server/record/record_tap.h"

namespace handrail {

// Of the handle's sensor, for the loop: it shows and keeps what is felt, and nothing else changes.
struct HandleSetup {
  Vec3 lever_M = Vec3::Zero();  // as in handle_force
  SimHandleSensor* simulated =
      nullptr;  // told what the simulated hand does; null: another, or none
};

// One tick at a time; who calls it decides when. Real-time safe after construction.
class HapticLoop {
 public:
  static constexpr Nanos kPeriod = kMillisecond;

  // Device, mailboxes, tap and sensor must outlive the loop; the device is open. `tap`: where each
  // tick is left for who records; null: nobody does.
  HapticLoop(HapticDevice& device, const LoopScene& scene, MasterMailboxes& boxes, Nanos start,
             MasterTap* tap = nullptr, const HandleSetup& handle = {});

  // When the next tick should run.
  Nanos due() const noexcept { return pacer_.due(); }
  // One tick at `now`: read the device, step, write the device, publish. `turn`: when it was due,
  // as HapticDevice::wait says.
  void tick(Nanos now, Nanos turn) noexcept;
  void tick(Nanos now) noexcept { tick(now, due()); }

  // Asks the loop to disengage and let the force go. From any thread.
  void request_stop() noexcept { stop_requested_.store(true, std::memory_order_relaxed); }
  // True once the slave has had time to hear of it and the force is gone. From any thread.
  bool finished() const noexcept { return finished_.load(std::memory_order_acquire); }

 private:
  void take_scene() noexcept;
  void take_slave(Nanos now) noexcept;
  void read_hand(Nanos now) noexcept;
  void read_handle() noexcept;
  // For who records: what the loop remembers, when that is due, and each tick.
  void keep_image(Nanos now) noexcept;
  void keep_tick(Nanos now) noexcept;
  // The next order of the queue, after those for the hand were carried out.
  OrderTicket next_order() noexcept;
  void publish(Nanos now) noexcept;

  HapticDevice& device_;
  HapticRun run_;
  MasterMailboxes& boxes_;
  Pacer pacer_;
  HapticTick tick_;
  std::uint64_t missed_ = 0;  // forces that came too late for the device's turn
  HapticReport report_;
  MasterTap* tap_;
  KeptTick kept_;
  std::uint64_t begins_;  // where the loop's epochs do, until that is kept
  SlaveNews news_;
  LoopScene next_scene_;
  CursorSample cursor_;
  HandleSetup handle_;
  HandleReading handle_reading_;
  FeltShare felt_share_;
  Nanos last_tick_;
  Nanos stop_since_ = -1;
  std::atomic<bool> stop_requested_{false};
  std::atomic<bool> finished_{false};
};

}  // namespace handrail
