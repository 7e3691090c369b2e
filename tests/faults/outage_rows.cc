// Rows of a network that is away for a while, or one way, or gives another address.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "server/base/clock.h"
#include "tests/faults/trial.h"

namespace handrail::faults::rows {
namespace {

// How long after `from` the slave, and the master, heard ten in a row no more than 20 ms apart; the
// later of the two. kForever: never.
Nanos heard_again(const WireTruth& truth, Nanos from) {
  constexpr int kInARow = 10;
  const auto first = [&](const auto& all, auto at_of) {
    int row = 0;
    Nanos last = 0;
    for (const auto& one : all) {
      const Nanos at = at_of(one);
      if (at < from) continue;
      row = at - last <= 20 * kMillisecond ? row + 1 : 1;
      last = at;
      if (row == kInARow) return at - from;
    }
    return kForever;
  };
  return std::max(first(truth.to_slave, [](const FreshState& f) { return f.at; }),
                  first(truth.to_master, [](Nanos at) { return at; }));
}

struct Outage {
  Nanos span = 0, end = 0;
  double loss = 0.0;
};

}  // namespace

RowResult n9(const RowRun& run) {
  Trial trial(run, "everything dark for 10 ms to 60 s (quick: 3 s), then clear or 30 % loss",
              "beyond 200 ms no motion until engage; heard again within 1 s, at 30 % loss 2 s");
  auto bed = trial.bed();
  if (!bed) return trial.result();
  std::vector<Outage> outages = {{10 * kMillisecond},
                                 {21 * kMillisecond},
                                 {100 * kMillisecond},
                                 {kSecond},
                                 {3 * kSecond, 0, 0.3}};
  if (run.full) outages.insert(outages.end(), {{60 * kSecond, 0, 0.0}, {60 * kSecond, 0, 0.3}});
  for (Outage& outage : outages) {
    bed->drive(kSecond);
    bed->change(fmt::format("both {{ loss: {} }} outage {{ for_s: {} }}", outage.loss,
                            to_seconds(outage.span)));
    outage.end = monotonic_now() + outage.span;
    // The hand goes on moving, and nobody engages for a second and a half.
    bed->drive(outage.span + 1500 * kMillisecond);
    const bool should = outage.span > 200 * kMillisecond;
    trial.check(bed->over() || bed->led() != should,
                fmt::format("{:.0f} ms: {}", in_ms(outage.span),
                            should ? "led without engage" : "not led any more"));
    bed->change("both { loss: 0 }");
    if (!bed->led() && !bed->engage(30 * kSecond)) {
      bed->problem(fmt::format("{:.0f} ms: cannot be engaged again", in_ms(outage.span)));
    }
  }
  const BedVerdict verdict = trial.end(std::move(bed));
  for (const Outage& outage : outages) {
    const Nanos took = heard_again(verdict.truth, outage.end);
    const double most = outage.loss > 0.0 ? 2000.0 : 1000.0;
    trial.measure(fmt::format("{:.0f} ms{}: heard again after {:.0f} ms", in_ms(outage.span),
                              outage.loss > 0.0 ? " and 30 % loss" : "", in_ms(took)));
    trial.check(trial.over() || in_ms(took) <= most,
                fmt::format("{:.0f} ms: heard again too late", in_ms(outage.span)));
  }
  return trial.result();
}

RowResult n10(const RowRun& run) {
  Trial trial(
      run, "one way dark for a second, each in turn, in motion",
      "the slave stops; the force on the hand is gone, as the status has it, within 50 ms and "
      "what asking takes");
  auto bed = trial.bed();
  if (!bed) return trial.result();
  Nanos slowest = 0;
  for (int i = 0; i < (run.full ? 40 : 6) && !bed->over(); ++i) {
    const bool to_near = i % 2 == 1;
    bed->drive(500 * kMillisecond);
    bed->dash();
    bed->wait(from_seconds(0.05 + 0.15 * bed->random().uniform()));
    bed->change(fmt::format("outage {{ for_s: 1 way: {} }}", to_near ? "TO_NEAR" : "TO_FAR"));
    const Nanos dark = monotonic_now();
    Nanos asked = dark, gone = kForever;
    while (to_near && gone == kForever && monotonic_now() < dark + kSecond) {
      const Nanos before = monotonic_now();
      const auto now = bed->status();
      // But for the cue that says so, which is no force of tool or spring.
      const bool none =
          now && now->spring_force().magnitude_n() < 1e-3 && now->tool_force().magnitude_n() < 1e-3;
      if (none) gone = before;
      asked = before;
    }
    if (to_near) slowest = std::max(slowest, (gone == kForever ? asked : gone) - dark);
    bed->wait(dark + 1200 * kMillisecond - monotonic_now());
    if (!bed->led() && !bed->engage()) bed->problem("cannot be engaged again");
  }
  trial.measure(fmt::format("spring and tool gone after {:.0f} ms at most", in_ms(slowest)));
  trial.check(trial.over() || slowest <= 100 * kMillisecond, "a force stayed on the hand");
  judge_acceptance(trial, trial.end(std::move(bed)));
  return trial.result();
}

RowResult n12(const RowRun& run) {
  Trial trial(run, "near's address changes, NAT gives other ports, in motion, MTU 1280",
              "heard again within 1 s; no datagram of the link over 585 bytes");
  BedOptions options;
  options.mtu = 1280;
  auto bed = trial.bed(options);
  if (!bed) return trial.result();
  constexpr std::uint64_t kLargest = 548 + 37;  // the contract's datagram in a record
  std::vector<Nanos> changes;
  int latched = 0;
  for (int i = 0; i < (run.full ? 40 : 6) && !bed->over(); ++i) {
    // Without NAT first, then with it.
    if (i == 2) bed->change("edge { nat: true }");
    bed->drive(600 * kMillisecond);
    const auto done = bed->emulator(i % 2 == 0 || i < 2 ? "roam" : "rebind");
    changes.push_back(monotonic_now());
    if (!done) bed->problem(done.message());
    bed->drive(1200 * kMillisecond);
    if (bed->led()) continue;
    ++latched;
    if (!bed->engage()) bed->problem("cannot be engaged again");
  }
  const BedVerdict verdict = trial.end(std::move(bed));
  judge_acceptance(trial, verdict);
  Nanos slowest = 0;
  for (const Nanos at : changes) slowest = std::max(slowest, heard_again(verdict.truth, at));
  trial.measure(
      fmt::format("{} changes: heard again after {:.0f} ms at most, longest gap {:.0f} ms, {} "
                  "latched; datagrams up to {} bytes",
                  changes.size(), in_ms(slowest), in_ms(verdict.link.longest_gap), latched,
                  verdict.truth.longest));
  trial.check(trial.over() || slowest <= kSecond, "heard again too late");
  trial.check(verdict.truth.longest <= kLargest, "a longer datagram");
  return trial.result();
}

}  // namespace handrail::faults::rows
