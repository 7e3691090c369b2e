#include "server/lab/figure/panel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/lab/figure/box.h"
#include "server/lab/figure/font.h"
#include "server/lab/figure/text.h"

namespace handrail::figure {
namespace {

constexpr double kMargin = 0.04;        // of the data's range, on either side
constexpr double kFailureMargin = 0.2;  // above, when failures are written there
constexpr double kTickGap = 8.0;        // at least, between labels on the x axis [px]

// The range of what an axis can show.
class Extent {
 public:
  explicit Extent(const Axis& axis) : axis_(axis) {}
  void add(double v) {
    if (!std::isfinite(v) || (axis_.scale == Scale::kLog && v <= 0.0)) return;
    low_ = std::min(low_, v);
    high_ = std::max(high_, v);
  }
  // With margins where the axis has no fixed end; what is not negative stays so.
  Range padded(double above) const {
    Range range = {low_, high_};
    if (low_ > high_) range.low = range.high = std::numeric_limits<double>::quiet_NaN();
    if (axis_.low && std::isnan(range.low)) range = {*axis_.low, axis_.high.value_or(*axis_.low)};
    range = {axis_.low.value_or(range.low), axis_.high.value_or(range.high)};
    range = showable(axis_.scale, range);
    if (axis_.scale == Scale::kLog) {
      const double span = std::log10(range.high) - std::log10(range.low);
      if (!axis_.low) range.low *= std::pow(10.0, -kMargin * span);
      if (!axis_.high) range.high *= std::pow(10.0, above * span);
    } else {
      const double span = range.high - range.low;
      if (!axis_.low)
        range.low =
            low_ >= 0.0 ? std::max(0.0, range.low - kMargin * span) : range.low - kMargin * span;
      if (!axis_.high) range.high += above * span;
    }
    return showable(axis_.scale, range);
  }

