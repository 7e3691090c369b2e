// Rows of what the network does to some datagrams: late, overtaken, twice, damaged, from before.
#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include "server/base/clock.h"
#include "server/base/units.h"
#include "tests/emulator/report_text.h"
#include "tests/faults/arm_path.h"
#include "tests/faults/trial.h"

namespace handrail::faults::rows {
namespace {

// A stroke: its way, how long the hand takes for it, and how often there is one.
constexpr double kWay = 13.4e-3;     // [m]: 12 and 6 mm
constexpr double kStrokeTime = 0.8;  // [s]
constexpr Nanos kStroke = kSecond;
// How much further back than what is asked of it the arm may go on a straight way.
// Where nothing stops it: with stale states obeyed it was 0.34 mm, what the smoother leaves of
// them; without, 0.000 [m].
constexpr double kNoStepBack = 2e-4;
// Where gaps stop it, what a stop went beyond is taken back: at most the way of one that begins at
// the hand's fastest (1.875 of the mean, of a way of least jerk) and ends within its bound, 59 ms
// at this speed (README, "Who judges"), ever slower.
constexpr double kStopTime = 0.059;  // [s]
constexpr double kStopsWay = 1.875 * kWay / kStrokeTime * kStopTime / 2.0;
constexpr double kArrived = 1e-3;  // of the arm at rest from where it is asked to be [m]

struct Strokes {
  double back = 0.0;   // of the arm, at most [m]
  double asked = 0.0;  // of what the master asked, in that stroke: the force may turn a hand
  int count = 0;
  double off = 0.0;  // of the arm at rest from what was asked, at most [m]
  bool step_back = false;
};

// The hand goes to and fro, a straight way of a second at a time, and comes to rest between.
Strokes strokes(Bed& bed, Nanos span, double back_allowed) {
  Strokes out;
  const Nanos until = monotonic_now() + span;
  double side = 1.0;
  while (!bed.over() && monotonic_now() < until) {
    const Nanos from = monotonic_now();
    (void)bed.order(fmt::format("hand {{ displacement_mm: [{}, {}, 0] duration_s: {} }}",
                                12.0 * side, 6.0 * side, kStrokeTime));
    side = -side;
    Asked asked;
    while (!bed.over() && monotonic_now() < from + kStroke + 700 * kMillisecond) {
      const auto now = bed.status();
      if (now) asked.push_back({from_seconds(now->time_s()), storm::pose_of(now->command()).p});
      bed.wait(5 * kMillisecond);
    }
    const auto tap = handrail::read_tap(bed.tap());
    if (!tap) return out;
    const std::vector<TipAt> way = tips_of(*tap, from, monotonic_now());
    const double back = backward(way), of_asked = backward(asked);
    if (way.empty() || asked.empty()) return out;
    out.off = std::max(out.off, (way.back().p - asked.back().p).norm());
    if (back >= out.back) {
      out.back = back;
      out.asked = of_asked;
    }
    out.step_back = out.step_back || back > of_asked + back_allowed;
    ++out.count;
  }
  return out;
}

// One bed over a network, strokes in it.
void stroke_over(Trial& trial, const std::string& name, const std::string& faults, Nanos span,
                 double back_allowed) {
  auto bed = trial.bed();
  if (!bed) return;
  bed->change(faults);
  bed->wait(kSecond);
  if (!bed->led() && !bed->engage()) bed->problem(name + ": cannot be engaged");
  const Strokes done = strokes(*bed, span, back_allowed);
  const bool led = bed->led();
  judge_acceptance(trial, trial.end(std::move(bed)));
  trial.measure(
      fmt::format("{}: {:.3f} mm back where {:.3f} were asked, {:.3f} mm off at rest, {} strokes",
                  name, done.back / kMm, done.asked / kMm, done.off / kMm, done.count));
  trial.check(done.off <= kArrived, name + ": at rest behind or ahead of what is asked");
  trial.check(!done.step_back, name + ": a step back");
  trial.check(done.count > 0, name + ": no stroke");
  trial.check(trial.over() || led, name + ": not engaged in the end");
}

}  // namespace

RowResult n4(const RowRun& run) {
  Trial trial(
      run, "jitter of 1 to 50 ms on 50 ms, in order and each its own way",
      "no step back on a straight way that was not asked, but of what a stop went beyond; at rest "
      "within 1 mm of what is");
  const Nanos span = run.full ? 20 * kSecond : 3 * kSecond;
  const std::vector<int> jitters = run.full ? std::vector<int>{1, 5, 20, 50} : std::vector<int>{50};
  for (const int jitter : jitters) {
    for (const int own_way : {0, 1}) {
      stroke_over(trial, fmt::format("{} ms{}", jitter, own_way == 0 ? "" : ", out of order"),
                  fmt::format("both {{ delay_ms: 50 jitter_ms: {} reorder: {} }}", jitter, own_way),
                  span, kStopsWay);
    }
  }
  return trial.result();
}

RowResult n5(const RowRun& run) {
  Trial trial(run, "1, 10 and 50 % overtaken, 5 ms later",
              "no step back that was not asked; accepted as many as arrived as the newest");
  for (const double share : {0.01, 0.1, 0.5}) {
    if (!run.full && share == 0.1) continue;
    stroke_over(trial, fmt::format("{:.0f} %", 100.0 * share),
                fmt::format("both {{ reorder: {} reorder_by_ms: 5 }}", share),
                run.full ? 20 * kSecond : 3 * kSecond, kNoStepBack);
  }
  return trial.result();
}

RowResult n6(const RowRun& run) {
  Trial trial(run, "1, 25 and 100 % twice; stops among them",
              "each applied once; a stop made twice is one, and stays until reset");
  auto bed = trial.bed();
  if (!bed) return trial.result();
  for (const double share : {0.01, 0.25, 1.0}) {
    bed->change(fmt::format("both {{ duplicate: {} }}", share));
    bed->drive(run.full ? 20 * kSecond : 2 * kSecond);
    std::string said;
    const bool stopped = bed->order("stop: true", &said);
    const Nanos at = monotonic_now();
    bed->must_stop(at);
    trial.check(stopped && said.find("the slave has it") != std::string::npos,
                "a stop was not confirmed: " + said);
    bed->wait(500 * kMillisecond);
    trial.check(!bed->led(), "led while a stop stands");
    trial.check(bed->over() || bed->engage(), "cannot be engaged after a stop");
  }
  const BedVerdict verdict = trial.end(std::move(bed));
  judge_acceptance(trial, verdict);
  trial.check(verdict.truth.delivered(Origin::kDuplicate) > 1000, "hardly any came twice");
  return trial.result();
}

RowResult n7(const RowRun& run) {
  Trial trial(run, "up to 10 % damaged by 1 to 64 bits, damaged copies beside, checksums right",
              run.full ? "0 accepted of a million damaged" : "0 accepted of 100 000 damaged");
  auto bed = trial.bed();
  if (!bed) return trial.result();
  const std::uint64_t wanted = run.full ? 1'000'000 : 100'000;
  const int copies = run.full ? 40 : 20;
  for (const double share : {1e-4, 1e-3, 1e-2, 0.1}) {
    bed->change(
        fmt::format("to_far {{ corrupt: {} corrupt_bits: 64 corrupt_copies: {} }} "
                    "to_near {{ corrupt: {} corrupt_bits: 64 }}",
                    share, copies, share));
    bed->drive(from_seconds(1.1 * static_cast<double>(wanted) / 4e3 / copies));
  }
  const double missing = 1.1 * static_cast<double>(wanted);
  while (!bed->over()) {  // a busy master sends fewer
    const auto report = bed->emulator("report");
    if (!report || emulator::count(*report, "to_far", "corrupted") >= missing) break;
    bed->drive(kSecond);
  }
  trial.check(bed->over() || bed->led() || bed->engage(), "cannot be engaged");
  const BedVerdict verdict = trial.end(std::move(bed));
  judge_acceptance(trial, verdict);
  const std::uint64_t rejected = verdict.rejected.value_or(0);
  trial.measure(fmt::format("{} rejected by the slave", rejected));
  trial.check(verdict.truth.delivered(Origin::kCorrupt) >= wanted, "too few were damaged");
  trial.check(rejected >= wanted, "too few of the damaged reached the slave");
  return trial.result();
}

namespace {

// The session's own past, many times over.
void own_history(Trial& trial) {
  const bool full = trial.run().full;
  const std::uint64_t wanted = full ? 1'000'000 : 100'000;
  auto bed = trial.bed();
  if (!bed) return;
  bed->change(fmt::format("to_far {{ replay: {} }} to_near {{ replay: 2 }}", full ? 40 : 20));
  while (!bed->over()) {
    bed->drive(kSecond);
    const auto report = bed->emulator("report");
    if (!report) break;
    if (emulator::count(*report, "to_far", "replayed") >= 1.05 * static_cast<double>(wanted)) break;
  }
  const BedVerdict verdict = trial.end(std::move(bed));
  judge_acceptance(trial, verdict);
  trial.measure(fmt::format("{} rejected by the slave", verdict.rejected.value_or(0)));
  trial.check(verdict.truth.delivered(Origin::kReplay) >= wanted, "too few were replayed");
  trial.check(verdict.rejected.value_or(0) >= wanted, "too few of the replayed reached the slave");
}

// What a tap of before has, to the slave: what it got, and what it sent, turned around.
void repeat(Bed& bed, const std::string& old, int times) {
  for (int i = 0; i < times && !bed.over(); ++i) {
    for (const char* verb : {"replay", "reflect"}) {
      const auto done = bed.emulator(fmt::format("{} far {} 20000", verb, old));
      if (!done) bed.problem(done.message());
      bed.drive(500 * kMillisecond);
    }
  }
}

}  // namespace

RowResult n8(const RowRun& run) {
  Trial trial(run,
              "replays of the own history; of a previous session, both directions, also to a slave "
              "that was started again",
              run.full ? "0 accepted of a million" : "0 accepted of 100 000");
  own_history(trial);
  BedOptions whole;
  whole.tap_bytes = 1500;
  auto bed = trial.bed(whole);
  if (!bed) return trial.result();
  bed->drive(run.full ? 10 * kSecond : 3 * kSecond);
  (void)bed->emulator("report");
  const std::string old = bed->folder() + "/before.pcap";
  std::error_code error;
  std::filesystem::copy_file(bed->folder() + "/far.pcap", old, error);
  const int times = run.full ? 5 : 1;
  for (const Who who : {Who::kMaster, Who::kSlave}) {
    bed->signal(who, who == Who::kMaster ? "KILL" : "TERM");
    bed->must_stop(monotonic_now());
    bed->wait(300 * kMillisecond);
    if (const Status started = bed->start(who); !started) bed->problem(started.message());
    // Nobody has engaged: what is replayed must not move the arm.
    repeat(*bed, old, times);
    trial.check(bed->over() || bed->engage(30 * kSecond), "cannot be engaged after a start");
    repeat(*bed, old, times);
  }
  const BedVerdict verdict = trial.end(std::move(bed));
  judge_acceptance(trial, verdict);
  trial.check(verdict.truth.delivered(Origin::kInjected) > 1000, "hardly anything was replayed");
  return trial.result();
}

}  // namespace handrail::faults::rows
