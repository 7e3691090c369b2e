#include "server/lab/scenes/view.h"

#include <algorithm>
#include <cmath>

#include "server/constraint/drawn/wall_shape.h"

namespace handrail {
namespace {

constexpr int kLooks = 32;  // at each piece of a border

}  // namespace

View view_of(const Walls& walls, double margin) {
  View out;
  if (walls.map) {
    out.high = 0.5 * walls.map->pixel * Vec2(walls.map->width, walls.map->height);
    out.low = -out.high;
    return out;
  }
  out.low = out.high = walls.start;
  const auto hold = [&out](const Vec2& p) {
    out.low = out.low.cwiseMin(p);
    out.high = out.high.cwiseMax(p);
  };
  for (const WallShape& shape : walls.shapes) {
    for (const OutlinePiece& piece : border_of(shape)) {
      for (int i = 0; i <= kLooks; ++i) hold(piece.at(piece.size() * i / kLooks));
    }
  }
  out.low.array() -= margin;
  out.high.array() += margin;
  return out;
}

Vec2 wander(const Walls& walls, const View& view, double t) {
  constexpr double kSpeed = 0.1;   // [m/s]
  constexpr double kSetOut = 1.0;  // [s]
  const Vec2 reach = 0.95 * view.half();
  const double turn = kSpeed * t / std::max(reach.maxCoeff(), 1e-3);
  // Two rates without a common measure, so that the way never closes.
  const Vec2 roam = view.centre() + Vec2(reach.x() * std::sin(turn + 0.4),
                                         reach.y() * std::sin(1.618 * turn + 1.1));
  const double s = std::clamp(t / kSetOut, 0.0, 1.0);
  const double share = s * s * (3.0 - 2.0 * s);
  return (1.0 - share) * walls.start + share * roam;
}

}  // namespace handrail
