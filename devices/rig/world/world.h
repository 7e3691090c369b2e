// What the simulated tip touches, and how arm and tool give way to it and to
// their load.
#pragma once

#include <array>
#include <optional>
#include <variant>

#include "devices/rig/world/backlash.h"
#include "devices/rig/world/box.h"
#include "devices/rig/world/compliance.h"
#include "devices/rig/world/contact.h"
#include "devices/rig/world/cylinder.h"
#include "devices/rig/world/gravity_sag.h"
#include "devices/rig/world/hex_socket.h"
#include "devices/rig/world/plane.h"
#include "devices/rig/world/screw.h"
#include "server/base/joints.h"
#include "server/kinematics/rv2a.h"
#include "server/model/simulate.h"

namespace handrail {

// What a tip is inside of, and how deep [m].
struct TipInside {
  RigEffectKind what = RigEffectKind::kCount;
  double deep = 0.0;
};

// Holds what the list names and nothing else. Copying is a plain copy; all
// calls are real-time safe.
class World {
 public:
  // The arm stands at `q_start`, touching nothing. `list` has passed the
  // scene's checks.
  World(const Simulate& list, const ArmGeometry& geometry, const JointVector& q_start) noexcept;

  // True when the list has something for a World to do.
  static bool is_needed(const Simulate& list) noexcept;

  // `h` > 0 seconds pass in which the servos take the joints to `q_servo`.
  void step(const JointVector& q_servo, double h) noexcept;
  // The same with the tip led to X_S0 by something else than joints.
  void lead(const Pose& X_S0, double h) noexcept;

  // X_ST of the true tip: with all that bends.
  const Pose& tip() const noexcept { return tip_; }
  // Where it would be with nothing to touch, frame S [m].
  const Vec3& untouched() const noexcept { return p0_; }
  // What the contacts exert on the tip, at the tip, frame S.
  const Wrench& on_tip() const noexcept { return on_tip_; }
  // The same with the payload's weight, at the tip, in the axes of the flange, as the sensor is
  // turned: what an ideal one reads.
  Wrench on_sensor() const noexcept;
  // Of the screw, tightened since the start [rad]; 0 without one.
  double screw_angle() const noexcept { return socket_ ? screw_.angle() : 0.0; }
  // How far the tip is below the socket's rim, above it below 0; minus infinity
  // beside the mouth and without a socket [m].
  double depth() const noexcept;
  // The key has left the hexagon's flats under load, and has neither found them
  // again nor been lifted since.
  bool slipped() const noexcept { return slipped_; }
  // The key is clamped in the socket, as it is tilted too much.
  bool jammed() const noexcept { return socket_ && socket_->jammed(); }
  bool has_socket() const noexcept { return socket_.has_value(); }
  // What of the list the tip is inside of as it stands, deepest first; nothing: it is clear. To be
  // asked before the first step.
  std::optional<TipInside> inside() const noexcept;
  // How far clockwise, as one looks at the screw's head, the key has to be turned for its flats to
  // fit; counterclockwise below 0, at most 30 degrees [rad]. 0 without a socket.
  double off_flats() const noexcept { return socket_ ? socket_->off_flats(-screw_.angle()) : 0.0; }
  // Rounds the equilibrium took last.
  int rounds() const noexcept { return rounds_; }

 private:
  void turn_screw() noexcept;

  using Surface = std::variant<std::monostate, Plane, Box, Cylinder>;

  ArmGeometry geometry_;
  Compliance compliance_;
  Backlash backlash_;
  GravitySag sag_;
  std::array<Surface, kMostTouched> surfaces_;
  std::size_t surface_count_ = 0;
  std::optional<HexSocket> socket_;
  Screw screw_;
  bool slipped_ = false;
  Vec3 p0_ = Vec3::Zero();  // where the tip would be with nothing to touch, frame S
  Pose tip_;
  Wrench on_tip_;
  int rounds_ = 0;
};

}  // namespace handrail
