#include "server/constraint/drawn/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/constraint/drawn/outline_union.h"

namespace handrail {
namespace {

// A hit this far past a piece's end still counts, so that no way slips between two pieces [m].
constexpr double kSlack = 1e-9;
// A way that starts in free space may start this far behind a border, by rounding [m].
constexpr double kBehind = 1e-10;
constexpr double kNever = 2.0;

double enters_line(const OutlinePiece& line, const Vec2& p, const Vec2& d, double behind) noexcept {
  const double from = line.carrier_distance(p), to = line.carrier_distance(p + d);
  if (!(to < 0.0 && to < from && from >= -behind)) return kNever;
  return from > 0.0 ? from / (from - to) : 0.0;
}

// Wall inside the circle.
double enters_disc(const OutlinePiece& arc, const Vec2& p, const Vec2& d, double behind) noexcept {
  const Vec2 v = p - arc.centre;
  const double a = d.squaredNorm(), b = d.dot(v);
  const double c = v.squaredNorm() - arc.radius * arc.radius;
  if (b >= 0.0 || c < -2.0 * arc.radius * behind) return kNever;
  if (c <= 0.0) return 0.0;
  const double root = b * b - a * c;
  return root < 0.0 ? kNever : c / (std::sqrt(root) - b);
}

// Free space inside the circle, wall around it.
double leaves_disc(const OutlinePiece& arc, const Vec2& p, const Vec2& d, double behind) noexcept {
  const Vec2 v = p - arc.centre;
  const double a = d.squaredNorm(), b = d.dot(v);
  const double c = v.squaredNorm() - arc.radius * arc.radius;
  if (c > 0.0 && b >= 0.0) return c <= 2.0 * arc.radius * behind ? 0.0 : kNever;
  const double root = b * b - a * c;
  if (root < 0.0) return kNever;
  return b <= 0.0 ? (std::sqrt(root) - b) / a : -c / (b + std::sqrt(root));
}

// Where on p + t d, t from 0 to 1, the way enters the wall behind the piece's carrier.
double enters(const OutlinePiece& piece, const Vec2& p, const Vec2& d, double behind) noexcept {
  if (piece.turn == 0) return enters_line(piece, p, d, behind);
  return piece.turn < 0 ? enters_disc(piece, p, d, behind) : leaves_disc(piece, p, d, behind);
}

// The same for a way that starts on the carrier and leads away from its wall: only a circle around
// it can be met again.
double enters_again(const OutlinePiece& piece, const Vec2& p, const Vec2& d) noexcept {
  if (piece.turn <= 0) return kNever;
  const double b = d.dot(p - piece.centre);
  return b < 0.0 ? -2.0 * b / d.squaredNorm() : kNever;
}

}  // namespace

Outline::Outline(const std::vector<WallShape>& shapes, double fillet)
    : pieces_(with_fillets(merged(border_of_union(shapes)), fillet)) {
  join();
  for (const OutlinePiece& piece : pieces_) {
    // A chord's box and the arc's greatest height over the chord hold all of the arc.
    const Vec2 middle = piece.at(0.5 * piece.size());
    const double height = (middle - 0.5 * (piece.a + piece.b)).norm() + kBorderTolerance;
    const Vec2 low = piece.a.cwiseMin(piece.b), high = piece.a.cwiseMax(piece.b);
    boxes_.push_back({low.x() - height, low.y() - height, high.x() + height, high.y() + height});
  }
}

void Outline::join() {
  next_ = chain(pieces_);
  const std::size_t count = pieces_.size();
  before_.assign(count, 0);
  twin_.resize(count);
  point_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    before_[index(next_[i])] = static_cast<int>(i);
    twin_[i] = point_[i] = static_cast<int>(i);
    for (std::size_t k = 0; k < i; ++k) {
      if (pieces_[k].b != pieces_[i].b) continue;
      point_[i] = point_[k];
      std::swap(twin_[i], twin_[k]);
      break;
    }
  }
}

bool Outline::meets_corner(int piece, int corner) const noexcept {
  const int point = point_[index(corner)];
  return point_[index(piece)] == point || point_[index(before(piece))] == point;
}

Outline::Place Outline::nearest(const Vec2& x) const noexcept {
  Place best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < size(); ++i) {
    const Box& box = boxes_[index(i)];
    const double dx = std::max({box.x0 - x.x(), x.x() - box.x1, 0.0});
    const double dy = std::max({box.y0 - x.y(), x.y() - box.y1, 0.0});
    if (dx * dx + dy * dy >= least) continue;
    const Vec2 p = piece(i).nearest(x);
    const double squared = (p - x).squaredNorm();
    if (squared >= least) continue;
    least = squared;
    best = {p, i, p == piece(i).b ? i : p == piece(i).a ? before(i) : -1};
  }
  return best;
}

bool Outline::opens(int corner, const Vec2& d) const noexcept {
  int k = corner;
  do {
    const OutlinePiece &in = piece(k), &out = piece(next(k));
    const Vec2 u = in.tangent(in.b), v = out.tangent(out.a);
    const bool past_in = cross(u, d) > 0.0, past_out = cross(v, d) > 0.0;
    const double sine = cross(u, v);
    // A wall corner, or a wall tip without width, is open to either side.
    const bool protrudes = sine < 0.0 || (sine < 1e-9 && u.dot(v) < 0.0);
    if (protrudes ? past_in || past_out : past_in && past_out) return true;
    k = twin(k);
  } while (k != corner);
  return false;
}

bool Outline::is_free(const Vec2& x, const Place& nearest) const noexcept {
  if (nearest.piece < 0 || x == nearest.p) return true;
  if (nearest.corner >= 0) return opens(nearest.corner, x - nearest.p);
  return (x - nearest.p).dot(piece(nearest.piece).normal(nearest.p)) >= 0.0;
}

Outline::Place Outline::cast(const Vec2& p, const Vec2& d, int on, int at) const noexcept {
  const Vec2 end = p + d;
  const Vec2 low = p.cwiseMin(end), high = p.cwiseMax(end);
  const double behind = on < 0 && at < 0 ? kBehind : 0.0;
  Place place;
  double first = kNever;
  for (int i = 0; i < size(); ++i) {
    const Box& box = boxes_[index(i)];
    if (box.x0 > high.x() || box.x1 < low.x() || box.y0 > high.y() || box.y1 < low.y()) continue;
    const OutlinePiece& other = piece(i);
    const bool here = i == on || (at >= 0 && meets_corner(i, at));
    const double t = here ? enters_again(other, p, d) : enters(other, p, d, behind);
    if (t > 1.0 || t >= first || !other.spans(p + t * d, kSlack)) continue;
    first = t;
    place.piece = i;
  }
  if (place.piece < 0) return place;
  const OutlinePiece& hit = piece(place.piece);
  place.p = hit.nearest(p + first * d);
  if ((place.p - hit.b).norm() < kAtCorner) {
    place.p = hit.b;
    place.corner = place.piece;
  } else if ((place.p - hit.a).norm() < kAtCorner) {
    place.p = hit.a;
    place.corner = before(place.piece);
  }
  return place;
}

std::size_t Outline::memory() const noexcept {
  return pieces_.capacity() * sizeof(OutlinePiece) + boxes_.capacity() * sizeof(Box) +
         (next_.capacity() + before_.capacity() + twin_.capacity() + point_.capacity()) *
             sizeof(int);
}

}  // namespace handrail
