// A simulated hand around the stylus of a haptic device. Simulated: it stands in for a person where
// there is none, and results obtained with it must be labelled so.
#pragma once

#include <cstdint>

#include "devices/hand/hand_motion.h"
#include "devices/hand/hand_wander.h"
#include "devices/haptic_device.h"
#include "server/base/spatial.h"

namespace handrail {

// The parameters of a simulated hand. All >= 0, masses and stiffnesses > 0.
struct HandOptions {
  std::uint64_t seed = 1;
  // Translational impedance. Within the range published for a stylus grip (Fu and Cavusoglu 2012:
  // third-order fits over nine subjects; 50 to 500 N/m).
  double mass = 0.12;        // [kg]
  double stiffness = 250.0;  // [N/m]
  double damping_ratio = 0.7;
  // Physiological tremor at the tip, root mean square over the three axes together, 8 to 12 Hz.
  // Riviere et al. 1997: 49 um mean while holding an instrument still.
  double tremor_rms = 0.05e-3;  // [m]
  // Slow wander, root mean square over the three axes together. Fitted to published manual
  // tele-operation results, not measured.
  double drift_rms = 0.97e-3;          // [m]
  double drift_rotation_rms = 0.0122;  // 0.7 deg [rad]
  double reaction = 0.2;               // simple visual reaction, 180 to 250 ms [s]
  // How far the tip strays when the stylus turns: the distance from tip to the pivot in the grip,
  // less what habit makes up for [m].
  double turn_lever = 0.0;
  // True: tremor and drift move what the hand means, as on a device as stiff as the hand; false:
  // they move the tip itself, past the device.
  bool wander_is_meant = false;
  // Rotational impedance, felt by devices with torque only. Our choice: a light precision grip.
  double rotation_inertia = 2e-4;   // [kg m^2]
  double rotation_stiffness = 1.0;  // [N m/rad]
  double rotation_damping_ratio = 0.7;
};

// What the hand holds: a point mass with friction between soft stops.
struct HeldBody {
  double mass = 0.0;                     // [kg]
  double friction = 0.0;                 // Coulomb, in any direction [N]
  double viscosity = 0.0;                // [N s/m]
  double inertia = 0.0;                  // of turning, in any direction [kg m^2]
  double turn_viscosity = 0.0;           // [N m s/rad]
  Vec3 stop_half = Vec3::Constant(1e3);  // the stops' distance from M's origin [m]
  double stop_stiffness = 0.0;           // [N/m]
  double stop_damping = 0.0;             // [N s/m]
};

// Hand and held body, moving as one. With r the intended position, e = x - r the deviation from it
// and m the mass of both,
//
//   m e'' + b e' + k e = f_device + f_stop + (friction, less the friction the hand expects),
//
// with b of hand and body, so that without outside force the body follows the intent exactly:
// people learn the mass and the friction of what they move (Shadmehr and Mussa-Ivaldi 1994). Tremor
// and drift add to the body's motion at the fingertips, past the friction of the device's joints,
// and so does straying when the stylus, held like a pen (pointing half forward, half down), turns
// about the grip. Rotation deviates from the intent by inertia, spring and damper of hand and body
// under the device's torque.
//
// Pure: fixed state, no allocation, no clock; the same seed and calls give the same bits.
class HandModel final : public SteerableHand {
 public:
  explicit HandModel(const HandOptions& options, const HeldBody& held = {}) noexcept;

  void steer(const HandIntent& intent) noexcept override { motion_.steer(intent); }
  bool moving() const noexcept override { return motion_.moving(); }
  // The intent is given from outside, until the next order; see HandMotion::lead.
  void lead(const VectorMotion& intent) noexcept { motion_.lead(intent); }

  // The intent after dt of a hand that is limp: it gives way to where the hand is taken, so that it
  // only drags. To lead it by.
  VectorMotion given_way(double dt) const noexcept;

  // At rest at `p`, meaning to be there; finite [m].
  void place(const Vec3& p) noexcept;
  void set_home(const Vec3& p) noexcept { motion_.set_home(p); }
  // Holds another body from now on, where the hand is.
  void hold(const HeldBody& held) noexcept;

  // Advances by dt, 0 < dt <= 10 ms, under a constant finite wrench of the device on the hand,
  // frame M. Inner steps of at most 0.25 ms, implicit in the hand's spring and damper, and friction
  // by projection: a body at rest stays exactly at rest until pushed harder than friction.
  void step(double dt, const Wrench& f_H_M) noexcept;

  Pose pose() const noexcept;  // X_MH of the tip
  // Of the tip, true, but for the part of straying [m/s].
  Vec3 velocity() const noexcept { return wander_is_meant_ ? v_ : Vec3(v_ + wander_.velocity()); }
  // Force of the hand on what it holds, mean of the last step, frame M [N].
  const Vec3& push() const noexcept { return push_; }
  // Of what it holds from where it means that to be, wander that is meant and all [m].
  const Vec3& deviation() const noexcept { return deviation_; }
  std::uint32_t buttons() const noexcept { return motion_.buttons(); }
  const HandMotion& motion() const noexcept { return motion_; }

 private:
  VectorMotion meant() const noexcept;
  void translate(double h, const Vec3& force) noexcept;
  void rotate(double h, const Vec3& torque) noexcept;
  Vec3 stop_force() const noexcept;
  Vec3 strayed() const noexcept;

  HeldBody held_;
  double mass_;                    // hand and body [kg]
  double hand_mass_;               // [kg]
  double stiffness_;               // [N/m]
  double hand_damping_, damping_;  // of the hand; of hand and body [N s/m]
  bool wander_is_meant_;
  double turn_lever_;                            // [m]
  double hand_inertia_, inertia_;                // of the hand; of hand and body [kg m^2]
  double rotation_stiffness_;                    // [N m/rad]
  double hand_turn_damping_, rotation_damping_;  // of the hand; of both [N m s/rad]
  HandMotion motion_;
  HandWander wander_;
  Vec3 x_ = Vec3::Zero();               // the body [m]
  Vec3 v_ = Vec3::Zero();               // [m/s]
  Vec3 deviation_ = Vec3::Zero();       // of the body from the intent [m]
  Vec3 deviation_rate_ = Vec3::Zero();  // [m/s]
  Vec3 meant_rate_ = Vec3::Zero();      // a step before [m/s]
  Vec3 effort_ = Vec3::Zero();          // impulse of the hand, but for inertia, of this step [N s]
  Vec3 push_ = Vec3::Zero();            // [N]
  Vec3 turn_ = Vec3::Zero();            // rotation away from the intent, frame M [rad]
  Vec3 turn_rate_ = Vec3::Zero();       // [rad/s]
};

}  // namespace handrail
