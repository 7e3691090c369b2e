// What the tip touches, as a plane: what crosses the link of a contact.
#pragma once

#include <cstdint>

#include "server/base/spatial.h"

namespace handrail {

// Softer than this no contact is told of: the bumper's 10 N would take a decimetre to be felt, and
// a hand feels nothing of it. Stiffer than steel on steel none is [N/m].
inline constexpr double kSoftestSurface = 100.0;
inline constexpr double kStiffestSurface = 1e7;
// Every place is nearer (spatial.h), and a micrometre that is rounded away does not matter [m].
inline constexpr double kFarthestSurface = 0.999 * kFarthest;

// The surface n . x = d in S. What is soft gives way behind it. On the wire the normal is rounded:
// one that from_octahedral() gave is told as it is, so that the plane does not tilt about the base.
struct Surface {
  Vec3 n_S = Vec3::UnitZ();  // unit, out of it, toward the tip
  double d = 0.0;            // at most kFarthestSurface either way [m]
  double stiffness = 1e3;    // of surface, sensor and arm in series; of a rigid one at least [N/m]

  // How far `p_S` is out of it; negative: within [m].
  double out_of(const Vec3& p_S) const noexcept { return n_S.dot(p_S) - d; }
  friend bool operator==(const Surface&, const Surface&) = default;
};

// A unit vector as two octahedral coordinates of 16 bits, x in the lower half: the point where its
// direction meets |x| + |y| + |z| = 1, with the lower half folded out over the upper's edges, in
// 32767ths. The nearest one that can be said is within kNormalError of `n`. Real-time safe.
std::uint32_t octahedral(const Vec3& n) noexcept;
// Unit to rounding, whatever the code: -32768, which octahedral() never gives, counts as -32767.
Vec3 from_octahedral(std::uint32_t code) noexcept;
inline constexpr double kNormalError = 6.5e-5;  // measured over the sphere: 6.4e-5 at most [rad]

}  // namespace handrail
