#include "server/lab/study/linear_drawing.h"

#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <system_error>

#include "server/base/units.h"
#include "server/lab/figure/figure.h"
#include "server/lab/study/linear_figure.h"

namespace handrail {
namespace {

using figure::Axis;
using figure::Box;
using figure::Figure;
using figure::Panel;
using figure::Point;

std::string origin_of(const StudyHeader& header) {
  return fmt::format(
      "Simulated operators ({}, seed {}), simulated device and arm; fitted to the published NV "
      "medians only",
      header.operators, header.seed);
}

Panel measure_panel(const StudyResult& study, LinearFigure measure) {
  const LinearFigureInfo& info = info_of(measure);
  Axis modes;
  modes.categories = {"NV: without tools", "V: with tools"};
  Axis values;
  values.label = fmt::format("{} [{}]", info.title, info.unit);
  values.low = 0.0;
  Panel panel("", modes, values);
  for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
    const auto index = static_cast<int>(mode);
    Box box;
    box.at = index + 1.0;
    box.style = figure::style_of(static_cast<std::size_t>(index));
    box.values = pooled(values_of(study, mode, measure));
    for (double& value : box.values) value *= info.per_si;
    box.published =
        figure::Published{info.published[index], fmt::format("{:.4g}", info.published[index]),
                          "published median, 7 people"};
    panel.box(std::move(box));
  }
  return panel;
}

// The tip seen from one side: `across` to the right, `up` upward [mm].
Panel path_panel(const std::string& title, const LinearTask& task, const TrialResult& trial,
                 const Vec3& across, const Vec3& up, const std::string& x, const std::string& y) {
  Axis x_axis, y_axis;
  x_axis.label = x + " [mm]";
  y_axis.label = y + " [mm]";
  Panel panel(title, x_axis, y_axis);
  panel.use_equal_scale();
  const auto seen = [&](const Vec3& p) { return Point{p.dot(across) / kMm, p.dot(up) / kMm}; };
  panel.line({seen(task.p_SA), seen(task.p_SB), seen(task.p_SC)}, figure::kReferenceStyle,
             "desired");
  std::vector<Point> path;
  for (const TracePoint& point : trial.trace) path.push_back(seen(point.p_ST));
  figure::Style style = figure::style_of(0);
  style.dash = figure::Dash::kSolid;
  style.width = 1.0;
  panel.line(std::move(path), style, "tip");
  return panel;
}

const TrialResult* first_traced(const StudyResult& study, StudyMode mode) {
  for (const StudyTrial& trial : study.trials) {
    if (trial.mode == mode && trial.result.end == TrialEnd::kDone && !trial.result.trace.empty()) {
      return &trial.result;
    }
  }
  return nullptr;
}

Figure measures_figure(const StudyHeader& header, const StudyResult& study) {
  Figure out("Linear movement with fixed orientation", origin_of(header));
  for (int i = 0; i < kPublishedFigures; ++i) {
    out.add(measure_panel(study, static_cast<LinearFigure>(i)));
  }
  return out;
}

Figure trajectories_figure(const StudyHeader& header, const StudyResult& study,
                           const LinearTask& task) {
  Figure out("Desired and actual path of the tip, one operator", origin_of(header));
  for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
    const TrialResult* trial = first_traced(study, mode);
    if (trial == nullptr) continue;
    const std::string name = mode == StudyMode::kFree ? "NV, " : "V, ";
    out.add(path_panel(name + "as the operator sees it", task, *trial, -Vec3::UnitY(),
                       Vec3::UnitZ(), "to the right, -y", "up, z"));
    out.add(path_panel(name + "from above", task, *trial, -Vec3::UnitY(), Vec3::UnitX(),
                       "to the right, -y", "away, x"));
  }
  return out;
}

}  // namespace

Status make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Status::error(folder + ": cannot make the folder: " + error.message());
  return Status::ok();
}

Status draw_linear(const std::string& folder, const StudyHeader& header, const StudyResult& study,
                   const LinearTask& task) {
  if (Status s =
          measures_figure(header, study).write_file(folder + "/linear-movement-measures.svg");
      !s) {
    return s;
  }
  return trajectories_figure(header, study, task)
      .write_file(folder + "/linear-movement-trajectories.svg");
}

}  // namespace handrail
