#include "server/lab/contact/bumper_map.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "server/base/units.h"
#include "server/lab/study/parallel.h"

namespace handrail {
namespace {

constexpr double kStiffnesses[] = {1, 3, 10, 20, 40, 60, 90, 100, 110, 200, 300, 1000};  // [N/mm]
constexpr double kSpeeds[] = {1, 3, 10, 30, 100, 250};                                   // [mm/s]
constexpr double kDelays[] = {0, 5, 10, 20, 35, 50};                                     // [ms]
constexpr double kFrictions[] = {0.0, 0.3};
constexpr double kServoLag = 0.045;      // [s]
constexpr double kStiffestOnRig = 60e3;  // [N/m]
constexpr int kPushes = 8;

std::string name_of(const BumperMapOptions& options) {
  if (options.promise > 0.0) return fmt::format("at most {:g} N", options.promise);
  return options.form == BumperSettings::Form::kPublished ? "published" : "default";
}
const char* arm_of(const BumperMap& map) { return map.options.rig ? "rig" : "rigid"; }

std::vector<BumperCase> cases_of(const BumperMapOptions& options) {
  std::vector<BumperCase> out;
  for (const double friction : kFrictions) {
    for (const double stiffness : kStiffnesses) {
      if (options.rig && stiffness * kNewtonPerMm > kStiffestOnRig) continue;
      for (const double speed : kSpeeds) {
        for (const double delay : kDelays) {
          BumperCase of;
          of.stiffness = stiffness * kNewtonPerMm;
          of.speed = speed * kMm;
          of.delay = delay * 1e-3;
          of.friction = friction;
          of.servo_lag = options.rig ? kServoLag : 0.0;
          of.noise = options.noise;
          out.push_back(of);
        }
      }
    }
  }
  return out;
}

BumperCell push_all(const BumperMapOptions& options, const BumperCase& of) {
  BumperSettings settings;
  settings.form = options.form;
  settings.noise = options.noise;
  settings.contact = std::max(settings.contact, 5.0 * options.noise);
  settings.promise = options.promise;
  settings.stiffest =
      options.promise > 0.0 ? of.stiffness : std::max(settings.stiffest, of.stiffness);
  BumperCell cell;
  cell.of = of;
  cell.bound = peak_bound(settings, of);
  if (options.promise > 0.0) cell.bound = std::min(cell.bound, options.promise);
  cell.worst.released = true;
  cell.worst.share = 1e9;
  for (int i = 0; i < kPushes; ++i) {
    BumperCase push = of;
    push.slanted = (i & 1) != 0;
    push.gentle = (i & 2) != 0;
    push.late_sensor = (i & 4) != 0;
    const BumperRun run = run_bumper(settings, push);
    BumperRun& worst = cell.worst;
    if (run.peak > worst.peak) worst.settled = run.settled;
    worst.inward = std::max(worst.inward, run.inward);
    worst.peak = std::max(worst.peak, run.peak);
    worst.swing = std::max(worst.swing, run.swing);
    // A gentle push ends so near that an arm with lag slows before it touches.
    if (!push.gentle) worst.share = std::min(worst.share, run.share);
    worst.hops = std::max(worst.hops, run.hops);
    worst.released = worst.released && run.released;
  }
  return cell;
}

// What a map came to at one friction.
struct MapSummary {
  int cells = 0, in = 0, swing = 0, peak = 0, held = 0, hop = 0;
  double inward = 0.0, most_swing = 0.0, over = 0.0, most = 0.0;
  double least_share = 1e9, median_share = 0.0;
  double onset = 0.0;  // softest surface that swings [N/m]; 0: none

