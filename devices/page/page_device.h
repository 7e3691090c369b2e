// A haptic device whose hand is a cursor on a page.
#pragma once

#include <optional>

#include "devices/hand/hand_model.h"
#include "devices/haptic_device.h"

namespace handrail {

// A simulated hand means to be where the newest cursor is, and yields to the force like any hand:
// walls and tools keep the device from the cursor, and their difference is what a page shows as
// felt. Without a cursor in 200 ms the hand stays where it is and the third button, the dead-man,
// is let go. Turning is followed without resistance. In scenes of walls and of an arm alike; moves
// within soft stops 2 mm outside the work space. Simulated; deterministic for the same calls and
// times.
class PageDevice final : public HapticDevice, public SteerableHand {
 public:
  explicit PageDevice(const HandOptions& hand) noexcept;

  const HapticCapabilities& capabilities() const override { return capabilities_; }
  Status open() override;
  // Not valid while closed. The first reading after open() sets the time base; one that comes more
  // than a second after the last advances the model by a second, so that the work stays bounded.
  HapticSample read(Nanos now) noexcept override;
  // A force that is not finite counts as none; a torque is ignored.
  void write(const Wrench& f_H_M) noexcept override;
  void close() noexcept override;
  void simulate(const DeviceEffects& effects, const Vec3& home_M) noexcept override;
  // Not finite: ignored. A place outside the work space is taken for the nearest in it.
  void lead(const CursorSample& cursor) noexcept override;
  SteerableHand* hand() noexcept override { return this; }
  std::optional<Vec3> simulated_push() const noexcept override { return push_; }

  // Moves that are ordered, such as home: until the next cursor.
  void steer(const HandIntent& intent) noexcept override;
  bool moving() const noexcept override { return hand_.moving(); }

 private:
  void advance(Nanos now, double dt) noexcept;
  void observe(double dt) noexcept;

  HapticCapabilities capabilities_;
  HandModel hand_;
  CursorSample cursor_;
  bool led_ = false;             // by the cursor, since the last order
  bool fresh_ = false;           // the cursor, in the newest part of a reading
  VectorMotion intent_;          // the cursor's place after the second lag, frame M
  Vec3 halfway_ = Vec3::Zero();  // after the first [m]
  Quat turned_ = Quat::Identity();
  std::uint32_t buttons_ = 0;
  Wrench wrench_;
  Vec3 push_ = Vec3::Zero();  // of the hand, mean of the last reading [N]
  Nanos unrenewed_ = 0;       // how long wrench_ has acted
  HapticSample sample_;
  Nanos last_ = 0;
  bool open_ = false;
  bool started_ = false;
};

}  // namespace handrail
