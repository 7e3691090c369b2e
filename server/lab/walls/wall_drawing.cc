#include "server/lab/walls/wall_drawing.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "server/base/units.h"
#include "server/constraint/drawn/outline.h"
#include "server/lab/figure/figure.h"

namespace handrail {
namespace {

using figure::Axis;
using figure::Box;
using figure::Dash;
using figure::Figure;
using figure::FigureOptions;
using figure::Panel;
using figure::Point;
using figure::Style;

constexpr double kBesideAisle = 8.0;  // from a gear's place to free paper [mm]
constexpr std::size_t kEvery = 10;    // ticks between points drawn
constexpr Style kWallStyle = {.colour = figure::kInk, .width = 1.4, .dash = Dash::kSolid};

Style thin(std::size_t index) {
  Style style = figure::style_of(index);
  style.dash = Dash::kSolid;
  style.width = 1.1;
  return style;
}

std::string origin_of(const WallHeader& header, const std::string& whose) {
  const std::string hand =
      header.hand.empty()
          ? fmt::format("{}, seed {}", whose, header.seed)
          : "recorded hand " + std::filesystem::path(header.hand).filename().string();
  return fmt::format("Scene {}: {}, simulated joystick at 1 kHz", header.scene, hand);
}

std::string all_of(std::size_t people) { return fmt::format("{} simulated hands", people); }

// The border of drawn walls, piece by piece.
void draw_walls(const Walls& walls, Panel& panel) {
  constexpr double kStep = 0.5e-3;  // [m]
  if (walls.shapes.empty()) return;
  const Outline outline(walls.shapes, walls.fillet);
  for (int i = 0; i < outline.size(); ++i) {
    const OutlinePiece& piece = outline.piece(i);
    const int parts = piece.turn == 0 ? 1 : static_cast<int>(std::ceil(piece.size() / kStep));
    std::vector<Point> points;
    for (int k = 0; k <= parts; ++k) {
      const Vec2 p = piece.at(piece.size() * k / parts);
      points.push_back({p.x() / kMm, p.y() / kMm});
    }
    panel.line(std::move(points), kWallStyle, "wall");
  }
}

template <typename Of>
std::vector<Point> over_time(const std::vector<WallTick>& trace, Of of) {
  std::vector<Point> out;
  for (std::size_t i = 0; i < trace.size(); i += kEvery) out.push_back({trace[i].t, of(trace[i])});
  return out;
}

// The largest of every kEvery ticks, so that no peak is lost.
std::vector<Point> force_over_time(const std::vector<WallTick>& trace) {
  std::vector<Point> out;
  for (std::size_t i = 0; i < trace.size(); i += kEvery) {
    double most = 0.0;
    for (std::size_t k = i; k < std::min(i + kEvery, trace.size()); ++k) {
      most = std::max(most, trace[k].handle.norm());
    }
    out.push_back({trace[i].t, most});
  }
  return out;
}

Axis axis(const char* label) {
  Axis out;
  out.label = label;
  return out;
}

Panel plane_panel(const std::string& title, const Walls& walls,
                  const std::vector<WallTick>& trace) {
  Panel panel(title, axis("x [mm]"), axis("y [mm]"));
  panel.use_equal_scale();
  draw_walls(walls, panel);
  std::vector<Point> hand;
  for (std::size_t i = 0; i < trace.size(); i += kEvery) {
    hand.push_back({trace[i].hand.x() / kMm, trace[i].hand.y() / kMm});
  }
  if (!hand.empty()) panel.mark(hand.front(), "start");
  panel.line(std::move(hand), thin(0), "handle");
  return panel;
}

Panel time_panel(const std::string& title, const char* label, std::vector<Point> points,
                 std::size_t style, const char* name) {
  Panel panel(title, axis("t [s]"), axis(label));
  panel.line(std::move(points), thin(style), name);
  return panel;
}

Panel box_panel(const WallAnalogue& analogue, std::size_t index) {
  Axis who;
  who.categories = {"simulated hands"};
  const std::string unit = *analogue.unit == '\0' ? "" : fmt::format(" [{}]", analogue.unit);
  Axis values;
  values.label = std::string(analogue.measured) + unit;
  Panel panel(fmt::format("Measured beside \"{}\"", analogue.score), who, values);
  Box box;
  box.values = analogue.values;
  box.style = figure::style_of(index);
  panel.box(std::move(box));
  return panel;
}

Panel scores_panel(const std::vector<std::string>& names, const std::vector<double>& means,
                   const std::vector<double>& medians) {
  Axis questions;
  questions.categories = names;
  Axis scores;
  scores.label = "score, 1 to 5";
  scores.low = 1.0;
  scores.high = 5.2;
  Panel panel("Opinions of 8 people (Fig. 2.11)", questions, scores);
  std::vector<Point> mean_points, median_points;
  for (std::size_t i = 0; i < names.size(); ++i) {
    mean_points.push_back({static_cast<double>(i) + 1.0, means[i]});
    median_points.push_back({static_cast<double>(i) + 1.0, medians[i]});
  }
  // The mean is smaller and filled: where both are the same, the median's corners look out.
  panel.points(std::move(median_points), figure::kReferenceStyle, "published median score");
  panel.points(std::move(mean_points), figure::style_of(1), "published mean score");
  return panel;
}

Status write(const std::string& folder, const char* name, const Figure& figure) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Status::error(folder + ": cannot make the folder: " + error.message());
  return figure.write_file(folder + "/" + name);
}

double angle_at(const Vec2& arm) {
  const double angle = std::atan2(arm.y(), arm.x()) / kDeg;
  return angle < -90.0 ? angle + 360.0 : angle;
}

// Of the handle about the screw, counter-clockwise from x, -90 to 270 [deg]; on the straight way
// back, where it passes the screw itself, in proportion to the way.
double angle_of(const WallTick& tick, const Walls& walls, const WrenchPath& path) {
  const Vec2 arm = tick.hand - path.centre();
  if (!walls.regions[tick.contact.region].progressive) {
    const Vec2 across = (path.end() - path.begin()).normalized();
    const double begin = angle_at(path.begin() - path.centre());
    const double end = angle_at(path.end() - path.centre());
    const double share = 0.5 + 0.5 * arm.dot(across) / (path.radius() - 0.5 * path.width());
    return begin + std::clamp(share, 0.0, 1.0) * (end - begin);
  }
  return angle_at(arm);
}

constexpr const char* kFirst = "the first simulated hand";
constexpr const char* kPeopleTitle = "Measurements, not opinions, beside what people said";

}  // namespace

