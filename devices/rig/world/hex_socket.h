// A hexagon socket and the ball end of a key in it.
#pragma once

#include <array>
#include <limits>

#include "devices/rig/world/contact.h"
#include "devices/rig/world/tip_step.h"
#include "server/model/simulate.h"

namespace handrail {

// The tip is the ball's centre. Around the mouth lies an endless plane; a
// chamfer and a guide, six slopes each, lead into six walls with a bottom. Past
// the chamfer comes only a key whose corners fit the hexagon within its
// backlash and that is tilted less than kLost; one tilted more than the jam
// angle is clamped between two walls, whose friction holds it along the axis.
// Real-time safe.
class HexSocket {
 public:
  // `bending`: of the key, against tilt when it is in to the bottom [N m/rad].
  HexSocket(const HexSocketSpec& spec, double bending) noexcept;

  // Adds what the tip may touch in this step; the hexagon is turned by `turn`
  // about the socket's Z.
  void find(const TipStep& tip, double turn, ContactList& out) noexcept;
  // The step has ended with the tip at X_ST: follows the key's turn and finds
  // where it is.
  void settle(const Pose& X_ST) noexcept;
  // The key has slipped out of the flats: its corners stand on the chamfer's end until they fit
  // again.
  void lose() noexcept { zone_ = Zone::kMouth; }

  // How far the ball's centre is below the rim; minus infinity beside the mouth
  // [m].
  double depth() const noexcept { return depth_; }
  // How far below the chamfer, 0 outside: where flats meet flats [m].
  double engaged() const noexcept { return zone_ == Zone::kInside ? engaged_ : 0.0; }
  // The key's angle in the hexagon, about the socket's Z, 0 in the middle of
  // its backlash. Counted on while the key is inside [rad].
  double key_turn() const noexcept { return spin_ - turns_; }
  double tilt() const noexcept { return tilt_; }
  // The key is in, and tilted so much that two walls clamp it.
  bool jammed() const noexcept { return engaged() > 0.0 && tilt_ > spec_.jam; }
  // How far `p_S` is above the rim, and so clear of plate and socket; below 0 it is not [m].
  double outside(const Vec3& p_S) const noexcept { return in_socket(p_S).z(); }
  // How far the key's flats are from fitting a hexagon turned by `turn`, about the socket's Z, at
  // most 30 degrees either way [rad].
  double off_flats(double turn) const noexcept;
  // Unit, frame S, out of the socket.
  Vec3 axis() const noexcept { return X_SK_.q * Vec3::UnitZ(); }
  const HexSocketSpec& spec() const noexcept { return spec_; }

  static constexpr double kLost = 30.0 * kDeg;  // a key tilted more slips out

 private:
  enum class Zone : std::uint8_t { kBeside, kMouth, kInside };

  void slopes(double steepness, double reach, double at_z, ContactList& out) noexcept;
  void clear_all() noexcept;
  bool fits(double turn) const noexcept;
  double across(const Vec3& p_K) const noexcept;
  Vec3 in_socket(const Vec3& p_S) const noexcept { return X_KS_.q * p_S + X_KS_.p; }

  HexSocketSpec spec_;
  Pose X_SK_, X_KS_;
  double bending_;
  double clearance_;           // of the walls, each side [m]
  double mouth_;               // of the chamfer's upper edge from the axis [m]
  std::array<Vec3, 6> flats_;  // normals of the hexagon's sides, frame K
  std::array<Contact, 6> sides_;
  Contact rim_, bottom_, clamp_;
  Zone zone_ = Zone::kBeside;
  double depth_ = -std::numeric_limits<double>::infinity();
  double engaged_ = 0.0;
  double tilt_ = 0.0;
  double spin_ = 0.0;   // of the key about K's Z, counted on [rad]
  double turns_ = 0.0;  // whole sixths of a turn with which the key went in [rad]
};

}  // namespace handrail
