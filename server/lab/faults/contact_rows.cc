#include <algorithm>
#include <array>
#include <limits>

#include "server/lab/faults/contact_push.h"
#include "server/lab/faults/fault_rows.h"

namespace handrail::rows {
namespace {

constexpr double kBlind = 150.0;  // what 0.1 s of the fastest approach adds to the promise [N]

}  // namespace

// A constant delay one way: pushed, held, released. It settles, and the way out is free.
FaultOutcome n3c(const RowRun& row) {
  constexpr std::array<int, 6> kDelays = {0, 10, 50, 100, 200, 500};
  Push push(row, false);
  LinkFaults faults;
  faults.delay = row.level(kDelays) * kMillisecond;
  push.run.set_network(faults);
  if (!push.begin()) return not_engaged();
  push.pass(8 * kSecond);
  const double swing = push.swing();
  const double force = push.run.true_force();
  push.retreat();
  push.pass(3 * kSecond);
  const double left = push.run.true_force();
  const bool engaged = push.run.engaged();
  FaultOutcome out = push.outcome();
  find(out, swing > 2.0, "swings");
  find(out, force < 30.0, "contact given up");
  find(out, left > 0.0, "not released");
  find(out, !engaged, "not engaged");
  return out;
}

// The master stopped for 5 ms to 10 s, or killed and started anew, while it pushes and slides.
FaultOutcome p1c(const RowRun& row) {
  constexpr std::array<int, 6> kSpans = {5, 30, 150, 1000, 10'000, 1000};
  const bool killed = &row.level(kSpans) == &kSpans.back();
  const Nanos span = row.level(kSpans) * kMillisecond;
  Push push(row, true);
  if (!push.begin()) return not_engaged();
  if (push.pass_until(1.0 + 40.0 * push.run.random().uniform()) == kForever) return not_engaged();
  CellNet& net = *push.run.cell().net();
  net.stop_master(true);
  push.pass(span);
  if (killed) push.run.restart_master();
  net.stop_master(false);
  push.pass(kSecond);
  if (span > Auditor::kLatch) push.pass(6 * kSecond, true);
  const bool engaged = push.run.engaged();
  FaultOutcome out = push.outcome();
  find(out, !engaged, "not engaged again");
  return out;
}

// Bad numbers of the sensor, for one reading of a cycle or for good: one costs nothing, the third
// in a row stops the arm.
FaultOutcome s1d(const RowRun& row) {
  constexpr std::array<double, 3> kBad = {std::numeric_limits<double>::quiet_NaN(),
                                          std::numeric_limits<double>::infinity(), 1e308};
  const bool once = row.index % 2 == 0;
  Push push(row, true);
  if (!push.begin()) return not_engaged();
  push.pass_until(1.0 + 40.0 * push.run.random().uniform());
  const Nanos from = push.run.now() + kMillisecond;
  push.falsify = [&](Nanos at, Wrench& f, bool&) {
    if (at < from || (once && at >= from + Push::kCycle)) return;
    f.force[(row.index / 2) % 3] = kBad[static_cast<std::size_t>(row.index / 2) % kBad.size()];
  };
  push.pass(20 * kMillisecond);
  if (!once) push.run.auditor().must_stop(from + 3 * Push::kCycle);
  push.pass(3 * kSecond);
  const bool engaged = push.run.engaged();
  FaultOutcome out = push.outcome();
  find(out, engaged != once, once ? "not engaged after one bad reading" : "not found");
  return out;
}

// The sensor repeats itself, from before the contact or in it: a stop within 100 ms, in which
// nothing tells how hard is pushed.
FaultOutcome s2c(const RowRun& row) {
  Push push(row, true);
  if (!push.begin()) return not_engaged();
  if (row.index % 3 == 0) {
    push.pass(50 * kMillisecond);
  } else {
    push.pass_until(row.index % 3 == 1 ? 5.0 : 45.0);
  }
  const Nanos from = push.run.now();
  push.freeze_sensor();
  push.pass(50 * kMillisecond);
  push.run.auditor().must_stop(from + 100 * kMillisecond);
  push.pass(3 * kSecond);
  const bool engaged = push.run.engaged();
  FaultOutcome out = push.outcome(true, Push::kPromise + kBlind);
  find(out, engaged, "not found");
  return out;
}

// The force has the wrong sign: a stop within 200 ms of a contact, that stays one, and not hard.
FaultOutcome s3c(const RowRun& row) {
  constexpr double kContact = 10.0;  // [N]
  Push push(row, row.index % 2 == 1);
  push.falsify = [](Nanos, Wrench& f, bool&) { f.force = -f.force; };
  if (!push.begin()) return not_engaged();
  const Nanos felt = push.pass_until(kContact);
  if (felt == kForever) return not_engaged();
  push.pass(150 * kMillisecond);
  push.run.auditor().must_stop(felt + 200 * kMillisecond);
  push.pass(5 * kSecond);
  const bool found = push.run.cell().slave().fault == Reason::kSensorSign;
  FaultOutcome out = push.run.outcome();
  find(out, !found, "not found");
  find(out, push.peak > Push::kPromise, "over the promised force");
  return out;
}

// Saturation, drift, twice the scale, one wild sample, while it pushes.
FaultOutcome s3d(const RowRun& row) {
  const int level = row.index % 4, beside = (row.index / 4) % 2;
  const bool saturated = level == 0;
  Push push(row, true);
  if (!push.begin()) return not_engaged();
  push.pass_until(saturated ? 20.0 * push.run.random().uniform() : 30.0);
  const Nanos from = push.run.now() + kMillisecond;
  push.falsify = [&](Nanos at, Wrench& f, bool& valid) {
    if (at < from) return;
    if (saturated) {
      f.force.z() = 1000.0;
      valid = false;
    } else if (level == 1) {
      f.force.z() += (beside == 0 ? 1.0 : -1.0) * std::min(1.5, 0.5 * to_seconds(at - from));
    } else if (level == 2) {
      f.force *= 2.0;
    } else if (at < from + Push::kCycle) {
      f.force[2 * beside] += 200.0;
    }
  };
  if (saturated) {
    push.pass(20 * kMillisecond);
    push.run.auditor().must_stop(from + 3 * Push::kCycle);
  }
  push.pass(5 * kSecond);
  const bool engaged = push.run.engaged();
  FaultOutcome out = push.outcome(true);
  find(out, engaged == saturated, saturated ? "not found" : "not engaged");
  return out;
}

// Two axes exchanged: the bumper backs off the wrong way, and the force grows, which looks like a
// wrong sign or is not relieved. A stop within 220 ms of 80 N; until then the tip goes aside, where
// nobody asked for it.
FaultOutcome s3e(const RowRun& row) {
  Push push(row, false);
  if (!push.begin()) return not_engaged();
  push.falsify = [&](Nanos, Wrench& f, bool&) { std::swap(f.force.z(), f.force[row.index % 2]); };
  const Nanos over = push.pass_until(Push::kThreshold + 30.0);
  if (over == kForever) return not_engaged();
  push.pass(150 * kMillisecond);
  push.run.auditor().must_stop(over + 220 * kMillisecond);
  push.pass(5 * kSecond);
  const bool found = push.run.cell().slave().state == SessionState::kFault;
  push.run.auditor().finish();
  const AuditReport& report = push.run.auditor().report();
  FaultOutcome out;
  measure(out, to_seconds(report.worst.took) * 1e3, to_seconds(report.worst.allowed) * 1e3);
  find(out, report.worst.took > report.worst.allowed, "stopped late");
  find(out, report.total() - report.of(Breach::kUnasked), "breaches beside the tip's place");
  find(out, !found, "not found");
  return out;
}

}  // namespace handrail::rows
