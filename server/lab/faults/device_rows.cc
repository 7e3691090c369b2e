#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/lab/faults/fault_rows.h"

namespace handrail::rows {
namespace {

constexpr Nanos kCycle = 7'100 * kMicrosecond;
constexpr double kDenormal = std::numeric_limits<double>::denorm_min();
constexpr std::array<double, 4> kBadNumbers = {std::numeric_limits<double>::quiet_NaN(),
                                               std::numeric_limits<double>::infinity(), 1e308,
                                               kDenormal};

// When and with what value a reading goes wrong.
struct BadSpan {
  Nanos from = 0;
  Nanos to = 0;
  double value = 0.0;

  bool at(Nanos now) const { return now >= from && now < to; }
};

// Levels: four numbers, each for one cycle, or for good.
BadSpan bad_span(FaultRun& run, int index) {
  run.run(run.up_to(kSecond));
  BadSpan span;
  span.from = run.now() + kMillisecond;
  span.to = index % 2 == 0 ? span.from + kCycle : kForever;
  span.value = kBadNumbers[static_cast<std::size_t>(index / 2) % kBadNumbers.size()];
  return span;
}

// One bad reading costs at most one held cycle: the arm is never further from where it goes without
// (`clean`) than it moves in a cycle, and nobody has to reset anything. A lasting one is a stop
// after three cycles. A denormal number is as good as zero.
FaultOutcome judge_readings(FaultRun& run, FaultRun& clean, const BadSpan& span) {
  const bool lasting = span.to == kForever && span.value != kDenormal;
  double away = 0.0;
  for (int i = 0; i < 2000; ++i) {
    if (lasting && i == 22) run.auditor().must_stop(span.from + 3 * kCycle);
    run.tick();
    if (span.to == kForever) continue;
    const Vec3 last = clean.auditor().tip();
    clean.tick();
    const double cycle = (clean.auditor().tip() - last).norm();
    away = std::max(away, (run.auditor().tip() - clean.auditor().tip()).norm() - cycle);
  }
  const bool engaged = run.engaged();
  FaultOutcome out = run.outcome();
  if (lasting) {
    find(out, engaged, "still engaged");
  } else if (span.to != kForever) {
    find(out, away > 1e-9, "more than a cycle held");
    find(out, !engaged, "not engaged after one bad reading");
    find(out, run.auditor().report().stops, "trips");
  }
  return out;
}

}  // namespace

FaultOutcome s1a(const RowRun& row) {
  FaultRun run(row);
  FaultRun clean(row);
  if (!run.engage() || !clean.engage()) return not_engaged();
  const BadSpan span = bad_span(run, row.index);
  run.layers().force = [&](Nanos at, Wrench& f, bool&) {
    if (span.at(at)) f.force[row.index % 3] = span.value;
  };
  clean.run(run.now() - clean.now());
  return judge_readings(run, clean, span);
}

FaultOutcome s1b(const RowRun& row) {
  FaultRun run(row);
  FaultRun clean(row);
  if (!run.engage() || !clean.engage()) return not_engaged();
  const BadSpan span = bad_span(run, row.index);
  run.layers().reply = [&](Nanos at, RobotReply& reply) {
    if (span.at(at)) reply.q_measured[row.index % kJoints] = span.value;
  };
  clean.run(run.now() - clean.now());
  return judge_readings(run, clean, span);
}

// Without a hand the command stays, the force goes at once, and nothing has to be reset.
FaultOutcome s1c(const RowRun& row) {
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  const BadSpan span = bad_span(run, row.index);
  run.layers().hand = [&](Nanos at, HandReading& hand) {
    if (span.at(at)) hand.X_MH.p[row.index % 3] = span.value;
  };
  double force = 0.0;
  for (int i = 0; i < 1000; ++i) {
    run.tick();
    const bool bad = span.at(run.now() - kMillisecond);
    if (bad && span.value != kDenormal)
      force = std::max(force, run.cell().master().f_H_M.force.norm());
  }
  const bool moving = run.auditor().moving();
  FaultOutcome out = run.outcome();
  measure(out, force, 0.0);
  find(out, !(force <= 0.0), "force on a hand nobody knows");
  find(out, span.to == kForever && span.value != kDenormal && moving, "moving without a hand");
  find(out, !run.engaged(), "not engaged");
  return out;
}

// The sensor repeats its last reading bit for bit: a stop within 100 ms.
FaultOutcome s2a(const RowRun& row) {
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  run.run(run.up_to(kSecond));
  const Nanos from = run.now();
  Wrench last;
  bool have = false;
  run.layers().force = [&](Nanos, Wrench& f, bool&) {
    if (have) f = last;
    last = f;
    have = true;
  };
  run.run(50 * kMillisecond);
  run.auditor().must_stop(from + 100 * kMillisecond);
  run.run(2 * kSecond);
  const bool engaged = run.engaged();
  FaultOutcome out = run.outcome();
  find(out, engaged, "not found");
  return out;
}

// A clean hour.
FaultOutcome s2b(const RowRun& row) {
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  run.run(row.span(3600 * kSecond));
  FaultOutcome out = run.outcome();
  find(out, run.auditor().report().stops, "false alarms");
  find(out, !run.engaged(), "not engaged at the end");
  measure(out, static_cast<double>(run.auditor().report().stops), 0.0);
  return out;
}

namespace {

Vec3 tip_of(FaultRun& run) { return run.cell().slave().X_ST_command.p; }

}  // namespace

// One wild sample, a drift, twice the scale, two axes exchanged: in free space none of them leads
// the tip away from where it goes without.
FaultOutcome s3a(const RowRun& row) {
  constexpr double kAway = 1e-5;  // [m]
  FaultRun clean(row);
  FaultRun run(row);
  if (!clean.engage() || !run.engage()) return not_engaged();
  const Nanos from = run.now() + 300 * kMillisecond;
  const int axis = (row.index / 4) % 3;
  run.layers().force = [&](Nanos at, Wrench& f, bool&) {
    if (at < from) return;
    switch (row.index % 4) {
      case 0:
        if (at < from + kCycle) f.force[axis] += 200.0;  // one that a cycle reads
        break;
      case 1: f.force[axis] += std::min(1.5, 0.5 * to_seconds(at - from)); break;
      case 2: f.force *= 2.0; break;
      default: std::swap(f.force[axis], f.force[(axis + 1) % 3]);
    }
  };
  double away = 0.0;
  for (int i = 0; i < 5000; ++i) {
    clean.tick();
    run.tick();
    away = std::max(away, (tip_of(run) - tip_of(clean)).norm());
  }
  FaultOutcome out = run.outcome();
  find(out, away > kAway, "the tip went elsewhere");
  find(out, !run.engaged(), "not engaged");
  measure(out, away * 1e3, kAway * 1e3);
  return out;
}

// An axis at the end of its range is no reading.
FaultOutcome s3b(const RowRun& row) {
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  BadSpan span = bad_span(run, 1);
  run.layers().force = [&](Nanos at, Wrench& f, bool& valid) {
    if (!span.at(at)) return;
    f.force[row.index % 3] = 1000.0;
    valid = false;
  };
  return judge_readings(run, run, span);
}

// The stop circuit opens for a millisecond, bounces, or stays open.
FaultOutcome s4(const RowRun& row) {
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  run.run(run.up_to(kSecond));
  run.auditor().must_stop(run.now());
  const int level = row.index % 3;
  for (int i = 0; i < (level == 1 ? 5 : 1); ++i) {
    run.cell().open_stop_circuit(true);
    run.tick();
    if (level < 2) run.cell().open_stop_circuit(false);
    run.tick();
  }
  run.run(kSecond);
  const bool went_on = run.engaged();
  run.drive(5 * kSecond);
  const bool engaged_open = level == 2 && run.engaged();
  run.cell().open_stop_circuit(false);
  run.drive(5 * kSecond);
  const bool engaged = run.engaged();
  FaultOutcome out = run.outcome();
  find(out, went_on, "went on by itself");
  find(out, engaged_open, "engaged with the circuit open");
  find(out, !engaged, "not engaged again");
  return out;
}

namespace {

// Where a servo of up to 100 ms lag may be, within 0.01 rad and a cycle's way: outside, it does not
// follow.
class LagEnvelope {
 public:
  bool outside(const JointVector& command, const JointVector& measured, double dt) {
    if (!started_) lags_.fill(command);
    if (!started_) last_ = command;
    started_ = true;
    JointVector low = command, high = command;
    for (std::size_t i = 0; i < lags_.size(); ++i) {
      // The robot heard of the last command a cycle ago.
      const double lag = 0.002 * static_cast<double>(i + 1);
      lags_[i] += (last_ - lags_[i]) * (1.0 - std::exp(-dt / lag));
      low = low.cwiseMin(lags_[i]);
      high = high.cwiseMax(lags_[i]);
    }
    const JointVector room = JointVector::Constant(0.01) + (command - last_).cwiseAbs();
    last_ = command;
    return !((measured - low + room).minCoeff() >= 0.0 &&
             (high - measured + room).minCoeff() >= 0.0);
  }

