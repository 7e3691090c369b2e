#include "server/constraint/drawn/outline_union.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/constraint/drawn/wall_shape.h"

namespace handrail {
namespace {

using Border = std::vector<OutlinePiece>;

bool same(const Vec2& a, const Vec2& b) { return (a - b).norm() <= kShortestPiece; }

// Points of `piece` where `other` meets it, ends of `other` on it included.
void collect(const OutlinePiece& piece, const OutlinePiece& other, std::vector<Vec2>& points) {
  const CarrierPoints shared = meet(piece, other);
  for (int i = 0; i < shared.count; ++i) {
    const Vec2& p = shared.p[static_cast<std::size_t>(i)];
    if (other.spans(p, kBorderTolerance)) points.push_back(p);
  }
  for (const Vec2& end : {other.a, other.b}) {
    if (std::abs(piece.carrier_distance(end)) <= kBorderTolerance) points.push_back(end);
  }
}

// `piece` cut at every one of `points` that lies within it.
Border split(const OutlinePiece& piece, const std::vector<Vec2>& points) {
  std::vector<std::pair<double, Vec2>> cuts;
  const double size = piece.size();
  for (const Vec2& p : points) {
    const double s = piece.travel(p);
    if (s > kShortestPiece && s < size - kShortestPiece) cuts.emplace_back(s, p);
  }
  std::sort(cuts.begin(), cuts.end(),
            [](const auto& u, const auto& v) { return u.first < v.first; });
  Border parts;
  Vec2 from = piece.a;
  for (const auto& cut : cuts) {
    if (same(from, cut.second)) continue;
    parts.push_back(piece.part(from, cut.second));
    from = cut.second;
  }
  parts.push_back(piece.part(from, piece.b));
  return parts;
}

// Whether a part of shape `own`'s border, seen at its middle, is border of the union.
bool is_outer(const Vec2& middle, const Vec2& normal, std::size_t own,
              const std::vector<WallShape>& shapes, const std::vector<Border>& borders) {
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (i == own) continue;
    bool on_border = false;
    for (const OutlinePiece& other : borders[i]) {
      const Vec2 p = other.nearest(middle);
      if ((p - middle).norm() > kShortestPiece) continue;
      on_border = true;
      // Free space on both sides: no wall left. On the same side: one of the two is enough.
      if (other.normal(p).dot(normal) < 0.0 || i < own) return false;
    }
    if (!on_border && outside_by(shapes[i], middle) < 0.0) return false;
  }
  return true;
}

// Moves ends that are one point to exactly one place.
void merge_ends(Border& pieces) {
  std::vector<Vec2*> ends;
  for (OutlinePiece& piece : pieces) {
    ends.push_back(&piece.a);
    ends.push_back(&piece.b);
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (!same(*ends[i], *ends[k])) continue;
      *ends[i] = *ends[k];
      break;
    }
  }
  // Segments whose ends moved have new directions.
  for (OutlinePiece& piece : pieces) piece = piece.part(piece.a, piece.b);
}

bool on_one_carrier(const OutlinePiece& u, const OutlinePiece& v) {
  if (u.turn != v.turn) return false;
  if (u.turn == 0) return (u.along - v.along).norm() < 1e-9;
  return (u.centre - v.centre).norm() < 1e-12 && std::abs(u.radius - v.radius) < 1e-12;
}

// Adds the run of `size` [m] on the first piece's carrier that ends at `end`.
void append_run(Border& border, const OutlinePiece& first, const Vec2& end, double size) {
  if (first.turn == 0) {
    border.push_back(first.part(first.a, end));
    return;
  }
  const double most = first.radius * std::numbers::pi / 1.5;
  const int parts = std::max(1, static_cast<int>(std::ceil(size / most)));
  Vec2 from = first.a;
  for (int i = 1; i <= parts; ++i) {
    const Vec2 to = i == parts ? end : first.at(size * i / parts);
    border.push_back(first.part(from, to));
    from = to;
  }
}

// How far to turn clockwise from looking back along `in` to looking along `out`, 0 .. 2 pi; the
// free space beside `in`'s end is what is swept.
double swept(const OutlinePiece& in, const OutlinePiece& out) {
  const Vec2 back = -in.tangent(in.b), ahead = out.tangent(out.a);
  const double angle = std::atan2(-cross(back, ahead), back.dot(ahead));
  // A sweep of nothing is one of a whole turn: free space has no spikes.
  return angle > 1e-6 ? angle : angle + 2.0 * std::numbers::pi;
}

}  // namespace

std::vector<OutlinePiece> border_of_union(const std::vector<WallShape>& shapes) {
  std::vector<Border> borders;
  for (const WallShape& shape : shapes) borders.push_back(border_of(shape));
  Border outer;
  for (std::size_t own = 0; own < shapes.size(); ++own) {
    for (const OutlinePiece& piece : borders[own]) {
      std::vector<Vec2> points;
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        if (i == own) continue;
        for (const OutlinePiece& other : borders[i]) collect(piece, other, points);
      }
      for (const OutlinePiece& part : split(piece, points)) {
        const Vec2 middle = part.at(0.5 * part.size());
        if (part.size() > kShortestPiece &&
            is_outer(middle, part.normal(middle), own, shapes, borders)) {
          outer.push_back(part);
        }
      }
    }
  }
  merge_ends(outer);
  return outer;
}

std::vector<int> chain(const std::vector<OutlinePiece>& pieces) {
  std::vector<int> next(pieces.size(), -1);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    double nearest = 0.0, sweep = 0.0;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const double gap = std::max(0.0, (pieces[k].a - pieces[i].b).norm() - kShortestPiece);
      const double angle = swept(pieces[i], pieces[k]);
      if (next[i] >= 0 && (gap > nearest || (gap == nearest && angle >= sweep))) continue;
      next[i] = static_cast<int>(k);
      nearest = gap;
      sweep = angle;
    }
  }
  return next;
}

std::vector<OutlinePiece> merged(const std::vector<OutlinePiece>& pieces) {
  const std::vector<int> next = chain(pieces);
  const auto follows_smoothly = [&](std::size_t i) {
    const OutlinePiece &u = pieces[i], &v = pieces[static_cast<std::size_t>(next[i])];
    return on_one_carrier(u, v) && std::count_if(pieces.begin(), pieces.end(),
                                                 [&](const auto& w) { return w.a == u.b; }) == 1;
  };
  std::vector<bool> is_first(pieces.size(), true), used(pieces.size(), false);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (follows_smoothly(i)) is_first[static_cast<std::size_t>(next[i])] = false;
  }
  Border result;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!is_first[i]) continue;
    std::size_t last = i;
    double size = pieces[i].size();
    used[i] = true;
    while (follows_smoothly(last)) {
      last = static_cast<std::size_t>(next[last]);
      size += pieces[last].size();
      used[last] = true;
    }
    append_run(result, pieces[i], pieces[last].b, size);
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!used[i]) result.push_back(pieces[i]);
  }
  return result;
}

}  // namespace handrail
