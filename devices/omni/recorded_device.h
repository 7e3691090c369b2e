// A recorded hand behind the interface of a haptic device.
#pragma once

#include "devices/hand/recorded_hand.h"
#include "devices/haptic_device.h"

namespace handrail {

// Plays a recording once, from its first sample at the first reading after open(), and rests on its
// last sample. Feels no force. Reports the capabilities of a simulated Omni, so that loops keep its
// limits, but neither quantises nor senses rotation: the orientation is the identity, no button is
// ever pressed.
class RecordedDevice final : public HapticDevice {
 public:
  explicit RecordedDevice(RecordedMotion motion);

  const HapticCapabilities& capabilities() const override { return capabilities_; }
  Status open() override;
  // Not valid while closed.
  HapticSample read(Nanos now) noexcept override;
  void write(const Wrench&) noexcept override {}
  void close() noexcept override { open_ = false; }

  const RecordedMotion& motion() const noexcept { return motion_; }

 private:
  RecordedMotion motion_;
  HapticCapabilities capabilities_;
  Nanos start_ = 0;
  bool open_ = false;
  bool started_ = false;
};

}  // namespace handrail
