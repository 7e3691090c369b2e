// The simulated laboratory without sockets: controller, arm and force sensor on one clock.
#pragma once

#include <cstdint>

#include "devices/rig/controller.h"
#include "devices/rig/ft_source.h"

namespace handrail {

struct RigOptions {
  ControllerOptions controller;
  FtSourceOptions sensor;
};

enum class RigEvent : std::uint8_t {
  kNone,     // nothing is due
  kControl,  // a control cycle ran: controller().replies() are its packets
  kSensor,   // a sensor period ran: sensor().record() is its packet
};

// Same options, same datagrams at the same times: same answers, bit for bit. No allocation after
// construction; all calls are real-time safe.
//
//   while (rig.step(now) != RigEvent::kNone) { ... pass on what was sent ... }
class Rig {
 public:
  // The first cycle and the first sensor period are one period after `start`.
  Rig(const RigOptions& options, Nanos start) noexcept;

  // Runs the earliest cycle or period due at `now`, if any, at its own time. One that is more than
  // kPatience late is left out: the arm still moves by the time passed, but nobody gets a burst.
  RigEvent step(Nanos now) noexcept;
  // When the next cycle or period is due.
  Nanos next() const noexcept {
    return control_next_ < sensor_next_ ? control_next_ : sensor_next_;
  }

  Controller& controller() noexcept { return controller_; }
  const Controller& controller() const noexcept { return controller_; }
  FtSource& sensor() noexcept { return sensor_; }
  const FtSource& sensor() const noexcept { return sensor_; }
  // Cycles and periods left out so far.
  std::uint64_t skipped() const noexcept { return skipped_; }

  static constexpr Nanos kPatience = 100 * kMillisecond;

 private:
  void skip_late(Nanos now, Nanos period, Nanos& next) noexcept;

  Nanos control_period_;
  Nanos sensor_period_;
  Nanos control_next_;
  Nanos sensor_next_;
  std::uint64_t skipped_ = 0;
  Controller controller_;
  FtSource sensor_;
};

}  // namespace handrail
