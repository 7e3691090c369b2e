#include <spdlog/fmt/fmt.h>

#include <map>
#include <utility>

#include "server/base/units.h"
#include "server/lab/contact/bumper_command.h"
#include "server/lab/figure/figure.h"

namespace handrail {
namespace {

using figure::Axis;
using figure::Marker;
using figure::Panel;
using figure::Point;
using figure::Scale;

// What the delays of a stiffness and a speed came to.
struct Mark {
  bool in = false, swing = false, peak = false;
};
using Marks = std::map<std::pair<double, double>, Mark>;

// Published above the place and default below it, so that both are seen.
constexpr double kBeside = 1.13;

Marks marks_of(const BumperMap& map, double friction) {
  Marks out;
  for (const BumperCell& c : map.cells) {
    if (c.of.friction != friction) continue;
    Mark& mark = out[{c.of.stiffness / kNewtonPerMm, c.of.speed / kMm}];
    mark.in |= c.goes_in();
    mark.swing |= c.swings();
    mark.peak |= c.peaks();
  }
  return out;
}

void add_map(Panel& panel, const BumperMap& map, double friction) {
  const bool published = map.options.form == BumperSettings::Form::kPublished;
  const double beside = published ? kBeside : 1.0 / kBeside;
  const std::string who = published ? "published" : "default";
  std::vector<Point> good, in, swing, peak;
  for (const auto& [place, mark] : marks_of(map, friction)) {
    const Point at{place.first, place.second * beside};
    if (mark.swing) swing.push_back(at);
    if (mark.in && !mark.swing) in.push_back(at);
    if (mark.peak && !mark.swing && !mark.in) peak.push_back(at);
    if (!mark.swing && !mark.in && !mark.peak) good.push_back(at);
  }
  const auto put = [&](std::vector<Point> points, Marker marker, const char* what) {
    if (points.empty()) return;
    const figure::Style style{.colour = figure::kColours[published ? 1 : 0],
                              .marker = marker,
                              .hollow = published && marker != Marker::kCross};
    panel.points(std::move(points), style, who + ": " + what);
  };
  put(std::move(good), Marker::kCircle, "keeps all");
  put(std::move(peak), Marker::kDiamond, "peak over its bound");
  put(std::move(in), Marker::kTriangle, "goes in above the threshold");
  put(std::move(swing), Marker::kCross, "swings");
}

}  // namespace

// The largest peak of a stiffness where the approach is slowed for a force.
void add_promise(Panel& panel, const BumperMap& map) {
  for (const double friction : {0.0, 0.3}) {
    std::map<double, double> peaks;
    for (const BumperCell& c : map.cells) {
      double& peak = peaks[c.of.stiffness / kNewtonPerMm];
      if (c.of.friction == friction) peak = std::max(peak, c.worst.peak);
    }
    std::vector<Point> points;
    for (const auto& [stiffness, peak] : peaks) points.push_back({stiffness, peak});
    const figure::Style style{.colour = figure::kColours[friction > 0.0 ? 3 : 2],
                              .marker = map.options.rig ? Marker::kTriangle : Marker::kCircle};
    panel.points(
        std::move(points), style,
        fmt::format("{} arm, friction {:g}", map.options.rig ? "rig's" : "rigid", friction));
  }
}

Status draw_bumper(const std::string& folder, const std::vector<BumperMap>& maps) {
  figure::Figure figure(
      "Bumper in contact, by stiffness and speed",
      "worst of six delays of 0 to 50 ms and eight pushes each; published above default");
  for (const bool rig : {false, true}) {
    for (const double friction : {0.0, 0.3}) {
      Panel panel(fmt::format("{}, friction {:g}", rig ? "45 ms of servo lag" : "rigid ideal arm",
                              friction),
                  Axis{.label = "stiffness [N/mm]", .scale = Scale::kLog},
                  Axis{.label = "speed [mm/s]", .scale = Scale::kLog});
      bool any = false;
      for (const BumperMap& map : maps) {
        if (map.options.rig != rig || map.options.promise > 0.0) continue;
        add_map(panel, map, friction);
        any = true;
      }
      if (any) figure.add(std::move(panel));
    }
  }
  std::map<double, Panel> promises;
  for (const BumperMap& map : maps) {
    const double force = map.options.promise;
    if (force <= 0.0) continue;
    Panel panel(fmt::format("approach for at most {:g} N", force),
                Axis{.label = "stiffness [N/mm]", .scale = Scale::kLog},
                Axis{.label = "largest force [N]"});
    Panel& of = promises.try_emplace(force, std::move(panel)).first->second;
    if (of.legend().empty()) of.reference(force, "promised");
    add_promise(of, map);
  }
  for (auto& [force, panel] : promises) figure.add(std::move(panel));
  return figure.write_file(folder + "/bumper-maps.svg");
}

}  // namespace handrail
