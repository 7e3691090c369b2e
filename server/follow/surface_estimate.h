// What the tip touches, as a plane with a stiffness, for the master to render without the delay.
#pragma once

#include <optional>

#include "server/follow/bumper.h"
#include "server/model/surface.h"

namespace handrail {

// From the default bumper's contacts. While one is felt the normal is the bumper's, which friction
// does not tilt; the compliance is the way along it by which the force changes, by least squares
// over changes that go more along it than beside it, first of all the one since little was felt;
// the plane lies where the force would begin. A surface that gives way by no more than the encoders
// tell is told as stiff as the bumper reckons with at most: it is that stiff at least.
//
// It is kept in free space, for a hand that comes back within a long round trip, and forgotten
//   - further than kKept from where it was felt last: beyond, one touch says little of a plane;
//   - where the tip is so deep behind it that it should be felt, and is not, three readings long;
//   - where a new contact has another normal, or begins elsewhere: that one takes its place;
//   - with forget(): the sensor is lost, or the arm no longer led.
class SurfaceEstimate {
 public:
  // 50 mm: what a hand at 50 mm/s goes within a round trip of 1 s, the longest that is aimed at; a
  // normal that is off by the 0.1 rad of a rough touch is then 5 mm off at the end [m].
  static constexpr double kKept = 0.05;

  // A cycle, after bump(): with the same settings and input, and the state that came of it.
  // Real-time safe.
  void step(const BumperSettings& settings, const BumperInput& in,
            const BumperState& bumper) noexcept;
  void forget() noexcept { *this = SurfaceEstimate(); }

  // Its normal is one that the wire tells as it is.
  const std::optional<Surface>& surface() const noexcept { return surface_; }

 private:
  // Less than half of what makes a contact: what a payload leaves that is not quite known.
  struct Light {
    Vec3 p_ST, f_E_S;  // [m], [N]
  };
  double since_light(const Vec3& n, double place, double force) const noexcept;
  void begin(const BumperSettings& settings, const Vec3& n, double stiffness) noexcept;
  void compare(const BumperSettings& settings, const BumperInput& in, const Vec3& p_ST) noexcept;
  void feel(const BumperSettings& settings, const BumperInput& in, const Vec3& p_ST) noexcept;
  void miss(const BumperSettings& settings, const Vec3& p_ST, double force) noexcept;

  std::optional<Surface> surface_;
  bool begun_ = false;                                  // the sums are of this contact
  Vec3 p_felt_ = Vec3::Zero();                          // where it was felt last [m]
  std::optional<Light> light_;                          // newest
  int missed_ = 0;                                      // readings in a row
  Vec3 p_from_ = Vec3::Zero(), f_from_ = Vec3::Zero();  // what the newest is compared with [m], [N]
  double since_ = 0.0;                                  // that [s]
  double ff_ = 0.0, sf_ = 0.0;  // force changes squared, and times ways [N^2], [m N]
  double near_weight_ = 0.0;    // of the newest readings
  double near_place_ = 0.0, near_force_ = 0.0;  // their means [m], [N]
};

}  // namespace handrail
