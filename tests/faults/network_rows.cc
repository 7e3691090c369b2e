// Rows of what the network does to all datagrams alike: loss, bursts, delay, a narrow way.
#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>

#include "server/base/clock.h"
#include "server/base/units.h"
#include "server/lab/network/link_faults.h"
#include "tests/faults/arm_path.h"
#include "tests/faults/trial.h"

namespace handrail::faults::rows {
namespace {

constexpr Nanos kLongestBed = 300 * kSecond;  // that the rig's tap holds from its beginning
constexpr double kWorse = 1.5;                // of the clean tracking error

bool latched(const pb::Status& s) {
  return s.state() == "fault" || s.slave_state() == "fault" || s.state() == "off";
}

// Drives for so long; whoever latches is engaged again over a clear network. How often.
std::uint64_t drive_on(Bed& bed, Nanos span, const std::string& faults, Asked* asked = nullptr) {
  const Nanos until = monotonic_now() + span;
  std::uint64_t times = 0;
  bed.change(faults);
  while (!bed.over() && monotonic_now() < until) {
    bool is_latched = false;
    bed.drive(std::min<Nanos>(100 * kMillisecond, until - monotonic_now()),
              [&](const pb::Status& s) {
                is_latched = is_latched || latched(s);
                if (asked == nullptr || s.state() != "engaged") return;
                asked->push_back({from_seconds(s.time_s()), storm::pose_of(s.command()).p});
              });
    if (!is_latched) continue;
    ++times;
    bed.change(kClear);
    if (!bed.engage()) bed.problem("cannot be engaged again over a clear network");
    bed.change(faults);
  }
  return times;
}

struct Driven {
  double error = 0.0;  // tracking, root mean square [m]
  std::uint64_t latched = 0;
  BedVerdict verdict;
};

// One bed for each piece of `span` that the rig's tap holds.
Driven drive_over(Trial& trial, const std::string& faults, Nanos span) {
  Driven out;
  for (Nanos left = span; left > 0 && !trial.over(); left -= kLongestBed) {
    auto bed = trial.bed();
    if (!bed) return out;
    Asked asked;
    const Nanos from = monotonic_now();
    out.latched += drive_on(*bed, std::min(left, kLongestBed), faults, &asked);
    const auto tap = read_tap(bed->tap());
    if (tap) out.error = tracking_error(tips_of(*tap, from, monotonic_now()), asked);
    out.verdict = trial.end(std::move(bed));
    judge_acceptance(trial, out.verdict);
  }
  return out;
}

}  // namespace

RowResult n1(const RowRun& run) {
  Trial trial(run, "independent loss each way, driven at speed",
              "up to 10 %: no gap over 20 ms, tracking error up to 1.5 of the clean; 30 %: nothing "
              "latches; none accepted that is not the newest");
  const Nanos span = run.full ? 600 * kSecond : 8 * kSecond;
  const Driven clean = drive_over(trial, "both { loss: 0 }", std::min(span, 60 * kSecond));
  const std::vector<double> losses =
      run.full ? std::vector<double>{0.01, 0.05, 0.1, 0.2, 0.3} : std::vector<double>{0.1, 0.3};
  for (const double loss : losses) {
    const Driven driven = drive_over(trial, fmt::format("both {{ loss: {} }}", loss), span);
    trial.measure(
        fmt::format("{:.0f} %: error {:.2f} mm (clean {:.2f}), longest gap {:.1f} ms, {} "
                    "latched",
                    100.0 * loss, driven.error / kMm, clean.error / kMm,
                    1e3 * to_seconds(driven.verdict.link.longest_gap), driven.latched));
    trial.check(driven.latched == 0, fmt::format("{:.0f} %: latched", 100.0 * loss));
    if (loss > 0.1) continue;
    trial.check(driven.verdict.link.trips == 0,
                fmt::format("{:.0f} %: {} trips", 100.0 * loss, driven.verdict.link.trips));
    trial.check(driven.error <= kWorse * clean.error,
                fmt::format("{:.0f} %: follows worse", 100.0 * loss));
  }
  return trial.result();
}

RowResult n2(const RowRun& run) {
  Trial trial(run, "bursts of loss of 2, 5, 10, 50 and 200 ms in the mean, 5 % of the time",
              "gaps over 20 ms stop the arm; those up to 200 ms need no operator, the others one");
  auto bed = trial.bed();
  if (!bed) return trial.result();
  std::uint64_t latched = 0;
  for (const int mean : {2, 5, 10, 50, 200}) {
    const std::string faults =
        fmt::format("both {{ burst_leave: {} burst_enter: {} }}", 1.0 / mean, 0.05 / 0.95 / mean);
    latched += drive_on(*bed, run.full ? 60 * kSecond : 5 * kSecond, faults);
  }
  const BedVerdict verdict = trial.end(std::move(bed));
  judge_acceptance(trial, verdict);
  trial.measure(fmt::format(
      "{} gaps of 20 to 200 ms, {} of about 200 ms or more at either side, {} "
      "latched, {} stops went on by themselves",
      verdict.link.short_gaps, verdict.link.long_gaps, latched, verdict.link.report.resumed));
  trial.check(verdict.link.short_gaps > 0 && verdict.link.report.resumed > 0,
              "no gap stopped the arm and let it go on");
  trial.check(latched <= verdict.link.long_gaps, "a gap below 200 ms latched");
  return trial.result();
}

RowResult n3(const RowRun& run) {
  Trial trial(run, "constant delay one way, both ways alike",
              "drivable, nothing latches; loop age shown within 5 % and 3 ms; warned from 100 ms");
  auto bed = trial.bed();
  if (!bed) return trial.result();
  const std::vector<int> delays =
      run.full ? std::vector<int>{0, 10, 50, 100, 200, 500} : std::vector<int>{0, 30, 100, 500};
  for (const int delay : delays) {
    // From one delay to another the network itself makes a gap: it is given time for that.
    bed->change(fmt::format("both {{ delay_ms: {} }}", delay));
    bed->wait(from_seconds(2.5e-3 * delay) + 300 * kMillisecond);
    if (!bed->led() && !bed->engage()) bed->problem(fmt::format("{} ms: no engage", delay));
    double loop = 0.0;
    int seen = 0, warned = 0, bad = 0;
    bed->drive(run.full ? 20 * kSecond : 3 * kSecond, [&](const pb::Status& s) {
      ++seen;
      loop += s.loop_age_ms();
      bad += latched(s) ? 1 : 0;
      for (const std::string& what : s.interventions()) {
        if (what.find("long there and back") == std::string::npos) continue;
        ++warned;
        break;
      }
    });
    loop /= std::max(seen, 1);
    trial.measure(
        fmt::format("{} ms: loop age {:.1f} ms, warned {} of {}", delay, loop, warned, seen));
    trial.check(bad == 0, fmt::format("{} ms: latched", delay));
    trial.check(std::abs(loop - 2.0 * delay) <= 0.05 * 2.0 * delay + 3.0,
                fmt::format("{} ms: another loop age is shown", delay));
    const bool warns = 2 * delay >= 100 ? warned == seen : warned <= seen / 20;
    trial.check(warns, fmt::format("{} ms: the warning is wrong", delay));
  }
  judge_acceptance(trial, trial.end(std::move(bed)));
  return trial.result();
}

RowResult n11(const RowRun& run) {
  Trial trial(run, "64, 256, 1000 and 2000 kbit/s, a queue of a second",
              "loop age below both queues and half a second; drivable once the way is wide again");
  auto bed = trial.bed();
  if (!bed) return trial.result();
  constexpr double kMostLoop = 2500.0;  // two queues of a second, and what it takes to notice [ms]
  for (const int rate : {64, 256, 1000, 2000}) {
    double most = 0.0;
    bed->change(fmt::format("both {{ rate_kbit_s: {} queue_ms: 1000 }}", rate));
    bed->drive(run.full ? 20 * kSecond : 4 * kSecond, [&](const pb::Status& s) {
      const bool hears = s.packet_age_ms() >= 0.0 && s.packet_age_ms() < 20.0;
      if (hears) most = std::max(most, s.loop_age_ms());
    });
    trial.measure(fmt::format("{} kbit/s: loop age up to {:.0f} ms while heard", rate, most));
    trial.check(most <= kMostLoop, fmt::format("{} kbit/s: the backlog grows", rate));
    bed->change("both { rate_kbit_s: 0 }");
    bed->wait(kSecond);
    trial.check(bed->over() || bed->engage(),
                fmt::format("{} kbit/s: cannot be engaged afterwards", rate));
  }
  judge_acceptance(trial, trial.end(std::move(bed)));
  return trial.result();
}

RowResult n13(const RowRun& run) {
  Trial trial(run, "the networks netcode (250 +- 250 ms, 5 % loss, 10 % twice) and harsh",
              "what every row asks");
  const Nanos span = run.full ? 1800 * kSecond : 8 * kSecond;
  for (const char* name : {"netcode", "harsh"}) {
    const LinkFaults way = find_network(name)->way;
    const std::string faults = fmt::format(
        "both {{ delay_ms: {} jitter_ms: {} loss: {} duplicate: {} reorder: {} reorder_by_ms: {} "
        "}}",
        1e3 * to_seconds(way.delay), 1e3 * to_seconds(way.jitter), way.loss, way.duplicate,
        way.reorder, 1e3 * to_seconds(way.reorder_by));
    const Driven driven = drive_over(trial, faults, span);
    trial.measure(fmt::format("{}: {} gaps of 20 to 200 ms, {} latched", name,
                              driven.verdict.link.short_gaps, driven.latched));
  }
  return trial.result();
}

}  // namespace handrail::faults::rows