 private:
  const Axis& axis_;
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
};

// As many ticks as have room for their labels.
std::vector<Tick> roomy_ticks(const Axis& axis, Range range, double width) {
  const AxisMap map(axis.scale, range, 0.0, width);
  for (int most = 8; most > 2; --most) {
    std::vector<Tick> out = ticks(axis.scale, range, most);
    double free_from = -std::numeric_limits<double>::infinity();
    const bool fits = std::all_of(out.begin(), out.end(), [&](const Tick& tick) {
      if (tick.label.empty()) return true;
      const double half = text_width(tick.label, kTickFont) / 2.0;
      const bool room = map(tick.value) - half >= free_from;
      free_from = map(tick.value) + half + kTickGap;
      return room;
    });
    if (fits) return out;
  }
  return ticks(axis.scale, range, 2);
}

// Widens a range about its middle.
Range widened(Range range, double factor) {
  const double more = (range.high - range.low) * (factor - 1.0) / 2.0;
  return {range.low - more, range.high + more};
}

double widest(const std::vector<Tick>& ticks) {
  double width = 0.0;
  for (const Tick& tick : ticks) width = std::max(width, text_width(tick.label, kTickFont));
  return width;
}

}  // namespace

Panel::Panel(std::string title, Axis x, Axis y)
    : title_(std::move(title)), x_axis_(std::move(x)), y_axis_(std::move(y)) {}

void Panel::line(std::vector<Point> points, const Style& style, std::string name) {
  series_.push_back({std::move(points), style, std::move(name), true, {}});
}

void Panel::points(std::vector<Point> points, const Style& style, std::string name,
                   std::vector<Range> bars) {
  series_.push_back({std::move(points), style, std::move(name), false, std::move(bars)});
}

void Panel::box(Box box) { boxes_.push_back(std::move(box)); }

void Panel::reference(double y, std::string label) {
  references_.push_back({{0.0, y}, std::move(label)});
}

void Panel::note(const Point& at, std::string text) { notes_.push_back({at, std::move(text)}); }

void Panel::mark(const Point& at, std::string name) {
  points({at}, kPlaceStyle);
  note(at, std::move(name));
}

void Panel::show(const Range& x, const Range& y) {
  if (x_axis_.categories.empty()) {
    x_axis_.low = x.low;
    x_axis_.high = x.high;
  }
  y_axis_.low = y.low;
  y_axis_.high = y.high;
}

void share_axes(const std::vector<Panel*>& panels) {
  if (panels.empty()) return;
  Range x = panels.front()->x_range(), y = panels.front()->y_range();
  for (const Panel* panel : panels) {
    const Range px = panel->x_range(), py = panel->y_range();
    x = {std::min(x.low, px.low), std::max(x.high, px.high)};
    y = {std::min(y.low, py.low), std::max(y.high, py.high)};
  }
  for (Panel* panel : panels) panel->show(x, y);
}

std::vector<LegendEntry> Panel::legend() const {
  std::vector<LegendEntry> out;
  for (const Series& s : series_) out.push_back({s.name, s.style, s.joined, !s.joined, false});
  for (const Box& b : boxes_) out.push_back({b.name, b.style, false, false, true});
  for (const Box& b : boxes_) {
    if (b.published) out.push_back({b.published->name, kReferenceStyle, false, true, false});
  }
  return out;
}

Range Panel::x_range() const {
  if (!x_axis_.categories.empty()) {
    return {0.5, static_cast<double>(x_axis_.categories.size()) + 0.5};
  }
  Extent extent(x_axis_);
  for (const Series& s : series_) {
    for (const Point& p : s.points) extent.add(p.x);
  }
  for (const Box& b : boxes_) {
    extent.add(b.at - b.width);
    extent.add(b.at + b.width);
  }
  return extent.padded(kMargin);
}

Range Panel::y_range() const {
  Extent extent(y_axis_);
  bool failures = false;
  for (const Series& s : series_) {
    for (const Point& p : s.points) extent.add(p.y);
    for (const Range& bar : s.bars) {
      extent.add(bar.low);
      extent.add(bar.high);
    }
  }
  for (const Box& b : boxes_) {
    for (const double v : b.values) extent.add(v);
    if (b.published) extent.add(b.published->value);
    failures |= box_stats(b.values).failures > 0;
  }
  for (const Text& r : references_) extent.add(r.at.y);
  return extent.padded(failures ? kFailureMargin : kMargin);
}

Panel::Layout Panel::layout_for(const Rect& frame) const {
  Range x = x_range(), y = y_range();
  if (equal_scale_) {
    const double ratio = (x.high - x.low) / frame.width / ((y.high - y.low) / frame.height);
    if (ratio < 1.0) x = widened(x, 1.0 / ratio);
    if (ratio > 1.0) y = widened(y, ratio);
  }
  std::vector<Tick> y_ticks =
      ticks(y_axis_.scale, y, std::clamp(static_cast<int>(frame.height / 30.0), 2, 8));
  if (y_axis_.none) y_ticks = with_none(std::move(y_ticks), *y_axis_.none);
  return {frame,
          x_axis_.categories.empty() ? roomy_ticks(x_axis_, x, frame.width)
                                     : category_ticks(x_axis_.categories),
          std::move(y_ticks), AxisMap(x_axis_.scale, x, frame.left, frame.right()),
          AxisMap(y_axis_.scale, y, frame.bottom(), frame.top)};
}

std::vector<std::string> Panel::y_label_lines(double frame_height) const {
  return wrap(y_axis_.label, kAxisFont, frame_height);
}

double Panel::category_size(double frame_width) const {
  const double slot = 0.95 * frame_width / static_cast<double>(x_axis_.categories.size());
  double size = kTickFont;
  for (const std::string& category : x_axis_.categories) {
    for (const std::string& word : wrap(category, kTickFont, 0.0)) {
      size = std::min(size, kTickFont * slot / std::max(text_width(word, kTickFont), 1.0));
    }
  }
  return std::max(size, kLeastFont);
}

std::size_t Panel::category_lines(double frame_width) const {
  const double slot = 0.95 * frame_width / static_cast<double>(x_axis_.categories.size());
  std::size_t lines = 1;
  for (const std::string& category : x_axis_.categories) {
    lines = std::max(lines, wrap(category, category_size(frame_width), slot + 0.01).size());
  }
  return lines;
}

std::vector<std::string> Panel::title_lines(double frame_width) const {
  return wrap(title_, kPanelFont * kBold, frame_width);
}

Margins Panel::side_margins(double width, double height) const {
  const Rect about = {0.0, 0.0, 0.8 * width, std::max(height - 4.0 * kLine, 1.0)};
  const auto label_lines = static_cast<double>(y_label_lines(about.height).size());
  return {14.0 + widest(layout_for(about).y_ticks) + kLine * label_lines, 14.0};
}

Margins Panel::end_margins(double frame_width) const {
  const auto titles = static_cast<double>(title_lines(frame_width).size());
  const auto ticks_lines = static_cast<double>(category_lines(frame_width));
  return {6.0 + kLine * titles, 8.0 + kLine * (ticks_lines + (x_axis_.label.empty() ? 0.0 : 1.0))};
}

}  // namespace handrail::figure
