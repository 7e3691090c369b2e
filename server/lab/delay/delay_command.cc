#include "server/lab/delay/delay_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>

#include "server/base/units.h"
#include "server/lab/console/console.h"
#include "server/lab/study/parallel.h"

namespace handrail {
namespace {

constexpr double kSurfaces[] = {50e3, 1e3};
// Stiffer than kDisplayed at the hand with room for the arm in series, mapping 1:2; the other one
// is softer than that [N/m].
constexpr double kRigid = 4.0 * kDisplayed;

// N/mm at the hand.
std::string stiffness_text(double n_m) { return fmt::format("{:.3f}", n_m / kNewtonPerMm); }

}  // namespace

std::vector<DelayCase> delay_cases(bool quick, std::uint64_t seed) {
  const std::vector<double> trips =
      quick ? std::vector<double>{0, 200, 1000} : std::vector<double>{0, 50, 100, 200, 500, 1000};
  std::vector<DelayCase> cases;
  const auto add = [&](double trip, double jitter, double loss) {
    for (const double stiffness : kSurfaces) {
      for (const bool local : {false, true}) {
        cases.push_back({stiffness, trip, jitter, loss, local, seed});
      }
    }
  };
  for (const double trip : trips) add(trip, 0.0, 0.0);
  if (quick) {
    add(1000.0, 100.0, 0.3);
    return cases;
  }
  for (const double trip : trips) {
    if (trip >= 200.0) add(trip, 100.0, 0.0);
    add(trip, 0.0, 0.3);
    if (trip >= 200.0) add(trip, 100.0, 0.3);
  }
  return cases;
}

bool reaches(const DelayCell& cell) {
  const DelayFigures& f = cell.figures;
  if (!f.engaged || f.ended || !f.stable()) return false;
  const TouchFigures& second = f.touch[1];
  return cell.of.stiffness < kRigid ||
         (second.felt >= kDisplayed && second.drift <= kDrift && f.off_mm <= kDrift);
}

std::string delay_table(const std::vector<DelayCell>& cells) {
  std::string out = fmt::format(
      "  {:>7}{:>6}{:>7}{:>6}  {:<7}|{:>7}{:>7}{:>7}{:>7}{:>8} |{:>7}{:>7}{:>7}{:>7}{:>8} "
      "|{:>6}{:>6}  "
      "{}\n",
      "surface", "trip", "jitter", "loss", "by", "felt", "held", "error", "drift", "swing", "felt",
      "held", "error", "drift", "swing", "off", "holds", "");
  for (const DelayCell& c : cells) {
    const DelayFigures& f = c.figures;
    out += fmt::format("  {:>7g}{:>6g}{:>7g}{:>6g}  {:<7}", c.of.stiffness / kNewtonPerMm,
                       c.of.round_trip_ms, c.of.jitter_ms, 100.0 * c.of.loss,
                       c.of.local ? "model" : "spring");
    for (const TouchFigures& t : f.touch) {
      out += fmt::format("|{:>7}{:>7}{:>7.2f}{:>7.2f}{:>8.3f} ", stiffness_text(t.felt),
                         stiffness_text(t.held), t.error, t.drift, t.swing);
    }
    out += fmt::format("|{:>6.2f}{:>5.1f}%  {}{}\n", f.off_mm, 100.0 * f.held_share,
                       !f.engaged   ? "did not engage"
                       : f.ended    ? "ended"
                       : f.stable() ? "stable"
                                    : "swings",
                       c.of.local && f.stable() && !reaches(c) ? ", below what is asked" : "");
  }
  return out +
         "\n  Surface and stiffnesses in N/mm, at the hand; round trip and jitter in ms, loss in "
         "%. First "
         "and\n  second touch: felt, in its first second; held, in the last of a hold; error, of "
         "the "
         "force on the\n  hand against the true surface rendered there (rms, N); drift of the "
         "command "
         "(mm at the tip);\n  swing of the force (N). off: of the tip from the hand, after both "
         "(mm); "
         "holds: of the time.\n  Asked of the model: 0.1 N of swing; of 50 N/mm, at the second "
         "touch, "
         "0.5 N/mm and 0.5 mm.\n  Simulated hand, device and arm.\n";
}

std::string delay_json(const std::vector<DelayCell>& cells) {
  std::string out;
  for (const DelayCell& c : cells) {
    const DelayFigures& f = c.figures;
    out += fmt::format(
        "{{\"surface_n_mm\": {:g}, \"round_trip_ms\": {:g}, \"jitter_ms\": {:g}, \"loss\": {:g}, "
        "\"local\": {}, \"engaged\": {}, \"ended\": {}, \"true_n_mm\": {:.6g}, \"touches\": [",
        c.of.stiffness / kNewtonPerMm, c.of.round_trip_ms, c.of.jitter_ms, c.of.loss, c.of.local,
        f.engaged, f.ended, f.true_stiffness / kNewtonPerMm);
    for (const TouchFigures& t : f.touch) {
      out += fmt::format(
          "{}{{\"felt_n_mm\": {:.6g}, \"held_n_mm\": {:.6g}, \"error_n\": {:.6g}, \"drift_mm\": "
          "{:.6g}, \"swing_n\": {:.6g}}}",
          &t == &f.touch[0] ? "" : ", ", t.felt / kNewtonPerMm, t.held / kNewtonPerMm, t.error,
          t.drift, t.swing);
    }
    out += fmt::format(
        "], \"off_mm\": {:.6g}, \"held_share\": {:.6g}, \"stable\": {}, \"reaches\": {}}}\n",
        f.off_mm, f.held_share, f.stable(), reaches(c));
  }
  return out;
}

int run_delay_command(const DelayCommand& command, const std::atomic<bool>& cancelled) {
  std::vector<DelayCell> cells;
  for (const DelayCase& of : delay_cases(command.quick, command.seed)) cells.push_back({of, {}});
  Progress progress;
  const bool done = run_parallel(
      cells.size(), command.threads,
      [&](std::size_t i) { cells[i].figures = measure_delay(cells[i].of); },
      [&](std::size_t n) { progress.show(fmt::format("{} of {} cells", n, cells.size())); },
      &cancelled);
  progress.clear();
  if (!done) return complain(Status::error("cancelled"), kCancelled);
  std::fputs((command.json ? delay_json(cells) : delay_table(cells)).c_str(), stdout);
  const bool all = std::all_of(cells.begin(), cells.end(), [](const DelayCell& cell) {
    return !cell.of.local || reaches(cell);
  });
  return all ? kDone : kFailed;
}

}  // namespace handrail
