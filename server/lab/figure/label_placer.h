// Finds room for labels, so that they do not cover each other or what they speak of.
#pragma once

#include <vector>

#include "server/lab/figure/geometry.h"

namespace handrail::figure {

// The rectangle's point nearest to another.
Point nearest_of(const Rect& rect, const Point& to);

class LabelPlacer {
 public:
  explicit LabelPlacer(const Rect& frame) : frame_(frame) {}

  // Keeps labels away from this where it can.
  void take(const Rect& rect) { taken_.push_back({rect, false}); }
  // No label covers this as long as any place is left.
  void take_mark(const Rect& rect) { taken_.push_back({rect, true}); }
  // The candidate, moved into the frame, that overlaps least with what is taken; the first of
  // equals. At least one candidate. No label covers it then.
  Rect place(const std::vector<Rect>& candidates);
  // A place of this size beside `at`, `gap` away: right, left, above, below, then the corners.
  // Where it would cover a mark or a label there, further away, so that a line to it covers none
  // either.
  Rect place_beside(const Point& at, double width, double height, double gap);

 private:
  struct Taken {
    Rect rect;
    bool mark;
  };
  double cost_of(const Rect& rect) const;
  double cost_of_way(const Point& at, const Rect& rect) const;

  Rect frame_;
  std::vector<Taken> taken_;
};

}  // namespace handrail::figure
