// Finds room for labels, so that they do not cover each other or what they speak of.
#pragma once

#include <vector>

#include "server/lab/figure/geometry.h"

namespace handrail::figure {

class LabelPlacer {
 public:
  explicit LabelPlacer(const Rect& frame) : frame_(frame) {}

  // Keeps labels away from this.
  void take(const Rect& rect) { taken_.push_back(rect); }
  // The candidate, moved into the frame, that overlaps least with what is taken; the first of
  // equals. At least one candidate. The place is taken then.
  Rect place(const std::vector<Rect>& candidates);
  // A place of this size beside `at`, `gap` away: right, left, above, below, then the corners.
  Rect place_beside(const Point& at, double width, double height, double gap);

 private:
  Rect frame_;
  std::vector<Rect> taken_;
};

}  // namespace handrail::figure
