#include "server/lab/figure/figure.h"

#include <algorithm>
#include <utility>

#include "server/base/output.h"
#include "server/lab/figure/font.h"
#include "server/lab/figure/text.h"

namespace handrail::figure {
namespace {

constexpr double kEdge = 12.0;
constexpr double kGap = 10.0;     // between panels
constexpr double kSample = 26.0;  // width of a legend entry's sample

// Entries by name, in order of appearance; what entries of a name show is put together.
std::vector<LegendEntry> entries_of(const std::vector<Panel>& panels) {
  std::vector<LegendEntry> out;
  for (const Panel& panel : panels) {
    for (const LegendEntry& entry : panel.legend()) {
      if (entry.name.empty()) continue;
      const auto same = std::find_if(out.begin(), out.end(), [&](const LegendEntry& other) {
        return other.name == entry.name;
      });
      if (same == out.end()) {
        out.push_back(entry);
        continue;
      }
      same->line |= entry.line;
      same->marker |= entry.marker;
      same->box |= entry.box;
    }
  }
  return out;
}

void draw_entry(Svg& svg, const LegendEntry& entry, double left, double middle) {
  if (entry.box) {
    svg.rect({left + 4.0, middle - 5.0, kSample - 8.0, 10.0}, entry.style.colour, 0.22, 1.2);
    svg.line({left + 4.0, middle}, {left + kSample - 4.0, middle}, entry.style.colour, 2.6);
  }
  Style style = entry.style;
  style.width = std::max(style.width, 1.6);
  if (entry.line) svg.polyline({{left, middle}, {left + kSample, middle}}, style);
  if (entry.marker) svg.marker({left + kSample / 2.0, middle}, entry.style);
  svg.text({left + kSample + 6.0, middle + kBaseLine * kTickFont}, entry.name, {.size = kTickFont});
}

// Draws the legend from `top` down and returns where it ends.
double draw_legend(Svg& svg, const std::vector<LegendEntry>& entries, double top, double width) {
  if (entries.empty()) return top;
  double x = kEdge, y = top + kLine / 2.0;
  for (const LegendEntry& entry : entries) {
    const double needed = kSample + 6.0 + text_width(entry.name, kTickFont) + 14.0;
    if (x > kEdge && x + needed > width - kEdge) {
      x = kEdge;
      y += kLine + 2.0;
    }
    draw_entry(svg, entry, x, y);
    x += needed;
  }
  return y + kLine / 2.0 + 2.0;
}

// Draws lines of text from `top` down and returns where they end.
double draw_heading(Svg& svg, const std::string& text, double top, double width,
                    const TextStyle& style) {
  if (text.empty()) return top;
  for (const std::string& line :
       wrap(text, style.size * (style.bold ? kBold : 1.0), width - 2.0 * kEdge)) {
    svg.text({kEdge, top + style.size}, line, style);
    top += style.size + 4.0;
  }
  return top;
}

}  // namespace

Figure::Figure(std::string title, std::string subtitle, const FigureOptions& options)
    : title_(std::move(title)), subtitle_(std::move(subtitle)), options_(options) {
  options_.columns = std::max<std::size_t>(options_.columns, 1);
  options_.panel_width = std::max(options_.panel_width, 120.0);
  options_.panel_height = std::max(options_.panel_height, 120.0);
}

std::string Figure::svg() const {
  const double w = options_.panel_width, h = options_.panel_height;
  const std::size_t columns = std::clamp<std::size_t>(panels_.size(), 1, options_.columns);
  const std::size_t rows = (panels_.size() + columns - 1) / columns;
  const double width = 2.0 * kEdge + static_cast<double>(columns) * (w + kGap) - kGap;

  // Frames of a column have the same left and right, frames of a row the same top and bottom.
  const auto widen = [](Margins& m, const Margins& by) {
    m = {std::max(m.first, by.first), std::max(m.second, by.second)};
  };
  std::vector<Margins> sides(columns), ends(rows);
  for (std::size_t i = 0; i < panels_.size(); ++i) {
    widen(sides[i % columns], panels_[i].side_margins(w, h));
  }
  const auto frame_width = [&](std::size_t i) {
    return std::max(w - sides[i % columns].first - sides[i % columns].second, 1.0);
  };
  for (std::size_t i = 0; i < panels_.size(); ++i) {
    widen(ends[i / columns], panels_[i].end_margins(frame_width(i)));
  }

  Svg svg;
  double y = draw_heading(svg, title_, kEdge, width, {.size = kTitleFont, .bold = true});
  y = draw_heading(svg, subtitle_, y, width, {.size = kSubtitleFont, .colour = kPaleInk}) + 6.0;
  for (std::size_t i = 0; i < panels_.size(); ++i) {
    const std::size_t row = i / columns, column = i % columns;
    const Margins& side = sides[column];
    const Margins& end = ends[row];
    const double left = kEdge + static_cast<double>(column) * (w + kGap);
    const double top = y + static_cast<double>(row) * (h + kGap);
    panels_[i].draw(svg,
                    {left + side.first, top + end.first, frame_width(i),
                     std::max(h - end.first - end.second, 1.0)},
                    side.first, end.first);
  }
  y += static_cast<double>(rows) * (h + kGap);
  y = draw_legend(svg, entries_of(panels_), y, width);

  const std::string size = "width=\"" + number(width) + "\" height=\"" + number(y + kEdge) + "\"";
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" " +
         size + " viewBox=\"0 0 " + number(width) + " " + number(y + kEdge) +
         "\" font-family=\"Helvetica, Arial, sans-serif\">\n<title>" + escape(title_) +
         "</title>\n<rect " + size + " fill=\"#ffffff\"/>\n" + svg.shapes() + "</svg>\n";
}

Status Figure::write_file(const std::string& path) const {
  return handrail::write_file(path, svg());
}

}  // namespace handrail::figure
