// A picture of pixels to draw on, and its PNG file.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "server/base/plane.h"
#include "server/base/status.h"

namespace handrail {

using Colour = std::array<std::uint8_t, 3>;  // sRGB

// Places in pixels, x right and y down from the upper left corner; what is outside is not drawn.
class Canvas {
 public:
  Canvas(int width, int height, const Colour& ground);

  int width() const { return width_; }
  int height() const { return height_; }
  void set(int x, int y, const Colour& colour) { blend(x, y, colour, 1.0); }
  Colour at(int x, int y) const;
  // Round ends, smooth edges; `width` > 0.
  void line(const Vec2& from, const Vec2& to, double width, const Colour& colour);
  void disc(const Vec2& centre, double radius, const Colour& colour) {
    line(centre, centre, 2.0 * radius, colour);
  }
  // A line with a head at its end.
  void arrow(const Vec2& from, const Vec2& to, double width, const Colour& colour);

  // Writes or replaces the file. The error names it and says why.
  Status write_png(const std::string& path) const;

 private:
  void blend(int x, int y, const Colour& colour, double share);

  int width_, height_;
  std::vector<std::uint8_t> rgb_;  // row by row from the top
};

}  // namespace handrail
