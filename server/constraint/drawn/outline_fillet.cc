#include <algorithm>
#include <cmath>
#include <optional>

#include "server/constraint/drawn/outline_union.h"

namespace handrail {
namespace {

constexpr double kSmooth = 1e-6;  // sine below which two pieces join without a corner

// Where a fillet leaves piece `in`, its centre, and where it joins piece `out`.
struct Fillet {
  Vec2 from, centre, to;
  double radius = 0.0;
};

// The piece's carrier moved into the wall by r: where the centres of circles of radius r that touch
// it from within the wall are. None if the wall is inside a smaller circle.
std::optional<OutlinePiece> moved_into_wall(const OutlinePiece& piece, double r) {
  OutlinePiece moved = piece;
  if (piece.turn == 0) {
    moved.a -= r * left_of(piece.along);
    return moved;
  }
  moved.radius += piece.turn * r;
  if (moved.radius <= kShortestPiece) return std::nullopt;
  return moved;
}

// The rounding of one corner, with what limits it.
class Corner {
 public:
  Corner(const std::vector<OutlinePiece>& pieces, std::size_t in, std::size_t out, double room_in,
         double room_out)
      : pieces_(pieces), in_(in), out_(out), room_in_(room_in), room_out_(room_out) {}

  // The fillet of the largest radius up to `wanted` that fits.
  std::optional<Fillet> largest(double wanted) const {
    if (auto whole = of(wanted)) return whole;
    std::optional<Fillet> best;
    double low = 0.0, high = wanted;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      const auto fillet = of(middle);
      if (fillet) best = fillet;
      (fillet ? low : high) = middle;
    }
    return low > kShortestPiece ? best : std::nullopt;
  }

 private:
  std::optional<Fillet> of(double r) const {
    const OutlinePiece &in = pieces_[in_], &out = pieces_[out_];
    const auto u = moved_into_wall(in, r), v = moved_into_wall(out, r);
    if (!u || !v) return std::nullopt;
    const CarrierPoints centres = meet(*u, *v);
    std::optional<Fillet> best;
    for (int i = 0; i < centres.count; ++i) {
      const Vec2& c = centres.p[static_cast<std::size_t>(i)];
      const Fillet fillet{in.nearest_on_carrier(c), c, out.nearest_on_carrier(c), r};
      if (!fits(fillet)) continue;
      if (best && (best->centre - in.b).norm() <= (c - in.b).norm()) continue;
      best = fillet;
    }
    return best;
  }

  bool fits(const Fillet& fillet) const {
    const OutlinePiece &in = pieces_[in_], &out = pieces_[out_];
    const double used_in = in.size() - in.travel(fillet.from);
    const double used_out = out.travel(fillet.to);
    if (!(used_in > 0.0 && used_in < room_in_ && used_out > 0.0 && used_out < room_out_)) {
      return false;
    }
    // The wall's corner is cut off, never the other side of the circle.
    const Vec2 u = fillet.from - fillet.centre, v = fillet.to - fillet.centre;
    if (cross(u, v) >= 0.0) return false;
    const OutlinePiece arc =
        OutlinePiece::arc(fillet.centre, fillet.radius, fillet.from, fillet.to, -1);
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (i != in_ && i != out_ && crosses(arc, pieces_[i])) return false;
    }
    return true;
  }

  static bool crosses(const OutlinePiece& arc, const OutlinePiece& piece) {
    const CarrierPoints shared = meet(arc, piece);
    for (int i = 0; i < shared.count; ++i) {
      const Vec2& p = shared.p[static_cast<std::size_t>(i)];
      if (arc.spans(p, kBorderTolerance) && piece.spans(p, kBorderTolerance)) return true;
    }
    return false;
  }

  const std::vector<OutlinePiece>& pieces_;
  std::size_t in_, out_;
  double room_in_, room_out_;  // travel a fillet may use of each [m]
};

// An arc of up to half a circle as one or two pieces.
void append(std::vector<OutlinePiece>& pieces, const Fillet& fillet) {
  const OutlinePiece arc =
      OutlinePiece::arc(fillet.centre, fillet.radius, fillet.from, fillet.to, -1);
  const Vec2 middle = arc.at(0.5 * arc.size());
  pieces.push_back(arc.part(fillet.from, middle));
  pieces.push_back(arc.part(middle, fillet.to));
}

}  // namespace

std::vector<OutlinePiece> with_fillets(const std::vector<OutlinePiece>& pieces, double radius) {
  if (!(radius > 0.0)) return pieces;
  const std::vector<int> next = chain(pieces);
  const std::size_t count = pieces.size();
  const auto starts_at = [&](const Vec2& p) {
    return std::count_if(pieces.begin(), pieces.end(),
                         [&](const OutlinePiece& piece) { return piece.a == p; });
  };
  // Free space turns right at a wall corner that protrudes.
  std::vector<bool> sharp_end(count), sharp_start(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(next[i]);
    const double sine = cross(pieces[i].tangent(pieces[i].b), pieces[k].tangent(pieces[k].a));
    sharp_end[i] = sine < -kSmooth && starts_at(pieces[i].b) == 1;
    sharp_start[k] = sharp_end[i];
  }
  std::vector<std::optional<Fillet>> fillets(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (!sharp_end[i]) continue;
    const auto k = static_cast<std::size_t>(next[i]);
    // Two corners share a piece half and half.
    const double room_in = pieces[i].size() * (sharp_start[i] ? 0.5 : 1.0) - kShortestPiece;
    const double room_out = pieces[k].size() * (sharp_end[k] ? 0.5 : 1.0) - kShortestPiece;
    fillets[i] = Corner(pieces, i, k, room_in, room_out).largest(radius);
  }
  std::vector<OutlinePiece> result = pieces;
  for (std::size_t i = 0; i < count; ++i) {
    if (!fillets[i]) continue;
    const auto k = static_cast<std::size_t>(next[i]);
    result[i] = result[i].part(result[i].a, fillets[i]->from);
    result[k] = result[k].part(fillets[i]->to, result[k].b);
    append(result, *fillets[i]);
  }
  return result;
}

}  // namespace handrail
