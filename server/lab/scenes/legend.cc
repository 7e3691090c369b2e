#include "server/lab/scenes/legend.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/base/units.h"
#include "server/lab/scenes/letters.h"

namespace handrail {
namespace {

// Pixels.
constexpr double kLetters = 9.0;     // height of capitals
constexpr double kRow = 22.0;        // from one line to the next
constexpr double kEdge = 10.0;       // to the picture's edges
constexpr double kMarkWidth = 32.0;  // an arrow of the largest force fits in
constexpr double kToWords = 6.0;
constexpr double kToNext = 24.0;
constexpr double kLongestBar = 0.25;  // of the picture's width

// The longest of 1, 2 and 5 mm, or ten times as much or as little, that is not above `most` [m].
double round_length(double most) {
  const double decade = std::pow(10.0, std::floor(std::log10(most)));
  for (const double of : {5.0, 2.0}) {
    if (of * decade <= most) return of * decade;
  }
  return decade;
}

void draw_mark(Canvas& canvas, const LegendEntry& entry, const Vec2& left) {
  const Vec2 right = left + Vec2(kMarkWidth, 0.0), middle = 0.5 * (left + right);
  switch (entry.mark) {
    case LegendEntry::Mark::kNone: break;
    case LegendEntry::Mark::kArea:
      canvas.line(left + Vec2(7.0, 0.0), right - Vec2(7.0, 0.0), 15.0, kLetterColour);
      canvas.line(left + Vec2(7.0, 0.0), right - Vec2(7.0, 0.0), 13.0, entry.colour);
      break;
    case LegendEntry::Mark::kLine: canvas.line(left, right, entry.size, entry.colour); break;
    case LegendEntry::Mark::kArrow:
      canvas.arrow(left, left + Vec2(entry.size, 0.0), 1.6, entry.colour);
      break;
    case LegendEntry::Mark::kDot: canvas.disc(middle, entry.size, entry.colour); break;
    case LegendEntry::Mark::kCross: draw_cross(canvas, middle, entry.size, entry.colour); break;
  }
}

}  // namespace

void draw_cross(Canvas& canvas, const Vec2& at, double radius, const Colour& colour) {
  for (const double way : {-1.0, 1.0}) {
    const Vec2 off(radius, way * radius);
    canvas.line(at - off, at + off, 1.0, colour);
  }
}

Legend::Legend(double width, double per_metre)
    : width_(width), per_metre_(per_metre), bar_(round_length(kLongestBar * width / per_metre)) {}

// Calls `use` with each entry and the middle of its left end, in the strip; a line that is full
// goes on in the next. Returns the lines.
template <typename Use>
int Legend::each_place(Use&& use) const {
  const std::string length = fmt::format("{:g} mm", bar_ / kMm);
  double x = kEdge + bar_ * per_metre_ + kToWords + letters_width(length, kLetters) + kToNext;
  int row = 0;
  for (const LegendEntry& entry : entries_) {
    const double mark = entry.mark == LegendEntry::Mark::kNone ? 0.0 : kMarkWidth + kToWords;
    const double wide = mark + letters_width(entry.words, kLetters);
    if (x > kEdge && x + wide > width_ - kEdge) {
      x = kEdge;
      ++row;
    }
    use(entry, Vec2(x, kEdge + (row + 0.5) * kRow), mark);
    x += wide + kToNext;
  }
  return row + 1;
}

int Legend::height() const {
  const int rows = each_place([](const LegendEntry&, const Vec2&, double) {});
  return static_cast<int>(std::lround(2.0 * kEdge + rows * kRow));
}

void Legend::draw(Canvas& canvas, int top) const {
  const auto words = [&](const Vec2& left, const std::string& text) {
    draw_letters(canvas, left + Vec2(0.0, 0.5 * kLetters), text, kLetters, kLetterColour);
  };
  const Vec2 from(kEdge, top + kEdge + 0.5 * kRow), to = from + Vec2(bar_ * per_metre_, 0.0);
  canvas.line(from, to, 2.0, kLetterColour);
  for (const Vec2& end : {from, to}) {
    canvas.line(end - Vec2(0.0, 5.0), end + Vec2(0.0, 5.0), 2.0, kLetterColour);
  }
  words(to + Vec2(kToWords, 0.0), fmt::format("{:g} mm", bar_ / kMm));
  each_place([&](const LegendEntry& entry, const Vec2& at, double mark) {
    const Vec2 left = at + Vec2(0.0, top);
    draw_mark(canvas, entry, left);
    words(left + Vec2(mark, 0.0), entry.words);
  });
}

}  // namespace handrail
