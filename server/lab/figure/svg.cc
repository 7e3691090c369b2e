#include "server/lab/figure/svg.h"

#include <initializer_list>
#include <utility>

#include "server/lab/figure/text.h"

namespace handrail::figure {
namespace {

constexpr double kMarker = 3.2;  // half a marker's size [px]

std::string attribute(std::string_view name, std::string_view value) {
  std::string out(1, ' ');
  out.append(name).append("=\"").append(value).append("\"");
  return out;
}

std::string attribute(std::string_view name, double value) {
  return attribute(name, std::string_view(number(value)));
}

std::string_view pattern_of(Dash dash) {
  switch (dash) {
    case Dash::kSolid: return "";
    case Dash::kDashed: return "6 3";
    case Dash::kDotted: return "1 3";
    case Dash::kDashDot: return "7 3 1 3";
    case Dash::kLongDash: return "12 4";
  }
  return "";
}

std::string stroke(std::string_view colour, double width, Dash dash) {
  std::string out = attribute("stroke", colour) + attribute("stroke-width", width);
  if (dash != Dash::kSolid) out += attribute("stroke-dasharray", pattern_of(dash));
  return out;
}

std::string joined(const std::vector<Point>& points) {
  std::string out;
  for (const Point& p : points) {
    if (!out.empty()) out += ' ';
    out += number(p.x) + "," + number(p.y);
  }
  return out;
}

}  // namespace

void Svg::line(const Point& a, const Point& b, std::string_view colour, double width, Dash dash) {
  shapes_ += "<line" + attribute("x1", a.x) + attribute("y1", a.y) + attribute("x2", b.x) +
             attribute("y2", b.y) + stroke(colour, width, dash) + "/>\n";
}

void Svg::polyline(const std::vector<Point>& points, const Style& style) {
  shapes_ += "<polyline" + attribute("points", joined(points)) + attribute("fill", "none") +
             attribute("stroke-linejoin", "round") + attribute("stroke-linecap", "round") +
             stroke(style.colour, style.width, style.dash) + "/>\n";
}

void Svg::rect(const Rect& rect, std::string_view colour, double opacity, double width) {
  shapes_ += "<rect" + attribute("x", rect.left) + attribute("y", rect.top) +
             attribute("width", rect.width) + attribute("height", rect.height) +
             attribute("fill", colour) + attribute("fill-opacity", opacity);
  if (width > 0.0) shapes_ += stroke(colour, width, Dash::kSolid);
  shapes_ += "/>\n";
}

void Svg::marker(const Point& at, const Style& style) {
  const std::string paint = attribute("fill", style.hollow ? "#ffffff" : style.colour) +
                            stroke(style.colour, 1.2, Dash::kSolid) + "/>\n";
  const auto polygon = [&](std::initializer_list<Point> offsets) {
    std::vector<Point> corners;
    for (const Point& o : offsets) {
      corners.push_back({at.x + kMarker * o.x, at.y + kMarker * o.y});
    }
    shapes_ += "<polygon" + attribute("points", joined(corners)) + paint;
  };
  switch (style.marker) {
    case Marker::kNone: return;
    case Marker::kCircle:
      shapes_ += "<circle" + attribute("cx", at.x) + attribute("cy", at.y) +
                 attribute("r", kMarker) + paint;
      return;
    case Marker::kSquare: return polygon({{-0.9, -0.9}, {0.9, -0.9}, {0.9, 0.9}, {-0.9, 0.9}});
    case Marker::kTriangle: return polygon({{0.0, -1.15}, {1.1, 0.85}, {-1.1, 0.85}});
    case Marker::kDiamond: return polygon({{0.0, -1.4}, {1.4, 0.0}, {0.0, 1.4}, {-1.4, 0.0}});
    case Marker::kCross:
      for (const double side : {-kMarker, kMarker}) {
        line({at.x - kMarker, at.y - side}, {at.x + kMarker, at.y + side}, style.colour, 1.6);
      }
      return;
  }
}

void Svg::text(const Point& at, std::string_view text, const TextStyle& style) {
  const char* anchors[] = {"start", "middle", "end"};
  std::string head = "<text" + attribute("x", at.x) + attribute("y", at.y) +
                     attribute("font-size", style.size) +
                     attribute("text-anchor", anchors[static_cast<int>(style.anchor)]);
  if (style.bold) head += attribute("font-weight", "bold");
  if (style.upward) {
    head += attribute("transform", "rotate(-90 " + number(at.x) + " " + number(at.y) + ")");
  }
  std::string tail(1, '>');
  tail.append(escape(text)).append("</text>\n");
  if (style.halo) {
    shapes_ += head + attribute("fill", "#ffffff") + attribute("stroke", "#ffffff") +
               attribute("stroke-width", 3.0) + attribute("stroke-linejoin", "round") + tail;
  }
  shapes_ += head + attribute("fill", style.colour) + tail;
}

}  // namespace handrail::figure
