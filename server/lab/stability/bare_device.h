// A haptic device alone, or in a hand that does nothing by itself, exact between the ticks.
//
// Simulated hands of devices/hand/ expect a device's friction and brake by themselves; they would
// hide what a loop does. What is here takes energy only as it says.
#pragma once

#include <array>

#include "server/base/plane.h"

namespace handrail {

// What moves of a device, without the hand. All >= 0, mass > 0.
struct DeviceBody {
  double mass = 0.0;      // [kg]
  double damping = 0.0;   // viscous [N s/m]
  double friction = 0.0;  // Coulomb, with sticking, in any direction [N]
};

// A hand that moves with the device: unless it is led it can only take energy. All >= 0.
struct PassiveGrip {
  double mass = 0.0;         // [kg]
  double damping = 0.0;      // [N s/m]
  double stiffness = 0.0;    // back to where it took hold, or is led to [N/m]
  Vec2 push = Vec2::Zero();  // that it leans on the device with, as a weight does [N]
};

// Of device and hand between two ticks:
//
//   m x'' = f + push - b x' - k (x - x_0) - (friction, against x' or what would move it),
//
// by the exponential of its linear part, so that without friction the step does not matter. Along a
// line friction is exact too: the moment at which the motion ends is looked for. In the plane its
// direction is that of the middle of a step, of second order; where it turns, the step is halved.
class BareDevice {
 public:
  // Longest inner step. A step 100 times as fine moves a device in the plane, in a second of
  // swinging against a spring, by less than kFinerMoves.
  static constexpr double kStep = 0.25e-3;     // [s]
  static constexpr double kFinerMoves = 1e-6;  // [m]

  // At rest at `at`, where the hand took hold. `step` > 0 [s].
  BareDevice(const DeviceBody& body, const PassiveGrip& grip, const Vec2& at,
             double step = kStep) noexcept;

  // Changes the velocity at once [m/s]. It counts as nobody's work.
  void kick(const Vec2& by) noexcept { v_ += by; }
  // The hand means to be there from now on: its spring pulls to it. Its own work, as a kick's.
  void lead(const Vec2& to) noexcept { hold_ = to; }
  // `dt` > 0 under a force that is held [N].
  void advance(double dt, const Vec2& force) noexcept;

  const Vec2& position() const noexcept { return x_; }  // [m]
  const Vec2& velocity() const noexcept { return v_; }  // [m/s]
  double mass() const noexcept { return mass_; }        // of both [kg]
  // Work of the held forces so far, on device and hand [J].
  double given() const noexcept { return given_; }
  // What the device's own friction and damping took so far; the hand's damping is not in it [J].
  double lost() const noexcept { return lost_; }
  // Of motion, of the hand's spring and of its weight, from where it holds [J].
  double energy() const noexcept;

 private:
  // y and v after a time under a force that does not change: y = xx y + xv v + xf f, v alike.
  struct Flow {
    double xx, xv, xf, vx, vv, vf;
  };
  struct Motion {
    Vec2 y, v;
  };

  Flow flow(double h) const noexcept;
  static Motion moved(const Flow& by, const Motion& from, const Vec2& force) noexcept;
  // Halves the step `level` times, and more where the motion turns.
  void step(int level, const Vec2& force) noexcept;
  // From rest, for `h` [s].
  void leave(double h, const Vec2& force) noexcept;
  // The time until the speed along `way` is used up, between 0 and h [s].
  double stop(const Motion& from, const Vec2& force, const Vec2& way, double h) const noexcept;
  void take(const Motion& to, const Vec2& force, const Vec2& friction) noexcept;

  DeviceBody body_;
  PassiveGrip grip_;
  double mass_, damping_;  // of both
  Vec2 hold_;              // x_0 [m]
  double longest_;         // [s]
  Vec2 x_, v_ = Vec2::Zero();
  double given_ = 0.0, lost_ = 0.0;
  static constexpr int kLevels = 8;  // a step is halved at most so often
  double h_ = 0.0;  // that the first of these is of; the others of halves of it [s]
  std::array<Flow, kLevels + 2> flows_{};
};

// How a driver sees it: counts of an encoder, and their difference from read to read, smoothed.
class Encoder {
 public:
  // `resolution` [m], 0: as it is; `cutoff` of the velocity's low-pass [Hz], 0: none.
  Encoder(double resolution, double cutoff) noexcept : resolution_(resolution), cutoff_(cutoff) {}

  // `dt` > 0 since the last call [s].
  void read(const Vec2& truth, double dt) noexcept;
  const Vec2& position() const noexcept { return x_; }  // [m]
  const Vec2& velocity() const noexcept { return v_; }  // [m/s]

 private:
  double resolution_, cutoff_;
  bool known_ = false;
  Vec2 x_ = Vec2::Zero(), v_ = Vec2::Zero();
};

}  // namespace handrail
