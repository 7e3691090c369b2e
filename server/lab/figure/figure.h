// A figure: panels in a grid under a title, with one legend, as an SVG 1.1 file.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/lab/figure/panel.h"

namespace handrail::figure {

struct FigureOptions {
  std::size_t columns = 2;      // at least 1
  double panel_width = 340.0;   // margins included, 120 or more [px]
  double panel_height = 270.0;  // margins included, 120 or more [px]
};

class Figure {
 public:
  // `subtitle`: one line on where the data come from; it is wrapped when too long, as the title is.
  Figure(std::string title, std::string subtitle, const FigureOptions& options = {});

  // From left to right, then down.
  void add(Panel panel) { panels_.push_back(std::move(panel)); }
  // The same text for the same contents.
  std::string svg() const;
  // Writes or replaces the file. The error names the path and says why.
  Status write_file(const std::string& path) const;

 private:
  std::string title_, subtitle_;
  FigureOptions options_;
  std::vector<Panel> panels_;
};

}  // namespace handrail::figure