 private:
  std::array<JointVector, 50> lags_;  // 2 to 100 ms
  JointVector last_;
  bool started_ = false;
};

}  // namespace

// A servo follows late, stops following, or runs away. Late ones within the envelope may go on.
FaultOutcome s5(const RowRun& row) {
  constexpr Nanos kFoundIn = 20 * kMillisecond;
  constexpr double kLateLag = 0.4;  // [s]
  constexpr double kRunaway = 0.5;  // [rad/s]
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  const int level = row.index % 3;
  const int joint = (row.index / 3) % 3;  // the first three carry the motion
  const Nanos from = run.now() + kSecond + run.up_to(kSecond);
  double q = 0.0;
  bool lost = false;
  Nanos beyond_since = kForever;
  LagEnvelope envelope;
  double commanded = 0.0;
  run.layers().reply = [&](Nanos at, RobotReply& reply) {
    const double dt = to_seconds(kCycle);
    if (at < from) q = reply.q_measured[joint];
    if (level == 0 && at >= from) q += (commanded - q) * (1.0 - std::exp(-dt / kLateLag));
    if (level == 2 && at >= from) q += kRunaway * dt;
    reply.q_measured[joint] = q;
    const bool outside = envelope.outside(run.cell().follow().q_target, reply.q_measured, dt);
    if (at < from || !outside) {
      beyond_since = kForever;
    } else if (beyond_since == kForever) {
      beyond_since = at;
    }
    // What only touches the limit need not be found.
    if (at - beyond_since >= kFoundIn && !lost) {
      lost = true;
      run.auditor().must_stop(beyond_since + kFoundIn);
    }
  };
  for (int i = 0; i < 6000; ++i) {
    commanded = run.cell().follow().q_target[joint];
    run.tick();
  }
  const bool engaged = run.engaged();
  FaultOutcome out = run.outcome();
  find(out, !lost && level > 0, "the fault was too small to matter");
  find(out, lost && engaged, "not found");
  return out;
}

}  // namespace handrail::rows
