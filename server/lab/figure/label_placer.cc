#include "server/lab/figure/label_placer.h"

#include <algorithm>
#include <limits>

namespace handrail::figure {
namespace {

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

}  // namespace

Rect LabelPlacer::place(const std::vector<Rect>& candidates) {
  Rect best = moved_into(candidates.front(), frame_);
  double least = std::numeric_limits<double>::infinity();
  for (const Rect& candidate : candidates) {
    const Rect rect = moved_into(candidate, frame_);
    double covered = 0.0;
    for (const Rect& other : taken_) covered += overlap(rect, other);
    if (covered < least) {
      least = covered;
      best = rect;
    }
  }
  taken_.push_back(best);
  return best;
}

Rect LabelPlacer::place_beside(const Point& at, double width, double height, double gap) {
  const double left = at.x - gap - width, right = at.x + gap, middle = at.x - width / 2.0;
  const double above = at.y - gap - height, below = at.y + gap, level = at.y - height / 2.0;
  std::vector<Rect> candidates;
  for (const Point& corner :
       {Point{right, level}, Point{left, level}, Point{middle, above}, Point{middle, below},
        Point{right, above}, Point{left, above}, Point{right, below}, Point{left, below}}) {
    candidates.push_back({corner.x, corner.y, width, height});
  }
  return place(candidates);
}

}  // namespace handrail::figure
