// The slave's own hold on the active tools: whatever the master commands, the tip stays on them.
#pragma once

#include <cstdint>

#include "server/constraint/orientation_tool.h"
#include "server/model/link_state.h"
#include "server/model/tip_space.h"

namespace handrail {

// Keeps commands on the tools the master has defined. Where a tool is called away from the tip, the
// tip rides to it: commands may then be off the tool by a distance and an angle that start as the
// tip's own and only shrink. They shrink as a command that is eased by the master's law (blend.h)
// comes nearer from where the first one was: a tip that did not stand where it was commanded, out
// of reach for instance, is not taken ahead of the command. Real-time safe.
class ToolTube {
 public:
  // Takes over what `master` defines, whatever was before; `X_ST`: the tip as commanded.
  void restart(const MasterState& master, const Pose& X_ST) noexcept;

  // Takes over a changed tool. kHashTools, and nothing changes, when a definition is older than the
  // one held, or another one of the same epoch: that command must not be applied.
  Reason take(const MasterState& master, const Pose& X_ST) noexcept;

  // Shrinks what commands may be off, and beyond an end, for `dt` [s] by at most `catch_up` [m/s]
  // and `catch_up_rotation` [rad/s], and to where both the command at `p_SU` and the tip at `p_ST`
  // have come nearer. The tip alone would not do: one that cannot reach its command slides along
  // the end of its reach, and would go after a bound that goes with it. To be called while the hand
  // drives.
  void close(double catch_up, double catch_up_rotation, const Vec3& p_SU, const Vec3& p_ST,
             double dt) noexcept;

  // `X_SU` on the tools and before an end as far as it must be; on a one-way tool never behind the
  // tip. A command within a nanometre passes bit for bit.
  Pose project(const Pose& X_SU, const Pose& X_ST) noexcept;

  // `p` no further off the position tool than `contact` [m] beside what commands may be off.
  Vec3 bounded(const Vec3& p, double contact) const noexcept;

  // Where the tip may be, `room` [m] beside the position tool.
  TipSpace space(double room) const noexcept;

  // Distance and angle a command may be off the tools [m], [rad].
  double radius() const noexcept { return radius_; }
  double angle() const noexcept { return angle_; }
  // Distance of `p` from the position tool, as a set without direction and end [m].
  double distance(const Vec3& p) const noexcept { return across(p).norm(); }

  std::uint32_t position_epoch() const noexcept { return position_.epoch; }
  std::uint32_t orientation_epoch() const noexcept { return orientation_.definition().epoch; }
  // Of both definitions, as the master hashes its own; 0 before the first tool.
  std::uint64_t hash() const noexcept { return hash_; }

 private:
  Vec3 across(const Vec3& p) const noexcept;
  // How far `p` is beyond the position tool's end, 0 before it [m].
  double past_end(const Vec3& p) const noexcept;
  // Way from `p` to the nearest place on the position tool and before its end [m].
  double way_to(const Vec3& p) const noexcept;
  void take_position(const ToolDefinition& tool, const Pose& X_ST, const Pose& X_SU) noexcept;
  void take_orientation(const ToolDefinition& tool, const Pose& X_ST, const Pose& X_SU) noexcept;

  ToolDefinition position_;
  OrientationTool orientation_;
  std::uint64_t hash_ = 0;
  double radius_ = 0.0;
  double past_end_ = 0.0;  // how far beyond the tool's end a command may be [m]
  double pace_ = 0.0;  // what a command may be off that is eased from where the first one was [m]
  double angle_ = 0.0;
  double turn_pace_ = 0.0;  // [rad]
};

}  // namespace handrail
