// A simulated Phantom Omni in a simulated hand.
#pragma once

#include <optional>

#include "devices/hand/hand_model.h"
#include "devices/haptic_device.h"
#include "devices/omni/omni_data.h"

namespace handrail {

// Mass, friction and soft stops of the device move with the hand; the force saturates at the peak,
// a torque only in the torque variant. Positions are read in steps of the resolution, per axis of M
// (the real one counts in joint space); the velocity is their low-passed difference, as drivers
// give it; the orientation is unquantised. The stops stand 10 mm outside the nominal work space
// (our choice). Simulated; deterministic for the same seed, calls and times.
class SimOmni final : public HapticDevice {
 public:
  SimOmni(const HandOptions& hand, bool torque) noexcept;

  const HapticCapabilities& capabilities() const override { return capabilities_; }
  Status open() override;
  // Not valid while closed. The first reading after open() sets the time base; one that comes more
  // than a second after the last advances the model by a second, so that the work stays bounded.
  HapticSample read(Nanos now) noexcept override;
  // A wrench that is not finite counts as none.
  void write(const Wrench& f_H_M) noexcept override;
  void close() noexcept override;
  void simulate(const DeviceEffects& effects, const Vec3& home_M) noexcept override;
  SteerableHand* hand() noexcept override { return &hand_; }
  std::optional<Vec3> simulated_push() const noexcept override { return push_; }

 private:
  void observe(double dt) noexcept;

  HapticCapabilities capabilities_;
  HandModel hand_;
  Wrench wrench_;
  Vec3 push_ = Vec3::Zero();  // of the hand, mean of the last reading [N]
  Nanos unrenewed_ = 0;       // how long wrench_ has acted
  HapticSample sample_;
  Nanos last_ = 0;
  bool open_ = false;
  bool started_ = false;
};

}  // namespace handrail
