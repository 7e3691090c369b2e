#include "server/lab/walls/wall_report_io.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "proto/wall_study.pb.h"
#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/lab/study/statistics.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

// Decimals of a JSON number: no more digits than the simulation means.
double rounded(double value) { return std::round(value * 1e6) / 1e6; }

// Of one quantity, the largest of all people.
template <typename Person>
double largest(const std::vector<Person>& people, double WallRunResult::*field) {
  double most = 0.0;
  for (const Person& person : people) most = std::max(most, person.*field);
  return most;
}

template <typename Person>
std::vector<double> all(const std::vector<Person>& people, double WallRunResult::*field) {
  std::vector<double> out;
  for (const Person& person : people) out.push_back(person.*field);
  return out;
}

// Medians over those who made that many turns.
std::vector<double> medians(const std::vector<WrenchResult>& people, double WrenchTurn::*field) {
  std::vector<double> out;
  for (std::size_t turn = 0;; ++turn) {
    std::vector<double> values;
    for (const WrenchResult& person : people) {
      if (turn < person.turns.size()) values.push_back(person.turns[turn].*field);
    }
    if (values.empty()) return out;
    out.push_back(median(values));
  }
}

void fill(const WallAnalogue& in, pb::Analogue& out) {
  const Summary s = summarise(in.values);
  out.set_score(in.score);
  out.set_measured(in.measured);
  out.set_unit(in.unit);
  pb::Measure& values = *out.mutable_values();
  values.set_min(rounded(s.min));
  values.set_q1(rounded(s.q1));
  values.set_median(rounded(s.median));
  values.set_q3(rounded(s.q3));
  values.set_max(rounded(s.max));
  values.set_mean(rounded(s.mean));
  out.set_published_mean(in.published_mean);
  out.set_published_median(in.published_median);
}

std::string analogues_table(const std::vector<WallAnalogue>& analogues) {
  std::string out =
      "\nmeasured on simulated hands, which have no opinions, beside what eight people scored from "
      "1 to 5:\n";
  for (const WallAnalogue& a : analogues) {
    const Summary s = summarise(a.values);
    out += fmt::format("  {:<22}{:<52}{:8.3f} ({:.3f} to {:.3f}) {:<8}  scored {} / {}\n", a.score,
                       a.measured, s.median, s.min, s.max, a.unit, a.published_mean,
                       a.published_median);
  }
  return out + "  (median, smallest to largest; scores: mean / median)\n";
}

std::string joined(const std::vector<double>& values, const char* format) {
  std::string out;
  for (const double value : values) out += fmt::format(fmt::runtime(format), value);
  return out;
}

std::string whose(const WallHeader& header, std::size_t people) {
  if (!header.hand.empty()) return "recorded hand " + header.hand;
  return fmt::format("{} simulated hand{}, seed {}", people, people == 1 ? "" : "s", header.seed);
}

template <typename Person>
std::string forces_table(const std::vector<Person>& people) {
  return fmt::format(
      "  largest force           {:8.2f} N\n"
      "  deepest in a wall       {:8.2f} mm, {:.2f} of what energy allows\n"
      "  walls where aisles meet {:8.2f} of the local wall force\n",
      largest(people, &WallRunResult::most_force), largest(people, &WallRunResult::deepest) / kMm,
      largest(people, &WallRunResult::share_of_bound),
      largest(people, &WallRunResult::junction_ratio));
}

std::string walls_line(const WallHeader& header) {
  return header.walls.empty() ? "" : "walls: " + header.walls + '\n';
}

// The fields that both studies have.
template <typename Study>
void fill_header(const char* experiment, const WallHeader& header, std::size_t people, Study& out) {
  out.set_experiment(experiment);
  out.set_simulated(true);
  out.set_seed(header.seed);
  out.set_scene(header.scene);
  if (!header.hand.empty()) out.set_hand(header.hand);
  if (!header.walls.empty()) out.set_walls(header.walls);
  out.set_operators(static_cast<std::uint32_t>(people));
}
template <typename Person, typename Study>
void fill_forces(const std::vector<Person>& people, Study& out) {
  out.set_max_force_n(rounded(largest(people, &WallRunResult::most_force)));
  out.set_max_penetration_mm(rounded(largest(people, &WallRunResult::deepest) / kMm));
  out.set_penetration_share(rounded(largest(people, &WallRunResult::share_of_bound)));
  out.set_junction_ratio(rounded(largest(people, &WallRunResult::junction_ratio)));
}

}  // namespace

std::vector<WallAnalogue> analogues_of(const std::vector<WrenchResult>& people, int turns) {
  std::vector<WallAnalogue> out = {
      {"guidance", "share of the hand's way inside the aisles", "", 4.6, 5.0,
       all(people, &WallRunResult::inside_share)},
      {"tightening", "growth of the force peaks", "N/turn", 4.5, 4.5, {}},
      {"resemblance", "distance from the real wrench's 0 to 16 N", "N", 3.8, 4.0, {}}};
  for (const WrenchResult& person : people) {
    out[1].values.push_back(growth_of(person, turns));
    out[2].values.push_back(distance_from_real(person, turns));
  }
  return out;
}

std::vector<WallAnalogue> analogues_of(const std::vector<GearshiftResult>& people) {
  return {{"guidance", "share of the hand's way inside the aisles", "", 4.5, 4.5,
           all(people, &WallRunResult::inside_share)}};
}

