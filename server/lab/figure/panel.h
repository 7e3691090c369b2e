// One diagram of a figure: axes, and what stands between them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/lab/figure/axis.h"
#include "server/lab/figure/geometry.h"
#include "server/lab/figure/label_placer.h"
#include "server/lab/figure/style.h"
#include "server/lab/figure/svg.h"

namespace handrail::figure {

// A value from elsewhere, marked on a box.
struct Published {
  double value = 0.0;
  std::string label;  // short, beside the mark, such as "14.6"; empty: none
  std::string name;   // in the legend
};

// A box-and-whisker plot of raw values (box.h). Failed trials are +infinity; a quartile that is
// infinite leaves the box open at the top of the frame, and their number is written there.
struct Box {
  double at = 1.0;  // on the x axis: category k from 0 is at k + 1
  std::vector<double> values = {};
  Style style = {};
  std::string name = {};  // in the legend; empty: not there
  std::optional<Published> published = {};
  double width = 0.4;  // in units of the x axis
};

// What the figure's legend says of a series. Series of the same name share an entry.
struct LegendEntry {
  std::string name;
  Style style;
  bool line = false, marker = false, box = false;
};

// Room on both sides of the frame [px]: left and right, or top and bottom.
struct Margins {
  double first = 0.0, second = 0.0;
};

// Values are in the units of the axes. What is not finite, not above 0 on a logarithmic axis or
// outside fixed ends is not drawn; lines break there. Names go to the legend unless empty.
class Panel {
 public:
  Panel(std::string title, Axis x, Axis y);

  // A unit of x becomes as long as one of y: the frame then shows more of one axis than asked for.
  // For linear axes only.
  void use_equal_scale() { equal_scale_ = true; }
  void line(std::vector<Point> points, const Style& style, std::string name = "");
  // `bars`, if any: one from low to high for each point. An end beyond the frame has no cap.
  void points(std::vector<Point> points, const Style& style, std::string name = "",
              std::vector<Range> bars = {});
  void box(Box box);
  // A place of its own with its name beside it, as A.
  void mark(const Point& at, std::string name);
  // A dashed line across the frame.
  void reference(double y, std::string label);
  // Text beside a point, where there is room.
  void note(const Point& at, std::string text);

  std::vector<LegendEntry> legend() const;

  // What the axes show: their fixed ends, or the data with a margin.
  Range x_range() const;
  Range y_range() const;
  // From here on the axes end there.
  void show(const Range& x, const Range& y);
  // Left and right, for a panel of that size, margins included.
  Margins side_margins(double width, double height) const;
  // Top and bottom, for a frame of that width.
  Margins end_margins(double frame_width) const;
  // The frame may stand in wider margins than asked for: the title starts `top` above it, the y
  // axis's label `left` beside it.
  void draw(Svg& svg, const Rect& frame, double left, double top) const;

 private:
  struct Series {
    std::vector<Point> points;
    Style style;
    std::string name;
    bool joined = false;
    std::vector<Range> bars;
  };
  struct Text {
    Point at;  // of a reference: y only
    std::string text;
  };
  // Everything in its place, for a frame.
  struct Layout {
    Rect frame;
    std::vector<Tick> x_ticks, y_ticks;
    AxisMap x, y;
    Point place(const Point& p) const { return {x(p.x), y(p.y)}; }
  };

  Layout layout_for(const Rect& frame) const;
  std::vector<std::string> title_lines(double frame_width) const;
  std::vector<std::string> y_label_lines(double frame_height) const;
  double category_size(double frame_width) const;
  std::size_t category_lines(double frame_width) const;

  void draw_axes(Svg& svg, const Layout& layout) const;
  void draw_titles(Svg& svg, const Rect& frame, double left, double top) const;
  void draw_series(Svg& svg, const Layout& layout, const Series& series) const;
  void draw_box(Svg& svg, const Layout& layout, const Box& box) const;
  void draw_labels(Svg& svg, const Layout& layout) const;
  void keep_clear(const Layout& layout, LabelPlacer& placer) const;
  void label_box(Svg& svg, const Layout& layout, const Box& box, LabelPlacer& placer) const;

  std::string title_;
  Axis x_axis_, y_axis_;
  bool equal_scale_ = false;
  std::vector<Series> series_;
  std::vector<Box> boxes_;
  std::vector<Text> references_;
  std::vector<Text> notes_;
};

// Panels that are to be compared: each shows what all of them do.
void share_axes(const std::vector<Panel*>& panels);
inline std::vector<Panel*> each(std::vector<Panel>& panels) {
  std::vector<Panel*> out;
  for (Panel& panel : panels) out.push_back(&panel);
  return out;
}

}  // namespace handrail::figure
