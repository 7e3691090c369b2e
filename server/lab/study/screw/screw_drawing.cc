#include "server/lab/study/screw/screw_drawing.h"

#include <spdlog/fmt/fmt.h>

#include <numbers>
#include <utility>

#include "server/base/units.h"
#include "server/lab/figure/figure.h"
#include "server/lab/study/screw/screw_figure.h"
#include "server/lab/study/study_drawing.h"

namespace handrail {
namespace {

using figure::Axis;
using figure::Dash;
using figure::Figure;
using figure::Panel;
using figure::Point;
using figure::Style;

constexpr const char* kImpliedMedians = "the medians implied for NC-NV";
constexpr ScrewMode kModes[] = {ScrewMode::kNCNV, ScrewMode::kNCV, ScrewMode::kCNV, ScrewMode::kCV};

// In words, below an axis or above a panel.
const char* words_of(ScrewMode mode) {
  constexpr const char* kWords[kScrewModes] = {"NC-NV: neither", "NC-V: tools", "C-NV: protection",
                                               "C-V: both"};
  return kWords[static_cast<int>(mode)];
}

Style thin(std::size_t index, Dash dash = Dash::kSolid) {
  Style style = figure::style_of(index);
  style.dash = dash;
  style.width = 1.0;
  return style;
}

// What is compared stands on the same axes.
Figure with_shared_axes(Figure figure, std::vector<Panel> panels) {
  share_axes(figure::each(panels));
  for (Panel& panel : panels) figure.add(std::move(panel));
  return figure;
}

Figure measures_figure(const StudyHeader& header, const ScrewStudy& study) {
  Figure out("Screw fastening", origin_of(header, kImpliedMedians));
  for (int i = 0; i < kComparedFigures; ++i) {
    const auto figure = static_cast<ScrewFigure>(i);
    const ScrewFigureInfo& info = info_of(figure);
    std::vector<std::string> names;
    std::vector<ByPerson> values;
    for (const ScrewMode mode : kModes) {
      names.push_back(words_of(mode));
      values.push_back(values_of(study, mode, figure));
    }
    out.add(measure_panel(info.title, info.unit, info.per_si, names, std::move(values),
                          info.implied, "implied",
                          "implied by the dissertation's savings, 7 people"));
  }
  return out;
}

// The tip seen from the operator's left, who looks along `away`: places about the centre of the
// rim, in the plane of the line of sight and the screw's axis [mm].
class SideView {
 public:
  explicit SideView(const HexSocketSpec& socket)
      : rim_(socket.X_SK.p), up_(socket.X_SK.q * Vec3::UnitZ()) {
    const Vec3 sight = Vec3::UnitX();
    const Vec3 across = sight - sight.dot(up_) * up_;
    away_ = across.norm() > 1e-3 ? Vec3(across.normalized()) : Vec3(Vec3::UnitY());
  }
  Point operator()(const Vec3& p_S) const {
    return {(p_S - rim_).dot(away_) / kMm, (p_S - rim_).dot(up_) / kMm};
  }

 private:
  Vec3 rim_, up_, away_;
};

// A cut through plate and socket, across the socket's corners [mm].
std::vector<Point> profile(const HexSocketSpec& socket) {
  const double corner = socket.across_flats / std::numbers::sqrt3 / kMm;
  const double rim = corner + socket.chamfer / kMm;
  const double plate = 3.0 * corner;
  const double depth = socket.depth / kMm, chamfer = socket.chamfer / kMm;
  return {{-plate, 0.0},    {-rim, 0.0},        {-corner, -chamfer}, {-corner, -depth},
          {corner, -depth}, {corner, -chamfer}, {rim, 0.0},          {plate, 0.0}};
}

Panel path_panel(ScrewMode mode, const ScrewResult& trial, const HexSocketSpec& socket) {
  Axis x, y;
  x.label = "away from the operator [mm]";
  y.label = "along the screw [mm]";
  Panel panel(words_of(mode), x, y);
  panel.use_equal_scale();
  const SideView seen(socket);
  std::vector<Point> path;
  for (const ScrewTracePoint& point : trial.trace) path.push_back(seen(point.p_ST));
  panel.line(profile(socket), figure::kReferenceStyle, "socket, cut");
  if (!path.empty()) {
    panel.mark(path.front(), "start");
    panel.mark(path.back(), "end");
  }
  panel.line(std::move(path), thin(0), "tip");
  return panel;
}

Figure trajectories_figure(const StudyHeader& header, const ScrewStudy& study,
                           const HexSocketSpec& socket) {
  Figure out("Path of the key's tip, one operator", origin_of(header, kImpliedMedians));
  std::vector<Panel> panels;
  for (const ScrewMode mode : kModes) {
    const ScrewResult* trial = first_traced(study, mode);
    if (trial != nullptr) panels.push_back(path_panel(mode, *trial, socket));
  }
  return with_shared_axes(std::move(out), std::move(panels));
}

// The force along the screw, of the contact or the virtual spring, without protection and with.
Panel force_panel(const ScrewStudy& study, const HexSocketSpec& socket, bool tools,
                  Vec3 ScrewTracePoint::*force, const char* label) {
  Axis x, y;
  x.label = "time [s]";
  y.label = label;
  Panel panel(tools ? "with tools" : "without tools", x, y);
  const Vec3 up = socket.X_SK.q * Vec3::UnitZ();
  std::size_t index = 0;
  for (const ScrewMode mode : kModes) {
    if (has_tools(mode) != tools) continue;
    const Style style = thin(index++);
    const ScrewResult* trial = first_traced(study, mode);
    if (trial == nullptr) continue;
    std::vector<Point> line;
    for (const ScrewTracePoint& point : trial->trace) {
      line.push_back({point.time - trial->trace.front().time, (point.*force).dot(up)});
    }
    panel.line(std::move(line), style, has_protection(mode) ? "C: protected" : "NC: unprotected");
  }
  return panel;
}

Figure forces_figure(const StudyHeader& header, const ScrewStudy& study,
                     const HexSocketSpec& socket) {
  Figure out("Forces along the screw, one operator", origin_of(header, kImpliedMedians));
  for (const auto& [force, label] :
       {std::pair{&ScrewTracePoint::contact, "contact, on the tip [N]"},
        std::pair{&ScrewTracePoint::spring, "virtual spring, on the hand [N]"}}) {
    std::vector<Panel> panels;
    for (const bool tools : {false, true}) {
      panels.push_back(force_panel(study, socket, tools, force, label));
    }
    out = with_shared_axes(std::move(out), std::move(panels));
  }
  return out;
}

}  // namespace

Status draw_screw(const std::string& folder, const StudyHeader& header, const ScrewStudy& study,
                  const HexSocketSpec& socket) {
  const std::string start = folder + "/screw-fastening-";
  if (Status s = measures_figure(header, study).write_file(start + "measures.svg"); !s) return s;
  const bool traced = std::any_of(study.trials.begin(), study.trials.end(),
                                  [](const auto& trial) { return !trial.result.trace.empty(); });
  if (!traced) return Status::ok();
  if (Status s = trajectories_figure(header, study, socket).write_file(start + "trajectories.svg");
      !s) {
    return s;
  }
  return forces_figure(header, study, socket).write_file(start + "forces.svg");
}

}  // namespace handrail
