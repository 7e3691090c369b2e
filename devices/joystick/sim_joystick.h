// A simulated 2-DOF joystick in a simulated hand, or in one that means a recorded motion.
#pragma once

#include <optional>

#include "devices/hand/hand_model.h"
#include "devices/hand/hand_pursuit.h"
#include "devices/hand/recorded_hand.h"
#include "devices/haptic_device.h"
#include "devices/joystick/joystick_data.h"
#include "server/base/plane.h"
#include "server/model/effect_list.h"

namespace handrail {

// Moves in M's X and Y, Z = 0, without turning. Inertia, friction, the counts of the encoders and
// the force limits are simulated as asked for; the velocity is the low-passed difference of
// readings, as drivers give it. The stick stops softly 2 mm outside +-100 mm (our choice).
// Simulated; deterministic for the same seed, calls and times.
class SimJoystick final : public HapticDevice, public SteerableHand {
 public:
  // With `recording`, the hand means to go where the recording goes, from the first reading on, and
  // its grip decides how far walls keep it from there.
  explicit SimJoystick(const HandOptions& hand, const DeviceEffects& effects = {},
                       std::optional<RecordedMotion> recording = std::nullopt);

  const HapticCapabilities& capabilities() const override { return capabilities_; }
  Status open() override;
  // Not valid while closed. The first reading after open() sets the time base; one that comes more
  // than a second after the last advances the model by a second, so that the work stays bounded.
  HapticSample read(Nanos now) noexcept override;
  // A force that is not finite counts as none; torque and Z are ignored.
  void write(const Wrench& f_H_M) noexcept override;
  void close() noexcept override;
  SteerableHand* hand() noexcept override { return recording_ ? nullptr : this; }
  std::optional<Vec3> simulated_push() const noexcept override { return push_; }
  void simulate(const DeviceEffects& effects, const Vec3& home_M) noexcept override;

  // Moves in the plane only. Ends following.
  void steer(const HandIntent& intent) noexcept override;
  bool moving() const noexcept override { return hand_.moving(); }

  // The hand follows a target, such as a guiding ball, that is at `p` with velocity `v` now; to be
  // called each tick while it lasts. Frame M. Not finite: ignored.
  void follow(const Vec2& p, const Vec2& v) noexcept;
  // The hand goes limp, until the next order: what it means to do gives way to where it is taken,
  // so that it only drags. No recorded hand does.
  void let_go() noexcept;

  // The truth behind the readings, frame M.
  Vec2 position() const noexcept { return hand_.pose().p.head<2>(); }    // [m]
  Vec2 velocity() const noexcept { return hand_.velocity().head<2>(); }  // [m/s]
  // Force of the hand on the handle, as a sensor between them would feel it [N].
  Vec2 handle_force() const noexcept { return hand_.push().head<2>(); }

 private:
  enum class Mode { kSteered, kFollowing, kLimp };

  void advance(double dt) noexcept;
  void observe(double dt) noexcept;
  Vec3 reading() const noexcept;

  HapticCapabilities capabilities_;
  DeviceEffects effects_;
  HandModel hand_;
  std::optional<RecordedMotion> recording_;
  double played_ = 0.0;  // of the recording [s]
  HandPursuit pursuit_;
  VectorMotion target_;
  Mode mode_ = Mode::kSteered;
  Wrench wrench_;
  Vec3 push_ = Vec3::Zero();  // of the hand, mean of the last reading [N]
  Nanos unrenewed_ = 0;       // how long wrench_ has acted
  HapticSample sample_;
  Nanos last_ = 0;
  bool open_ = false;
  bool started_ = false;
};

}  // namespace handrail
