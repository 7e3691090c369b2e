#include "devices/omni/recorded_device.h"

#include <utility>

#include "devices/omni/omni_data.h"

namespace handrail {

RecordedDevice::RecordedDevice(RecordedMotion motion)
    : motion_(std::move(motion)), capabilities_(omni_capabilities(false)) {
  capabilities_.name = "recorded hand";
  capabilities_.senses_rotation = false;
}

Status RecordedDevice::open() {
  open_ = true;
  started_ = false;
  return Status::ok();
}

HapticSample RecordedDevice::read(Nanos now) noexcept {
  if (!open_) return {};
  if (!started_) {
    started_ = true;
    start_ = now;
  }
  const VectorMotion m = motion_.motion_at(to_seconds(now - start_));
  HapticSample sample;
  sample.X_MH.p = m.p;
  sample.v_MH = m.v;
  sample.valid = true;
  return sample;
}

}  // namespace handrail