std::string wrench_json(const WallHeader& header, const std::vector<WrenchResult>& people) {
  pb::WrenchStudy out;
  fill_header("wrench", header, people.size(), out);
  out.set_c(header.c);
  out.set_turns(static_cast<std::uint32_t>(header.turns));
  out.set_loosen(static_cast<std::uint32_t>(header.loosen));
  out.set_loop_s(kLoopTime);
  out.set_radius_mm(rounded(header.radius / kMm));
  for (const double peak : medians(people, &WrenchTurn::peak)) out.add_peaks_n(rounded(peak));
  for (const double alpha : medians(people, &WrenchTurn::alpha)) out.add_alpha_rad(rounded(alpha));
  fill_forces(people, out);
  if (people.size() > 1) {
    for (const auto& a : analogues_of(people, header.turns)) fill(a, *out.add_analogues());
  }
  for (const WrenchResult& person : people) {
    pb::WrenchPerson& p = *out.add_people();
    for (const WrenchTurn& turn : person.turns) {
      p.add_peaks_n(rounded(turn.peak));
      p.add_alpha_rad(rounded(turn.alpha));
    }
    p.set_max_force_n(rounded(person.most_force));
    p.set_max_penetration_mm(rounded(person.deepest / kMm));
    p.set_inside_share(rounded(person.inside_share));
  }
  return json_of_set_fields(out, true) + '\n';
}

std::string wrench_table(const WallHeader& header, const std::vector<WrenchResult>& people) {
  std::string out = fmt::format(
      "Omni-directional wrench, scene {}, c = {:g} N s/(m rad), {}, simulated joystick\n",
      header.scene, header.c, whose(header, people.size()));
  if (header.hand.empty()) {
    out += fmt::format(
        "guiding ball: a loop of {:.0f} mm radius and the straight way back every {:g} s, {} turns "
        "to tighten, {} to loosen\n",
        header.radius / kMm, kLoopTime, header.turns, header.loosen);
  }
  out += walls_line(header);
  out += "\n  turn                    ";
  const std::vector<double> peaks = medians(people, &WrenchTurn::peak);
  for (std::size_t i = 1; i <= peaks.size(); ++i) out += fmt::format("{:8}", i);
  out += "\n  force peak, N           " + joined(peaks, "{:8.2f}");
  out += "\n  angle turned, rad       " + joined(medians(people, &WrenchTurn::alpha), "{:8.2f}") +
         '\n';
  out += '\n' + forces_table(people);
  return people.size() > 1 ? out + analogues_table(analogues_of(people, header.turns)) : out;
}

std::string gearshift_json(const WallHeader& header, const std::vector<GearshiftResult>& people) {
  pb::GearStudy out;
  fill_header("gearshift", header, people.size(), out);
  for (const std::string& gear : people.front().visited) out.add_visited(gear);
  for (const GearEvent& event : people.front().events) {
    pb::GearEvent& e = *out.add_events();
    e.set_t_s(rounded(event.t));
    e.set_event(name_of(event.kind));
    e.set_gear(event.gear);
  }
  fill_forces(people, out);
  if (people.size() > 1) {
    for (const WallAnalogue& a : analogues_of(people)) fill(a, *out.add_analogues());
  }
  for (const GearshiftResult& person : people) {
    pb::GearPerson& p = *out.add_people();
    for (const std::string& gear : person.visited) p.add_visited(gear);
    p.set_max_force_n(rounded(person.most_force));
    p.set_max_penetration_mm(rounded(person.deepest / kMm));
    p.set_inside_share(rounded(person.inside_share));
    p.set_duration_s(rounded(person.duration));
  }
  return json_of_set_fields(out, true) + '\n';
}

std::string gearshift_table(const WallHeader& header, const std::vector<GearshiftResult>& people) {
  const GearshiftResult& first = people.front();
  std::string out = fmt::format("Manual gearshift, scene {}, {}, simulated joystick\n{}\n",
                                header.scene, whose(header, people.size()), walls_line(header));
  out += "  visited                 " + joined(first.visited, " ") + '\n';
  for (const GearEvent& event : first.events) {
    out += fmt::format("  {:8.2f} s  {:<8}{}\n", event.t, name_of(event.kind), event.gear);
  }
  const auto same = std::count_if(people.begin(), people.end(), [&](const GearshiftResult& p) {
    return p.visited == first.visited;
  });
  if (people.size() > 1) {
    out += fmt::format("  {} of {} visited the same\n", same, people.size());
  }
  out += forces_table(people);
  return people.size() > 1 ? out + analogues_table(analogues_of(people)) : out;
}

std::string trace_csv(const std::vector<WallTick>& trace) {
  std::string out =
      "t_s,x_mm,y_mm,proxy_x_mm,proxy_y_mm,ball_x_mm,ball_y_mm,handle_x_n,handle_y_n,"
      "device_x_n,device_y_n,turned_rad,touching,locked\n";
  for (const WallTick& k : trace) {
    out += fmt::format("{:.3f}", k.t);
    for (const Vec2& p : {k.hand, k.contact.proxy, k.ball}) {
      out += fmt::format(",{:.4f},{:.4f}", p.x() / kMm, p.y() / kMm);
    }
    for (const Vec2& f : {k.handle, k.device}) out += fmt::format(",{:.4f},{:.4f}", f.x(), f.y());
    out += fmt::format(",{:.5f},{:d},{:d}\n", k.turned, k.contact.touching, k.effects.locked);
  }
  return out;
}

}  // namespace handrail
