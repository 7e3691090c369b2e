// What a picture's colours and marks mean, and how long a millimetre is in it.
#pragma once

#include <string>
#include <vector>

#include "server/lab/scenes/canvas.h"

namespace handrail {

inline constexpr Colour kLetterColour = {40, 40, 40};

// One thing of the picture, drawn as there.
struct LegendEntry {
  enum class Mark { kNone, kArea, kLine, kArrow, kDot, kCross };
  Mark mark = Mark::kNone;
  Colour colour{};
  double size = 0.0;  // width of a line, length of an arrow, radius of a dot or cross [pixels]
  std::string words;
};

// A strip with a bar for the scale and the entries, in lines as wide as the picture.
class Legend {
 public:
  // `per_metre`: pixels of the picture.
  Legend(double width, double per_metre);

  void add(LegendEntry entry) { entries_.push_back(std::move(entry)); }
  int height() const;
  // With its upper edge at `top`.
  void draw(Canvas& canvas, int top) const;

 private:
  template <typename Use>
  int each_place(Use&& use) const;

  double width_, per_metre_;
  double bar_;  // its length, a round number [m]
  std::vector<LegendEntry> entries_;
};

// A cross at a place.
void draw_cross(Canvas& canvas, const Vec2& at, double radius, const Colour& colour);

}  // namespace handrail
