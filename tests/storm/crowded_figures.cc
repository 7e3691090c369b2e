// What the windows with and without a crowd show.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/storm/crowded.h"

namespace handrail::storm {

// The smallest value that so large a share is not above.
double at_share(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

namespace {

// What is to be shown.
constexpr double kStopIn = 10.0;   // [ms]
constexpr double kGrowsBy = 50.0;  // [us]

CrowdedFigures::Times times_of(const std::vector<double>& values) {
  return {values.size(), at_share(values, 0.5), at_share(values, 0.99), at_share(values, 0.999),
          at_share(values, 1.0)};
}

std::string in_words(const CrowdedFigures::Times& t) {
  return fmt::format("median {:.2f}, p99 {:.2f}, p99.9 {:.2f}, worst {:.2f} ms", t.median, t.p99,
                     t.p999, t.worst);
}

std::string in_json(const CrowdedFigures::Times& t) {
  return fmt::format(
      "{{\"count\": {}, \"median\": {:.3f}, \"p99\": {:.3f}, \"p999\": {:.3f}, \"worst\": {:.3f}}}",
      t.count, t.median, t.p99, t.p999, t.worst);
}

// One figure of the windows with the crowd, or without.
std::vector<double> of(const std::vector<CrowdedWindow>& windows, bool crowded,
                       double CrowdedWindow::*figure) {
  std::vector<double> out;
  for (const CrowdedWindow& w : windows) {
    if (w.crowded == crowded) out.push_back(w.*figure);
  }
  return out;
}

// How many of the smallest, and of the largest, of n values the median is beyond in at most 2.5 %
// of all samples.
std::size_t beyond_median(std::size_t n) {
  double chance = std::pow(0.5, static_cast<double>(n));  // that none is below the median
  double sum = chance;
  std::size_t count = 0;
  while (sum <= 0.025 && count < n) {
    ++count;
    chance *= static_cast<double>(n - count + 1) / static_cast<double>(count);
    sum += chance;
  }
  return count;
}

CrowdedFigures::Growth growth(const std::vector<CrowdedWindow>& windows,
                              double CrowdedWindow::*figure) {
  const auto without = of(windows, false, figure), with = of(windows, true, figure);
  std::vector<double> grows;
  for (std::size_t i = 0; i < std::min(with.size(), without.size()); ++i) {
    grows.push_back(with[i] - without[i]);
  }
  if (grows.empty()) return {};
  std::sort(grows.begin(), grows.end());
  const std::size_t n = grows.size(), beyond = beyond_median(n);
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  return {0.5 * (grows[(n - 1) / 2] + grows[n / 2]), beyond == 0 ? -kEndless : grows[beyond - 1],
          beyond == 0 ? kEndless : grows[n - beyond]};
}

}  // namespace

CrowdedFigures figures_of(const std::vector<CrowdedWindow>& windows) {
  std::vector<double> sent, taken, answered, calm;
  CrowdedFigures out;
  out.disk_held = true;
  for (const CrowdedWindow& w : windows) {
    const auto add = [](std::vector<double>& to, const std::vector<double>& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    if (!w.crowded) {
      add(calm, w.taken_ms);
      continue;
    }
    add(sent, w.sent_ms);
    add(taken, w.taken_ms);
    add(answered, w.answered_ms);
    out.disk_held = out.disk_held && w.disk_held;
    out.acts += w.acts;
    out.answers += w.answers;
  }
  out.sent = times_of(sent);
  out.taken = times_of(taken);
  out.answered = times_of(answered);
  out.calm_taken = times_of(calm);
  out.haptic = growth(windows, &CrowdedWindow::haptic_us);
  out.bare = growth(windows, &CrowdedWindow::bare_us);
  out.robot = growth(windows, &CrowdedWindow::robot_us);
  return out;
}

bool CrowdedFigures::reached() const {
  return disk_held && taken.count > 0 && taken.p999 <= kStopIn && haptic.median <= kGrowsBy &&
         robot.median <= kGrowsBy;
}

std::string for_people(const CrowdedOutcome& outcome) {
  const CrowdedFigures f = figures_of(outcome.windows);
  std::string out = fmt::format(
      "{} stops, {} clients that did {} things and were answered {} times, logs into a stopped "
      "terminal, a full pipe and a full disk{}; from "
      "before the operator connects\n"
      "  until the stop is on the wire to the slave:   {}\n"
      "  until the slave says on it that it stops:     {}\n"
      "  until the operator is answered:               {}\n"
      "  the same without all that, slave says so:     {}\n",
      f.taken.count, kCrowd, f.acts, f.answers,
      f.disk_held ? ", a scene from a disk that does not answer" : "", in_words(f.sent),
      in_words(f.taken), in_words(f.answered), in_words(f.calm_taken));
  const auto loop = [&](const char* what, double CrowdedWindow::*figure,
                        const CrowdedFigures::Growth& g) {
    return fmt::format(
        "  {}: p99.9 without {:.0f} us, with {:.0f} us\n    median difference of {} "
        "pairs of windows: {:+.0f} us, 95 % of it {:+.0f} to {:+.0f}\n",
        what, fmt::join(of(outcome.windows, false, figure), " "),
        fmt::join(of(outcome.windows, true, figure), " "), outcome.windows.size() / 2, g.median,
        g.low, g.high);
  };
  out += loop("haptic ticks late", &CrowdedWindow::haptic_us, f.haptic);
  out += loop("a loop beside it that does nothing", &CrowdedWindow::bare_us, f.bare);
  out += loop("robot commands after their cycle began", &CrowdedWindow::robot_us, f.robot);
  if (!f.disk_held) {
    out += "  no disk was slow: only root can hold the scene that the master reads\n";
  }
  if (!outcome.realtime) {
    out += "  this program was granted no real time: what kept it waiting is in these times\n";
  }
  out += fmt::format(
      "{}: p99.9 of the stop at the slave at most {:g} ms, of the loops at most "
      "{:g} us more\n",
      f.reached() ? "reached" : "NOT REACHED", kStopIn, kGrowsBy);
  return out;
}

std::string to_json(const CrowdedOptions& options, const CrowdedOutcome& outcome) {
  const CrowdedFigures f = figures_of(outcome.windows);
  const auto loop = [&](double CrowdedWindow::*figure, const CrowdedFigures::Growth& g) {
    return fmt::format(
        "{{\"without\": [{:.1f}], \"with\": [{:.1f}], \"median_difference\": {:.1f}, "
        "\"interval\": {}}}",
        fmt::join(of(outcome.windows, false, figure), ", "),
        fmt::join(of(outcome.windows, true, figure), ", "), g.median,
        std::isfinite(g.low) ? fmt::format("[{:.1f}, {:.1f}]", g.low, g.high) : "null");
  };
  return fmt::format(
      "{{\"seed\": {}, \"clients\": {}, \"slow_disk\": {}, \"acts\": {}, \"answers\": {}, "
      "\"realtime\": {}, "
      "\"on_the_wire_ms\": {}, "
      "\"slave_says_ms\": {}, \"answered_ms\": {}, \"slave_says_without_ms\": {}, "
      "\"haptic_p999_us\": {}, \"bare_p999_us\": {}, \"robot_p999_us\": {}, "
      "\"reached\": {}}}\n",
      options.seed, kCrowd, f.disk_held, f.acts, f.answers, outcome.realtime, in_json(f.sent),
      in_json(f.taken), in_json(f.answered), in_json(f.calm_taken),
      loop(&CrowdedWindow::haptic_us, f.haptic), loop(&CrowdedWindow::bare_us, f.bare),
      loop(&CrowdedWindow::robot_us, f.robot), f.reached());
}

}  // namespace handrail::storm
