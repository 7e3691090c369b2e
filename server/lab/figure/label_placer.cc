#include "server/lab/figure/label_placer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace handrail::figure {
namespace {

constexpr double kOfMark = 1e4;   // so much worse is it to cover a mark than a line
constexpr int kRings = 8;         // of places around a point that are tried
constexpr double kRing = 6.0;     // from one to the next [px]
constexpr int kWays = 16;         // from the point
constexpr double kOfRing = 40.0;  // what a ring further away costs, as covered lines [px^2]

double overlap(const Rect& a, const Rect& b) {
  const double width = std::min(a.right(), b.right()) - std::max(a.left, b.left);
  const double height = std::min(a.bottom(), b.bottom()) - std::max(a.top, b.top);
  return width > 0.0 && height > 0.0 ? width * height : 0.0;
}

Rect moved_into(Rect rect, const Rect& frame) {
  rect.left = std::max(std::min(rect.left, frame.right() - rect.width), frame.left);
  rect.top = std::max(std::min(rect.top, frame.bottom() - rect.height), frame.top);
  return rect;
}

// Right, left, above, below, then the corners.
std::vector<Rect> places_around(const Point& at, double width, double height, double gap) {
  const double left = at.x - gap - width, right = at.x + gap, middle = at.x - width / 2.0;
  const double above = at.y - gap - height, below = at.y + gap, level = at.y - height / 2.0;
  std::vector<Rect> out;
  for (const Point& corner :
       {Point{right, level}, Point{left, level}, Point{middle, above}, Point{middle, below},
        Point{right, above}, Point{left, above}, Point{right, below}, Point{left, below}}) {
    out.push_back({corner.x, corner.y, width, height});
  }
  return out;
}

// With the side that faces the point, or its end, `away` from it that way.
Rect place_away(const Point& at, double width, double height, double away, double way) {
  const double x = std::cos(way), y = std::sin(way);
  const auto start = [](double of, double size) {
    return of > 0.3 ? 0.0 : of < -0.3 ? -size : -0.5 * size;
  };
  return {at.x + away * x + start(x, width), at.y + away * y + start(y, height), width, height};
}

}  // namespace

Point nearest_of(const Rect& rect, const Point& to) {
  return {std::clamp(to.x, rect.left, rect.right()), std::clamp(to.y, rect.top, rect.bottom())};
}

double LabelPlacer::cost_of(const Rect& rect) const {
  double cost = 0.0;
  for (const Taken& t : taken_) cost += (t.mark ? kOfMark : 1.0) * overlap(rect, t.rect);
  return cost;
}

// Of a line from `at` to the place, over marks that are not at `at` itself.
double LabelPlacer::cost_of_way(const Point& at, const Rect& rect) const {
  constexpr int kSteps = 16;
  const Point end = nearest_of(rect, at);
  double cost = 0.0;
  for (const Taken& t : taken_) {
    if (!t.mark || t.rect.contains(at)) continue;
    for (int i = 0; i <= kSteps; ++i) {
      const double share = static_cast<double>(i) / kSteps;
      if (t.rect.contains({std::lerp(at.x, end.x, share), std::lerp(at.y, end.y, share)})) {
        cost += kOfMark;
      }
    }
  }
  return cost;
}

Rect LabelPlacer::place(const std::vector<Rect>& candidates) {
  Rect best = moved_into(candidates.front(), frame_);
  double least = std::numeric_limits<double>::infinity();
  for (const Rect& candidate : candidates) {
    const Rect rect = moved_into(candidate, frame_);
    const double cost = cost_of(rect);
    if (cost < least) {
      least = cost;
      best = rect;
    }
  }
  take_mark(best);
  return best;
}

Rect LabelPlacer::place_beside(const Point& at, double width, double height, double gap) {
  std::vector<Rect> candidates = places_around(at, width, height, gap);
  double least = std::numeric_limits<double>::infinity();
  for (const Rect& c : candidates) least = std::min(least, cost_of(moved_into(c, frame_)));
  if (least < kOfMark) return place(candidates);
  Rect best = candidates.front();
  for (int ring = 1; ring <= kRings; ++ring) {
    for (int i = 0; i < kWays; ++i) {
      const double way = 2.0 * std::numbers::pi * i / kWays;
      const Rect rect = moved_into(place_away(at, width, height, gap + ring * kRing, way), frame_);
      const double cost = cost_of(rect) + cost_of_way(at, rect) + kOfRing * ring;
      if (cost < least) {
        least = cost;
        best = rect;
      }
    }
  }
  return place({best});
}

}  // namespace handrail::figure