  MapSummary(const BumperMap& map, double friction) {
    std::vector<double> shares;
    for (const BumperCell& cell : map.cells) {
      if (cell.of.friction != friction) continue;
      ++cells;
      in += cell.goes_in();
      swing += cell.swings();
      peak += cell.peaks();
      held += !cell.worst.released;
      hop += cell.worst.hops > 0;
      inward = std::max(inward, cell.worst.inward);
      most_swing = std::max(most_swing, cell.worst.swing);
      over = std::max(over, cell.worst.peak / cell.bound);
      most = std::max(most, cell.worst.peak);
      shares.push_back(cell.worst.share);
      if (cell.swings() && (onset == 0.0 || cell.of.stiffness < onset)) onset = cell.of.stiffness;
    }
    if (shares.empty()) return;
    std::sort(shares.begin(), shares.end());
    least_share = shares.front();
    median_share = shares[shares.size() / 2];
  }
};

}  // namespace

BumperMap run_bumper_map(const BumperMapOptions& options) {
  const std::vector<BumperCase> cases = cases_of(options);
  BumperMap map{options, std::vector<BumperCell>(cases.size())};
  const bool all = run_parallel(
      cases.size(), options.threads,
      [&](std::size_t i) { map.cells[i] = push_all(options, cases[i]); }, options.progress,
      options.cancelled);
  if (!all) map.cells.clear();
  return map;
}

bool keeps_all(const BumperMap& map) {
  const auto good = [](const BumperCell& cell) { return cell.good(); };
  return std::all_of(map.cells.begin(), map.cells.end(), good);
}

std::string bumper_json(const std::vector<BumperMap>& maps) {
  std::string out = "{\"maps\": [";
  for (const BumperMap& map : maps) {
    const bool published = map.options.form == BumperSettings::Form::kPublished;
    out += fmt::format(
        "{}\n {{\"arm\": \"{}\", \"form\": \"{}\", \"promise_n\": {:g}, \"noise_n\": {:g}, "
        "\"summary\": [",
        &map == maps.data() ? "" : ",", arm_of(map), published ? "published" : "default",
        map.options.promise, map.options.noise);
    for (const double friction : kFrictions) {
      const MapSummary s(map, friction);
      out += fmt::format(
          "{}\n  {{\"friction\": {:g}, \"cells\": {}, \"inward\": {}, \"swinging\": {}, "
          "\"over_bound\": {}, \"not_released\": {}, \"hopping\": {}, \"worst_inward_mm\": {:.6g}, "
          "\"worst_swing_n\": {:.6g}, \"worst_peak_share\": {:.6g}, \"worst_peak_n\": {:.6g}, "
          "\"least_speed_share\": {:.6g}, \"median_speed_share\": {:.6g}, \"onset_n_mm\": {:g}}}",
          friction == kFrictions[0] ? "" : ",", friction, s.cells, s.in, s.swing, s.peak, s.held,
          s.hop, s.inward / kMm, s.most_swing, s.over, s.most, s.least_share, s.median_share,
          s.onset / kNewtonPerMm);
    }
    out += "],\n \"cells\": [";
    for (const BumperCell& c : map.cells) {
      out += fmt::format(
          "{}\n  {{\"stiffness_n_mm\": {:g}, \"speed_mm_s\": {:g}, \"delay_ms\": {:g}, "
          "\"friction\": {:g}, \"peak_n\": {:.6g}, \"bound_n\": {:.6g}, \"inward_mm\": {:.6g}, "
          "\"swing_n\": {:.6g}, \"settled_n\": {:.6g}, \"speed_share\": {:.6g}, \"hops\": {}, "
          "\"ok\": {}}}",
          &c == map.cells.data() ? "" : ",", c.of.stiffness / kNewtonPerMm, c.of.speed / kMm,
          c.of.delay * 1e3, c.of.friction, c.worst.peak, c.bound, c.worst.inward / kMm,
          c.worst.swing, c.worst.settled, c.worst.share, c.worst.hops, c.good());
    }
    out += "]}";
  }
  return out + "\n]}\n";
}

std::string bumper_table(const std::vector<BumperMap>& maps) {
  std::string out = fmt::format("  {:<6}{:<15}{:>8}{:>7}{:>16}{:>16}{:>10}{:>16}{:>10}{:>9}{:>6}\n",
                                "arm", "form", "friction", "cells", "inward, mm", "swing, N",
                                "onset", "over the bound", "speed", "not free", "hops");
  for (const BumperMap& map : maps) {
    for (const double friction : kFrictions) {
      const MapSummary s(map, friction);
      out += fmt::format(
          "  {:<6}{:<15}{:>8g}{:>7}{:>16}{:>16}{:>10}{:>16}{:>10}{:>9}{:>6}\n", arm_of(map),
          name_of(map.options), friction, s.cells, fmt::format("{} ({:.3g})", s.in, s.inward / kMm),
          fmt::format("{} ({:.3g})", s.swing, s.most_swing),
          s.onset > 0.0 ? fmt::format("{:g} N/mm", s.onset / kNewtonPerMm) : "none",
          map.options.promise > 0.0 ? fmt::format("{} ({:.4g} N)", s.peak, s.most)
                                    : fmt::format("{} (x{:.3g})", s.peak, s.over),
          map.options.promise > 0.0
              ? fmt::format("{:.0f}/{:.0f} %", 100.0 * s.least_share, 100.0 * s.median_share)
              : "",
          s.held, s.hop);
    }
  }
  return out +
         "\n  Cells that fail, and the worst of all. inward: a step into the surface with more "
         "than "
         "f_th\n  measured; swing: over 2 N peak to peak in the last second of a hold; onset: the "
         "softest\n  surface with it; the bound: f_th + k v (D + 2.5 T), and the force that "
         "`approach` "
         "promises to\n  one that knows the stiffness; speed: least and median at the touch, of "
         "what "
         "the command or\n  that promise allows. Worst of eight pushes a cell: straight or "
         "slanted, "
         "hard or gentle,\n  late command or late sensor.\n";
}

}  // namespace handrail
