#include <algorithm>
#include <array>
#include <cmath>

#include "server/lab/faults/fault_rows.h"
#include "server/lab/network/link_faults.h"

namespace handrail::rows {
namespace {

double in_ms(Nanos span) { return to_seconds(span) * 1e3; }

// The slave took what was fresh and nothing else.
void judge_order(FaultRun& run, FaultOutcome& out) {
  const std::uint64_t accepted = run.cell().net()->slave().snapshot().accepted;
  const std::uint64_t fresh = run.auditor().report().fresh;
  find(out, accepted > fresh ? accepted - fresh : fresh - accepted, "not the newest applied");
}

void judge_never_tripped(FaultRun& run, FaultOutcome& out) {
  find(out, run.auditor().report().stops, "trips");
  find(out, run.auditor().report().latched, "latched");
  find(out, !run.engaged(), "not engaged at the end");
}

// Ten minutes of independent loss each way.
FaultOutcome n1(const RowRun& row, double loss, bool may_trip) {
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  LinkFaults faults;
  faults.loss = loss;
  run.set_network(faults);
  run.run(row.span(600 * kSecond));
  FaultOutcome out = run.outcome();
  judge_order(run, out);
  find(out, run.auditor().report().latched, "latched");
  if (!may_trip) judge_never_tripped(run, out);
  measure(out, in_ms(run.longest_gap()), in_ms(may_trip ? Auditor::kLatch : Auditor::kWatchdog));
  return out;
}

}  // namespace

FaultOutcome n1a(const RowRun& row) { return n1(row, 0.1, false); }
FaultOutcome n1b(const RowRun& row) { return n1(row, 0.3, true); }

// A minute of up to 10 % loss, against the same minute without.
FaultOutcome n1c(const RowRun& row) {
  constexpr std::array<double, 3> kLosses = {0.01, 0.05, 0.1};
  FaultRun clean(row);
  FaultRun run(row);
  if (!clean.engage() || !run.engage()) return not_engaged();
  LinkFaults faults;
  faults.loss = row.level(kLosses);
  run.set_network(faults);
  clean.run(60 * kSecond);
  run.run(60 * kSecond);
  FaultOutcome out = run.outcome();
  judge_order(run, out);
  judge_never_tripped(run, out);
  measure(out, run.tracking_error() / clean.tracking_error(), 1.5);
  find(out, out.worst > out.bound, "the arm follows worse");
  return out;
}

// Bursts of loss of 2 to 200 ms, 5 % of the time.
FaultOutcome n2(const RowRun& row) {
  constexpr std::array<double, 5> kMeans = {2.0, 5.0, 10.0, 50.0, 200.0};
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  LinkFaults faults;
  const double mean = row.level(kMeans);
  faults.burst_leave = 1.0 / mean;
  faults.burst_enter = 0.05 / 0.95 / mean;
  run.set_network(faults);
  run.drive(60 * kSecond);
  FaultOutcome out = run.outcome();
  judge_order(run, out);
  return out;
}

// A constant delay one way, up to 500 ms: slow to feel, but drivable; its age is shown, and said
// from 100 ms on.
FaultOutcome n3(const RowRun& row) {
  constexpr Nanos kWarned = 100 * kMillisecond;
  constexpr std::array<int, 6> kDelays = {0, 10, 50, 100, 200, 500};
  FaultRun run(row);
  LinkFaults faults;
  faults.delay = row.level(kDelays) * kMillisecond;
  run.set_network(faults);
  if (!run.engage()) return not_engaged();
  double off = 0.0;
  std::uint64_t unsaid = 0;
  for (int i = 0; i < 20'000; ++i) {
    run.tick();
    const Nanos loop = run.loop_age();
    const Nanos shown = run.cell().net()->master().snapshot().loop_age(run.now());
    // What takes a tick is not the network's.
    off = std::max(off, (std::abs(in_ms(shown - loop)) - 1.0) / std::max(in_ms(loop), 1.0));
    const bool said = run.cell().master().reasons.has(Reason::kLoopAge);
    if (loop > kWarned + 2 * kMillisecond && !said) ++unsaid;
    if (loop < kWarned - 2 * kMillisecond && said) ++unsaid;
  }
  FaultOutcome out = run.outcome();
  judge_order(run, out);
  judge_never_tripped(run, out);
  find(out, unsaid, "ms of a wrong warning");
  measure(out, 100.0 * std::max(off, 0.0), 5.0);
  find(out, out.worst > out.bound, "wrong age shown");
  return out;
}

// Jitter of 1 to 50 ms on 50 ms, order kept as a queue keeps it.
FaultOutcome n4(const RowRun& row) {
  constexpr std::array<int, 4> kJitters = {1, 5, 20, 50};
  FaultRun run(row);
  LinkFaults faults;
  faults.delay = 50 * kMillisecond;
  faults.jitter = row.level(kJitters) * kMillisecond;
  faults.reorder = row.index % 8 < 4 ? 0.0 : 1.0;  // every second time each takes its own way
  if (!run.engage()) return not_engaged();
  run.set_network(faults);
  run.drive(20 * kSecond);
  FaultOutcome out = run.outcome();
  judge_order(run, out);
  measure(out, run.auditor().report().jerk, 1.0);
  return out;
}

namespace {

// What the network may do to the order, with the count of what must not be applied.
FaultOutcome order_row(const RowRun& row, const LinkFaults& faults, Nanos span) {
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  run.set_network(faults);
  run.run(span);
  FaultOutcome out = run.outcome();
  judge_order(run, out);
  judge_never_tripped(run, out);
  const std::uint64_t accepted = run.cell().net()->slave().snapshot().accepted;
  const std::uint64_t fresh = run.auditor().report().fresh;
  measure(out, accepted > fresh ? static_cast<double>(accepted - fresh) : 0.0, 0.0);
  return out;
}

}  // namespace

FaultOutcome n5(const RowRun& row) {
  constexpr std::array<double, 3> kShares = {0.01, 0.1, 0.5};
  LinkFaults faults;
  faults.reorder = row.level(kShares);
  faults.reorder_by = 5 * kMillisecond;
  return order_row(row, faults, 20 * kSecond);
}

// Duplicates; the last level replays ten old datagrams for each new one: in 100 s a million.
FaultOutcome n6(const RowRun& row) {
  constexpr std::array<double, 3> kShares = {0.01, 0.25, 1.0};
  LinkFaults faults;
  if (row.index % 4 == 3) {
    faults.replay = 10.0;
    return order_row(row, faults, row.span(100 * kSecond));
  }
  faults.duplicate = row.level(kShares);
  return order_row(row, faults, 20 * kSecond);
}

// Blackouts of 10 ms to 60 s.
FaultOutcome n9(const RowRun& row) {
  constexpr std::array<int, 5> kSpans = {10, 21, 100, 1000, 60'000};
  const Nanos span = row.level(kSpans) * kMillisecond;
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  run.run(run.up_to(kSecond));
  LinkFaults dark;
  dark.loss = 1.0;
  run.set_network(dark);
  run.run(span);
  run.set_network({});
  // Nobody engages for a second: what was latched must not move, the rest goes on by itself.
  run.run(kSecond);
  const bool latched = run.auditor().report().latched > 0;
  const bool heard = run.cell().net()->slave().snapshot().age(
                         run.cell().net()->slave_now(run.now())) < 5 * kMillisecond;
  if (latched) run.drive(5 * kSecond);
  const bool engaged = run.engaged();
  FaultOutcome out = run.outcome();
  find(out, !heard, "not heard within a second");
  find(out, !engaged, "not engaged again");
  find(out, latched != (span > Auditor::kLatch), "latched by another gap");
  return out;
}

namespace {

// One direction alone goes dark: the slave stops, the master's force goes. Every second time the
// arm is on its way to a command 12 cm ahead.
FaultOutcome n10(const RowRun& row, bool to_slave) {
  constexpr Nanos kForceGone = 50 * kMillisecond;
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  run.run(run.up_to(kSecond));
  MasterState far = run.cell().master().link;
  if (to_slave && row.index % 2 == 1) {
    far.X_SU.p += Vec3(0.0, 0.06, 0.1);
    run.send_instead(&far);
    run.run(100 * kMillisecond);
  }
  (to_slave ? run.to_slave() : run.to_master()).loss = 1.0;
  run.tick();
  Nanos last_force = run.master_heard();
  const Nanos heard = run.master_heard();
  for (int i = 0; i < 1000; ++i) {
    run.tick();
    // But for the cue that says so.
    const HapticOutput& master = run.cell().master();
    if ((master.f_H_M.force - master.force.cue).norm() > 1e-9) last_force = run.now();
  }
  FaultOutcome out = run.outcome();
  find(out, run.auditor().moving(), "moving at the end");
  if (to_slave) return out;
  measure(out, in_ms(last_force - heard), in_ms(kForceGone));
  find(out, out.worst > out.bound, "force stayed");
  return out;
}

}  // namespace

FaultOutcome n10a(const RowRun& row) { return n10(row, true); }
FaultOutcome n10b(const RowRun& row) { return n10(row, false); }

// A narrow way with a queue of a second: the loop's age passes its limit, which takes the force
// away, and comes back.
FaultOutcome n11(const RowRun& row) {
  constexpr Nanos kLimit = 300 * kMillisecond;
  constexpr Nanos kQueue = kSecond;
  constexpr std::array<int, 4> kRates = {64'000, 256'000, 1'000'000, 2'000'000};
  FaultOptions options;
  options.fade_loop = kLimit;
  FaultRun run(row, options);
  if (!run.engage()) return not_engaged();
  run.let_hold();  // most of what is sent is dropped: the link is poor
  LinkFaults faults;
  faults.queue = kQueue;
  faults.rate_bps = row.level(kRates);
  run.set_network(faults);
  Nanos worst = 0;
  std::uint64_t backlog = 0;
  Nanos over_since = -1;
  for (int i = 0; i < 20'000; ++i) {
    run.drive(kMillisecond);
    const Nanos loop = run.loop_age();
    const bool faded = run.cell().master().reasons.has(Reason::kForceFaded);
    const bool over = loop > kLimit && run.cell().master_state().lead.session != SessionState::kOff;
    if (!over || faded) {
      over_since = -1;
    } else {
      if (over_since < 0) over_since = run.now() - kMillisecond;
      worst = std::max(worst, run.now() - over_since);
    }
    // Both ways' queues, full, and what it takes to notice.
    if (run.now() - run.master_heard() < 20 * kMillisecond && loop > 2 * kQueue + kSecond / 2) {
      ++backlog;
    }
  }
  run.set_network({});
  run.drive(5 * kSecond);
  const bool engaged = run.engaged();
  FaultOutcome out = run.outcome();
  judge_order(run, out);
  find(out, !engaged, "not engaged again");
  find(out, backlog, "ms with a growing backlog");
  find(out, run.loop_age() > 20 * kMillisecond, "the loop stayed old");
  measure(out, in_ms(worst), 5.0);
  find(out, out.worst > out.bound, "an old loop kept its force");
  return out;
}

// Half an hour of everything at once.
FaultOutcome n13(const RowRun& row) {
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  run.set_network(find_network(row.index % 2 == 0 ? "netcode" : "harsh")->way);
  run.drive(row.span(1800 * kSecond));
  FaultOutcome out = run.outcome();
  judge_order(run, out);
  return out;
}

}  // namespace handrail::rows
