// Points and rectangles of figures, and lines cut down to what a viewer can see.
#pragma once

#include <vector>

namespace handrail::figure {

// In data units, or in pixels with x to the right and y down.
struct Point {
  double x = 0.0, y = 0.0;
  bool operator==(const Point&) const = default;
};

// In pixels.
struct Rect {
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;
  double right() const { return left + width; }
  double bottom() const { return top + height; }
  double center_x() const { return left + width / 2.0; }
  double center_y() const { return top + height / 2.0; }
  bool contains(const Point& p) const {
    return p.x >= left && p.x <= right() && p.y >= top && p.y <= bottom();
  }
};

// Finer than a viewer can see [px].
inline constexpr double kInvisible = 0.05;

// The line through `points` with as few of them as keep every one left out within `tolerance` of
// the line through those kept. Ends are kept. Points must be finite. Work is bounded by 2048 times
// the number of points. Source: Ramer 1972, Douglas and Peucker 1973, in chunks.
std::vector<Point> thin(const std::vector<Point>& points, double tolerance = kInvisible);

// The parts of the line through `points` inside `frame`, each two points or more. A point that is
// not finite breaks the line; a lone point stands twice, so that a round pen makes a dot of it.
std::vector<std::vector<Point>> visible_runs(const std::vector<Point>& points, const Rect& frame);

}  // namespace handrail::figure
