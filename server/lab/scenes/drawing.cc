#include "server/lab/scenes/drawing.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>

#include "server/lab/figure/figure.h"

namespace handrail {
namespace {

using figure::Figure;
using figure::Panel;
using figure::Point;
using figure::Style;

// Words of a choice's figure.
struct Words {
  const char* choice;
  const char* title;
  const char* cost;
  const char* error;
};
constexpr Words kWords[] = {
    {"wall", "Walls: pixel, search radius and method", "time of one update",
     "distance of the proxy from the true wall"},
    {"tool_step", "Position tools: Algorithm 2 and the closed form", "time of one update",
     "distance of the proxy from the exact one"},
    {"smoother", "Smoother: tremor left against lag", "lag", "tremor left"},
    {"integrator", "Integrator of hand and contact", "time for 1 ms of motion",
     "error of the position"},
    {"haptic_rate", "Rate of the haptic loop, at a wall of 5 N/mm", "time of the steps",
     "error of the force"},
    {"link_rate", "Rate of the link", "time of the codec", "error of the command held"},
};

Words words_of(const std::string& choice) {
  for (const Words& w : kWords) {
    if (choice == w.choice) return w;
  }
  return {"", "", "cost", "error"};
}

// Rounding: less than this share of the largest error is drawn as none.
constexpr double kNothing = 1e-9;

struct ErrorScale {
  double least = 1.0;  // that is not nothing
  double nothing = 0.0;

  explicit ErrorScale(const AccuracyRows& rows) {
    for (const AccuracyRow& row : rows) nothing = std::max(nothing, kNothing * row.error.rms);
    bool any = false;
    for (const AccuracyRow& row : rows) {
      if (row.error.rms <= nothing) continue;
      least = any ? std::min(least, row.error.rms) : row.error.rms;
      any = true;
    }
  }
  double none() const { return least / 3.0; }
  bool any_exact(const AccuracyRows& rows) const {
    return std::any_of(rows.begin(), rows.end(), [&](const AccuracyRow& r) { return exact(r); });
  }
  bool exact(const AccuracyRow& row) const { return row.error.rms <= nothing; }
  // What is nothing stands at the axis's place for it: a logarithmic axis has no zero.
  double place(const AccuracyRow& row) const { return exact(row) ? none() : row.error.rms; }
};

// A setting in few letters.
std::string label_of(const AccuracyRow& row) {
  std::string out = row.setting;
  for (const std::string word : {"pixel ", "radius ", "step ", "delta "}) {
    const std::size_t at = out.find(word);
    if (at != std::string::npos) out.erase(at, word.size());
  }
  return out;
}

Figure figure_of(const AccuracyRows& rows) {
  const ErrorScale errors(rows);
  const auto place = [&errors](const AccuracyRow& row) {
    return Point{row.cost.median, errors.place(row)};
  };
  figure::FigureOptions options;
  options.columns = 1;
  options.panel_width = 640.0;
  options.panel_height = 430.0;
  const Words words = words_of(rows[0].choice);
  Figure out(
      words.title,
      "Measured on this machine, settings in turn. Error: root mean square against the exact "
      "answer. Dashed: the efficient settings.",
      options);
  const bool lag = rows[0].cost.unit == "ms";
  figure::Axis y = {.label = fmt::format("{} [{}]", words.error, rows[0].error.unit),
                    .scale = figure::Scale::kLog};
  if (errors.any_exact(rows)) y.none = errors.none();
  Panel panel("",
              {.label = fmt::format("{} [{}]", words.cost, rows[0].cost.unit),
               .scale = lag ? figure::Scale::kLinear : figure::Scale::kLog},
              y);
  std::vector<std::string> methods;
  for (const AccuracyRow& row : rows) {
    if (std::find(methods.begin(), methods.end(), row.method) == methods.end()) {
      methods.push_back(row.method);
    }
  }
  const std::vector<bool> best = efficient(rows);
  std::vector<Point> frontier;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (best[i] && rows[i].needs.empty()) frontier.push_back(place(rows[i]));
  }
  std::sort(frontier.begin(), frontier.end(),
            [](const Point& a, const Point& b) { return a.x < b.x; });
  Style dashed = figure::kReferenceStyle;
  dashed.marker = figure::Marker::kNone;
  panel.line(frontier, dashed, "efficient");
  for (std::size_t k = 0; k < methods.size(); ++k) {
    std::vector<Point> points;
    for (const AccuracyRow& row : rows) {
      if (row.method == methods[k]) points.push_back(place(row));
    }
    panel.points(std::move(points), figure::style_of(k), methods[k]);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!best[i]) continue;
    panel.note(place(rows[i]), label_of(rows[i]) + (errors.exact(rows[i]) ? ": no error" : ""));
  }
  out.add(std::move(panel));
  return out;
}

}  // namespace

Status draw_accuracy(const std::string& folder, const AccuracyRows& rows) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Status::error(folder + ": cannot make the folder: " + error.message());
  for (auto first = rows.begin(); first != rows.end();) {
    const auto last = std::find_if(
        first, rows.end(), [&](const AccuracyRow& row) { return row.choice != first->choice; });
    const std::string file = folder + "/accuracy-" + first->choice + ".svg";
    if (Status s = figure_of(AccuracyRows(first, last)).write_file(file); !s) return s;
    first = last;
  }
  return Status::ok();
}

}  // namespace handrail
