// Shapes as SVG 1.1 text, in pixels with y down.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/lab/figure/geometry.h"
#include "server/lab/figure/style.h"

namespace handrail::figure {

enum class Anchor { kStart, kMiddle, kEnd };

struct TextStyle {
  double size = 11.0;  // [px]
  Anchor anchor = Anchor::kStart;
  std::string_view colour = kInk;
  bool bold = false;
  bool upward = false;  // reads from bottom to top
  bool halo = false;    // white around it, for text over lines
};

// Collects shapes in the order drawn. Coordinates must be finite.
class Svg {
 public:
  void line(const Point& a, const Point& b, std::string_view colour, double width,
            Dash dash = Dash::kSolid);
  void polyline(const std::vector<Point>& points, const Style& style);
  // Filled with `colour` at `opacity`, its outline drawn full; width 0: no outline.
  void rect(const Rect& rect, std::string_view colour, double opacity, double width);
  void marker(const Point& at, const Style& style);
  // `at`: the start, middle or end of the base line.
  void text(const Point& at, std::string_view text, const TextStyle& style);
  const std::string& shapes() const { return shapes_; }

 private:
  std::string shapes_;
};

}  // namespace handrail::figure