Status draw_wrench(const std::string& folder, const WallHeader& header, const Walls& walls,
                   const WrenchPath& path, const std::vector<WrenchResult>& people) {
  const std::vector<WallTick>& trace = people.front().trace;
  Figure out(fmt::format("Omni-directional wrench, c = {:g} N s/(m rad)", header.c),
             origin_of(header, kFirst));
  out.add(plane_panel("Aisles and way of the handle", walls, trace));
  out.add(time_panel("The screw", "angle turned [rad]",
                     over_time(trace, [](const WallTick& t) { return t.turned; }), 1,
                     "angle turned"));
  out.add(time_panel("The wrench about the screw", "angle of the handle [deg]",
                     over_time(trace, [&](const WallTick& t) { return angle_of(t, walls, path); }),
                     0, "handle"));
  out.add(time_panel("Force of the hand", "force on the handle [N]", force_over_time(trace), 2,
                     "force"));
  if (Status s = write(folder, "wrench.svg", out); !s || people.size() == 1) return s;

  Figure boxes(kPeopleTitle, origin_of(header, all_of(people.size())));
  std::size_t index = 0;
  for (const WallAnalogue& a : analogues_of(people, header.turns)) boxes.add(box_panel(a, index++));
  boxes.add(
      scores_panel({"guidance", "tightening", "resemblance"}, {4.6, 4.5, 3.8}, {5.0, 4.5, 4.0}));
  return write(folder, "wrench-people.svg", boxes);
}

Status draw_gearshift(const std::string& folder, const WallHeader& header, const Walls& walls,
                      const GearGate& gate, const std::vector<GearshiftResult>& people) {
  const std::vector<WallTick>& trace = people.front().trace;
  Figure out("Manual gearshift", origin_of(header, kFirst));
  Panel plane = plane_panel("Aisles and way of the lever", walls, trace);
  for (std::size_t i = 0; i < gate.places().size(); ++i) {
    const Point at{gate.places()[i].x() / kMm, gate.places()[i].y() / kMm};
    plane.points({at}, figure::kPlaceStyle);
    plane.note({at.x + kBesideAisle, at.y}, gate.names()[i]);
  }
  out.add(std::move(plane));
  out.add(time_panel("Lever along x", "x [mm]",
                     over_time(trace, [](const WallTick& t) { return t.hand.x() / kMm; }), 0,
                     "handle"));
  out.add(time_panel("Lever along y", "y [mm]",
                     over_time(trace, [](const WallTick& t) { return t.hand.y() / kMm; }), 0,
                     "handle"));
  out.add(time_panel("Force of the hand", "force on the handle [N]", force_over_time(trace), 2,
                     "force"));
  if (Status s = write(folder, "gearshift.svg", out); !s || people.size() == 1) return s;

  Figure boxes(kPeopleTitle, origin_of(header, all_of(people.size())));
  for (const WallAnalogue& a : analogues_of(people)) boxes.add(box_panel(a, 0));
  boxes.add(
      scores_panel({"guidance", "resemblance", "visual effect"}, {4.5, 3.5, 4.6}, {4.5, 3.5, 5.0}));
  return write(folder, "gearshift-people.svg", boxes);
}

}  // namespace handrail
