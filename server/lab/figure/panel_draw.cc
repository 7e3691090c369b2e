#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "server/lab/figure/box.h"
#include "server/lab/figure/font.h"
#include "server/lab/figure/panel.h"
#include "server/lab/figure/text.h"

namespace handrail::figure {
namespace {

constexpr double kTickLength = 4.0;
constexpr double kCap = 3.5;     // half the width of an error bar's end
constexpr double kCell = 3.0;    // of the grid that keeps labels off lines
constexpr double kBeside = 6.0;  // from a mark to its label
constexpr double kMark = 5.0;    // half of what a marker takes, with a label's halo
constexpr double kFar = 10.0;    // from a mark to a label that needs a line to it
constexpr double kWidest = 1.1;  // times Helvetica's are the letters of other sans-serif fonts

// A label in a place found for it.
void write_in(Svg& svg, const Rect& place, const std::string& text) {
  svg.text({place.center_x(), place.center_y() + kBaseLine * kNoteFont}, text,
           {.size = kNoteFont, .anchor = Anchor::kMiddle, .halo = true});
}

// ... beside the point it speaks of: from the side that faces it, however wide the viewer's font
// is, and with a line to it where it is far away.
void write_beside(Svg& svg, const Rect& place, const Point& of, const std::string& text) {
  const Point near = nearest_of(place, of);
  const double away = std::hypot(near.x - of.x, near.y - of.y);
  if (away > kFar) {
    const double share = kMark / away;
    svg.line({std::lerp(of.x, near.x, share), std::lerp(of.y, near.y, share)}, near, kPaleInk, 0.6);
  }
  const double base = place.center_y() + kBaseLine * kNoteFont;
  TextStyle style = {.size = kNoteFont, .anchor = Anchor::kMiddle, .halo = true};
  double x = place.center_x();
  if (place.left > of.x) x = place.left, style.anchor = Anchor::kStart;
  if (place.right() < of.x) x = place.right(), style.anchor = Anchor::kEnd;
  svg.text({x, base}, text, style);
}

double note_width(const std::string& text) { return kWidest * text_width(text, kNoteFont) + 2.0; }
constexpr double kNoteHeight = kNoteFont + 3.0;

Rect around(const Point& p, double half) {
  return {p.x - half, p.y - half, 2.0 * half, 2.0 * half};
}

}  // namespace

void Panel::draw(Svg& svg, const Rect& frame, double left, double top) const {
  const Layout layout = layout_for(frame);
  draw_axes(svg, layout);
  draw_titles(svg, frame, left, top);
  for (const Text& r : references_) {
    const double y = layout.y(r.at.y);
    if (!(y >= frame.top && y <= frame.bottom())) continue;
    svg.line({frame.left, y}, {frame.right(), y}, kPaleInk, 1.2, Dash::kDashed);
  }
  for (const Box& b : boxes_) draw_box(svg, layout, b);
  for (const Series& s : series_) draw_series(svg, layout, s);
  svg.polyline({{frame.left, frame.top},
                {frame.right(), frame.top},
                {frame.right(), frame.bottom()},
                {frame.left, frame.bottom()},
                {frame.left, frame.top}},
               {.colour = kPaleInk, .width = 1.0});
  draw_labels(svg, layout);
}

void Panel::draw_axes(Svg& svg, const Layout& layout) const {
  const Rect& frame = layout.frame;
  for (const Tick& tick : layout.y_ticks) {
    const double y = layout.y(tick.value);
    svg.line({frame.left, y}, {frame.right(), y}, kGrid, tick.label.empty() ? 0.5 : 1.0);
    svg.text({frame.left - kBeside, y + kBaseLine * kTickFont}, tick.label,
             {.size = kTickFont, .anchor = Anchor::kEnd});
  }
  if (y_axis_.none) {
    const double y = layout.y(kAboveNone * *y_axis_.none);
    svg.line({frame.left, y}, {frame.right(), y}, kPaleInk, 0.8, Dash::kDotted);
  }
  const double count = static_cast<double>(x_axis_.categories.size());
  const double size = count > 0.0 ? category_size(frame.width) : kTickFont;
  for (const Tick& tick : layout.x_ticks) {
    const double x = layout.x(tick.value);
    if (count == 0.0) {
      svg.line({x, frame.top}, {x, frame.bottom()}, kGrid, tick.label.empty() ? 0.5 : 1.0);
    }
    double y = frame.bottom() + kLine;
    const double room = count > 0.0 ? 0.95 * frame.width / count + 0.01 : frame.width;
    for (const std::string& text : wrap(tick.label, size, room)) {
      svg.text({x, y}, text, {.size = size, .anchor = Anchor::kMiddle});
      y += kLine;
    }
  }
  const double below = frame.bottom() + kLine * static_cast<double>(category_lines(frame.width));
  svg.text({frame.center_x(), below + kLine + 2.0}, x_axis_.label,
           {.size = kAxisFont, .anchor = Anchor::kMiddle});
}

void Panel::draw_titles(Svg& svg, const Rect& frame, double left, double top) const {
  double x = frame.left - left + kLine - 4.0;
  for (const std::string& text : y_label_lines(frame.height)) {
    svg.text({x, frame.center_y()}, text,
             {.size = kAxisFont, .anchor = Anchor::kMiddle, .upward = true});
    x += kLine;
  }
  double y = frame.top - top + kLine - 2.0;
  for (const std::string& text : title_lines(frame.width)) {
    svg.text({frame.left, y}, text, {.size = kPanelFont, .bold = true});
    y += kLine;
  }
}

void Panel::draw_series(Svg& svg, const Layout& layout, const Series& series) const {
  std::vector<Point> placed;
  for (const Point& p : series.points) placed.push_back(layout.place(p));
  if (series.joined) {
    for (const auto& run : visible_runs(placed, layout.frame)) {
      svg.polyline(thin(run), series.style);
    }
    return;
  }
  for (std::size_t i = 0; i < std::min(placed.size(), series.bars.size()); ++i) {
    const double x = placed[i].x;
    if (!(x >= layout.frame.left && x <= layout.frame.right())) continue;
    const Range bar = series.bars[i];
    if (std::isnan(bar.low) || std::isnan(bar.high)) continue;
    const double ends[] = {layout.y.clamped(bar.low), layout.y.clamped(bar.high)};
    svg.line({x, ends[0]}, {x, ends[1]}, series.style.colour, 1.2);
    for (const double end : ends) {
      if (end <= layout.frame.top || end >= layout.frame.bottom()) continue;
      svg.line({x - kCap, end}, {x + kCap, end}, series.style.colour, 1.2);
    }
  }
  for (const Point& p : placed) {
    if (layout.frame.contains(p)) svg.marker(p, series.style);
  }
}

void Panel::draw_box(Svg& svg, const Layout& layout, const Box& box) const {
  const BoxStats stats = box_stats(box.values);
  const double left = layout.x(box.at - box.width / 2.0);
  const double right = layout.x(box.at + box.width / 2.0);
  const double middle = layout.x(box.at);
  const auto within = [&](double y) { return y > layout.frame.top && y < layout.frame.bottom(); };
  const auto across = [&](double value, double from, double to, double width) {
    const double y = layout.y.clamped(value);
    if (std::isfinite(value) && within(y)) svg.line({from, y}, {to, y}, box.style.colour, width);
  };
  if (std::isfinite(stats.q1)) {
    const double q1 = layout.y.clamped(stats.q1), q3 = layout.y.clamped(stats.q3);
    svg.rect({left, q3, right - left, q1 - q3}, box.style.colour, 0.22, 0.0);
    svg.line({left, q3}, {left, q1}, box.style.colour, 1.2);
    svg.line({right, q3}, {right, q1}, box.style.colour, 1.2);
    across(stats.q1, left, right, 1.2);
    across(stats.q3, left, right, 1.2);
    across(stats.median, left, right, 2.6);
    const double cap = (right - left) / 4.0;
    svg.line({middle, q1}, {middle, layout.y.clamped(stats.low)}, box.style.colour, 1.2);
    across(stats.low, middle - cap, middle + cap, 1.2);
    if (std::isfinite(stats.q3)) {
      svg.line({middle, q3}, {middle, layout.y.clamped(stats.high)}, box.style.colour, 1.2);
      across(stats.high, middle - cap, middle + cap, 1.2);
    }
  }
  Style circles = box.style;
  circles.marker = Marker::kCircle;
  circles.hollow = true;
  for (const double v : stats.outliers) {
    const Point p = layout.place({box.at, v});
    if (layout.frame.contains(p)) svg.marker(p, circles);
  }
  if (!box.published) return;
  const Point p = layout.place({box.at, box.published->value});
  if (layout.frame.contains(p)) svg.marker(p, kReferenceStyle);
}

// Lines take the cells of a coarse grid they pass through, each once.
void Panel::keep_clear(const Layout& layout, LabelPlacer& placer) const {
  const Rect& frame = layout.frame;
  std::set<std::pair<int, int>> cells;
  const auto pass = [&](const Point& a, const Point& b) {
    const int steps = 1 + static_cast<int>(std::hypot(b.x - a.x, b.y - a.y) / kCell);
    for (int i = 0; i <= steps; ++i) {
      const double share = static_cast<double>(i) / steps;
      cells.insert({static_cast<int>(std::lerp(a.x, b.x, share) / kCell),
                    static_cast<int>(std::lerp(a.y, b.y, share) / kCell)});
    }
  };
  for (const Series& s : series_) {
    std::vector<Point> placed;
    for (const Point& p : s.points) placed.push_back(layout.place(p));
    if (s.joined) {
      for (const auto& run : visible_runs(placed, frame)) {
        for (std::size_t i = 1; i < run.size(); ++i) pass(run[i - 1], run[i]);
      }
      continue;
    }
    for (std::size_t i = 0; i < placed.size(); ++i) {
      if (frame.contains(placed[i])) placer.take_mark(around(placed[i], kMark));
      const bool bar = i < s.bars.size() && frame.contains({placed[i].x, frame.top});
      if (!bar || std::isnan(s.bars[i].low) || std::isnan(s.bars[i].high)) continue;
      pass({placed[i].x, layout.y.clamped(s.bars[i].low)},
           {placed[i].x, layout.y.clamped(s.bars[i].high)});
    }
  }
  for (const Text& r : references_) {
    const Point left = {frame.left, layout.y(r.at.y)};
    if (frame.contains(left)) pass(left, {frame.right(), left.y});
  }
  for (const auto& [column, row] : cells) {
    placer.take({column * kCell, row * kCell, kCell, kCell});
  }
  for (const Box& b : boxes_) {
    const double left = layout.x(b.at - b.width / 2.0), right = layout.x(b.at + b.width / 2.0);
    for (const double v : b.values) {
      const Point at = layout.place({b.at, v});
      if (frame.contains(at)) placer.take({left, at.y - 3.0, right - left, 6.0});
    }
    if (!b.published) continue;
    const Point at = layout.place({b.at, b.published->value});
    if (frame.contains(at)) placer.take_mark(around(at, kMark));
  }
}

void Panel::draw_labels(Svg& svg, const Layout& layout) const {
  const Rect& frame = layout.frame;
  LabelPlacer placer({frame.left + 3.0, frame.top + 3.0, frame.width - 6.0, frame.height - 6.0});
  keep_clear(layout, placer);
  for (const Box& b : boxes_) label_box(svg, layout, b, placer);
  for (const Text& r : references_) {
    const double y = layout.y(r.at.y);
    if (!(y >= frame.top && y <= frame.bottom())) continue;
    const double width = note_width(r.text), above = y - kNoteHeight - kCell, below = y + kCell;
    std::vector<Rect> candidates;
    for (const double share : {1.0, 0.0, 0.75, 0.5, 0.25}) {
      const double left = std::lerp(frame.left + 4.0, frame.right() - width - 4.0, share);
      candidates.push_back({left, above, width, kNoteHeight});
      candidates.push_back({left, below, width, kNoteHeight});
    }
    write_in(svg, placer.place(candidates), r.text);
  }
  for (const Text& n : notes_) {
    const Point at = layout.place(n.at);
    if (!frame.contains(at)) continue;
    const Rect place = placer.place_beside(at, note_width(n.text), kNoteHeight, kBeside);
    write_beside(svg, place, at, n.text);
  }
}

void Panel::label_box(Svg& svg, const Layout& layout, const Box& box, LabelPlacer& placer) const {
  const Rect& frame = layout.frame;
  if (const BoxStats stats = box_stats(box.values); stats.failures > 0) {
    const std::string text =
        std::to_string(stats.failures) + " of " + std::to_string(stats.count) + " failed";
    const double width = note_width(text), left = layout.x(box.at) - width / 2.0;
    std::vector<Rect> rows;
    for (int row = 0; row < 3; ++row) {
      rows.push_back({left, frame.top + 3.0 + row * kNoteHeight, width, kNoteHeight});
    }
    write_in(svg, placer.place(rows), text);
  }
  if (!box.published || box.published->label.empty()) return;
  const Point at = layout.place({box.at, box.published->value});
  if (!frame.contains(at)) return;
  const double half = (layout.x(box.at + box.width / 2.0) - layout.x(box.at - box.width / 2.0)) / 2;
  write_in(svg, placer.place_beside(at, note_width(box.published->label), kNoteHeight, half + 3.0),
           box.published->label);
}

}  // namespace handrail::figure
