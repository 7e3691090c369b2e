#include "devices/rig/rig.h"

namespace handrail {

Rig::Rig(const RigOptions& options, Nanos start) noexcept
    : control_period_(options.controller.period),
      sensor_period_(options.sensor.period),
      control_next_(start + control_period_),
      sensor_next_(start + sensor_period_),
      controller_(options.controller),
      sensor_(options.sensor) {
  // The arm's time starts here.
  controller_.tick(start);
}

RigEvent Rig::step(Nanos now) noexcept {
  skip_late(now, control_period_, control_next_);
  skip_late(now, sensor_period_, sensor_next_);
  if (next() > now) return RigEvent::kNone;
  if (control_next_ <= sensor_next_) {
    controller_.tick(control_next_);
    control_next_ += control_period_;
    return RigEvent::kControl;
  }
  sensor_.tick();
  sensor_next_ += sensor_period_;
  return RigEvent::kSensor;
}

void Rig::skip_late(Nanos now, Nanos period, Nanos& next) noexcept {
  if (now - next <= kPatience) return;
  const Nanos count = (now - next) / period;
  skipped_ += static_cast<std::uint64_t>(count);
  next += count * period;
}

}  // namespace handrail
