// The set a tool keeps the tip in.
#pragma once

#include <algorithm>

#include "server/base/spatial.h"
#include "server/model/tool.h"

namespace handrail {

// A point, line or plane, frame S, and what is no further than `room` from it; or everything.
// Default: everything.
struct TipSpace {
  Vec3 p_SA = Vec3::Zero();        // a point of it [m]
  Mat3 axes_S = Mat3::Identity();  // orthonormal columns, of which the first
                                   // `free` lie in it
  int free = 3;                    // 0 point, 1 line, 2 plane, 3 everything
  double room = 0.0;               // beside the point, line or plane [m]
  Vec3 forward_S = Vec3::Zero();   // unit: the tip never goes back along it; zero: it may

  Vec3 side_S = Vec3::Zero();  // unit: the tip stays on this side of it; zero: on any
  bool touched = false;        // something is felt: no stop ends past its goal

  bool everything() const noexcept { return free >= 3; }
  // In how many directions the tip may set out from inside: the first columns of axes_S.
  int freedom() const noexcept { return room > 0.0 ? 3 : free; }
  // Where `p` is from the point, line or plane. Real-time safe.
  Vec3 off(const Vec3& p) const noexcept {
    if (everything()) return Vec3::Zero();
    Vec3 d = p - p_SA;
    for (int i = 0; i < free; ++i) d -= axes_S.col(i).dot(d) * axes_S.col(i);
    return d;
  }
  double distance(const Vec3& p) const noexcept { return off(p).norm(); }
  // The part of a motion from inside that is free. Real-time safe.
  Vec3 along(const Vec3& v) const noexcept { return freedom() >= 3 ? v : Vec3(v - off(p_SA + v)); }
  // Its point nearest to `p`. Real-time safe.
  Vec3 nearest(const Vec3& p) const noexcept {
    const Vec3 d = off(p);
    const Vec3 beyond = std::min(0.0, d.dot(side_S)) * side_S;
    const double far = (d - beyond).norm();
    return far > room ? Vec3(p - beyond - (1.0 - room / far) * (d - beyond)) : Vec3(p - beyond);
  }
};

// Orthonormal axes whose first is `u`, a unit vector.
inline Mat3 axes_from(const Vec3& u) noexcept {
  Mat3 axes;
  axes.col(0) = u;
  axes.col(1) = u.unitOrthogonal();
  axes.col(2) = u.cross(axes.col(1));
  return axes;
}

inline TipSpace point_space(const Vec3& p) noexcept { return {p, Mat3::Identity(), 0}; }
inline TipSpace line_space(const Vec3& p, const Vec3& direction) noexcept {
  return {p, axes_from(direction), 1};
}
inline TipSpace plane_space(const Vec3& p, const Vec3& normal) noexcept {
  const Mat3 axes = axes_from(normal);
  TipSpace space{p, axes, 2};
  space.axes_S << axes.col(1), axes.col(2), axes.col(0);
  return space;
}

// The set `tool` keeps the tip in, without its end; everything for no position tool.
inline TipSpace space_of(const ToolDefinition& tool) noexcept {
  TipSpace space;
  if (tool.kind == ToolKind::kPoint) space = point_space(tool.p_SA);
  if (tool.kind == ToolKind::kLine) space = line_space(tool.p_SA, tool.direction_S);
  if (tool.kind == ToolKind::kPlane) space = plane_space(tool.p_SA, tool.normal_S);
  if (tool.one_way) space.forward_S = tool.direction_S;
  return space;
}

}  // namespace handrail
