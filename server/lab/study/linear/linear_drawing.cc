#include "server/lab/study/linear/linear_drawing.h"

#include "server/base/units.h"
#include "server/lab/figure/figure.h"
#include "server/lab/study/linear/linear_figure.h"
#include "server/lab/study/study_drawing.h"

namespace handrail {
namespace {

using figure::Axis;
using figure::Figure;
using figure::Panel;
using figure::Point;

constexpr const char* kFitted = "the published NV medians";

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
  panel.mark(seen(task.p_SA), "A, start");
  panel.mark(seen(task.p_SB), "B");
  panel.mark(seen(task.p_SC), "C, end");
  std::vector<Point> path;
  for (const TracePoint& point : trial.trace) path.push_back(seen(point.p_ST));
  figure::Style style = figure::style_of(0);
  style.dash = figure::Dash::kSolid;
  style.width = 1.0;
  panel.line(std::move(path), style, "tip");
  return panel;
}

Figure measures_figure(const StudyHeader& header, const LinearStudy& study) {
  Figure out("Linear movement with fixed orientation", origin_of(header, kFitted));
  for (int i = 0; i < kPublishedFigures; ++i) {
    const auto figure = static_cast<LinearFigure>(i);
    const LinearFigureInfo& info = info_of(figure);
    out.add(measure_panel(
        info.title, info.unit, info.per_si, {"NV: without tools", "V: with tools"},
        {values_of(study, StudyMode::kFree, figure), values_of(study, StudyMode::kTools, figure)},
        info.published, "published", "published median, 7 people"));
  }
  return out;
}

Figure trajectories_figure(const StudyHeader& header, const LinearStudy& study,
                           const LinearTask& task) {
  Figure out("Desired and actual path of the tip, one operator", origin_of(header, kFitted));
  std::vector<Panel> seen, above;
  for (const StudyMode mode : {StudyMode::kFree, StudyMode::kTools}) {
    const TrialResult* trial = first_traced(study, mode);
    if (trial == nullptr) continue;
    const std::string name = mode == StudyMode::kFree ? "NV, " : "V, ";
    seen.push_back(path_panel(name + "as the operator sees it", task, *trial, -Vec3::UnitY(),
                              Vec3::UnitZ(), "to the right, -y", "up, z"));
    above.push_back(path_panel(name + "from above, the operator below", task, *trial,
                               -Vec3::UnitY(), Vec3::UnitX(), "to the right, -y", "away, x"));
  }
  share_axes(figure::each(seen));
  share_axes(figure::each(above));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    out.add(std::move(seen[i]));
    out.add(std::move(above[i]));
  }
  return out;
}

}  // namespace

Status draw_linear(const std::string& folder, const StudyHeader& header, const LinearStudy& study,
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
