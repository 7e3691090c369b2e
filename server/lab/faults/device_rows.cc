#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/lab/faults/fault_rows.h"

namespace handrail {
namespace {

constexpr Nanos kCycle = 7'100 * kMicrosecond;
constexpr std::array<double, 3> kBadNumbers = {std::numeric_limits<double>::quiet_NaN(),
                                               std::numeric_limits<double>::infinity(), 1e308};

// When and with what value a reading goes wrong.
struct BadSpan {
  Nanos from = 0;
  Nanos to = 0;
  double value = 0.0;

  bool at(Nanos now) const { return now >= from && now < to; }
};

// Levels: three numbers, each for one cycle, or for good.
BadSpan bad_span(FaultRun& run, int index) {
  run.run(static_cast<Nanos>(run.random().uniform() * 1e9));
  BadSpan span;
  span.from = run.now() + kMillisecond;
  span.to = index % 2 == 0 ? span.from + kCycle : kForever;
  span.value = kBadNumbers[static_cast<std::size_t>(index / 2) % kBadNumbers.size()];
  return span;
}

// One bad reading costs nothing anybody has to reset; a lasting fault is a stop after three cycles.
FaultOutcome judge_readings(FaultRun& run, const BadSpan& span) {
  run.run(3 * kCycle);
  if (span.to == kForever) run.auditor().must_stop(span.from + 3 * kCycle);
  run.run(2 * kSecond);
  const bool engaged = run.engaged();
  FaultOutcome out = run.outcome();
  if (span.to == kForever) {
    find(out, engaged, "still engaged");
  } else {
    find(out, !engaged, "not engaged after one bad reading");
    find(out, run.auditor().report().stops, "trips");
  }
  return out;
}

FaultOutcome s1a(std::uint64_t seed, int index) {
  FaultRun run(seed);
  if (!run.engage()) return not_engaged();
  const BadSpan span = bad_span(run, index);
  run.layers().force = [&](Nanos at, Wrench& f, bool&) {
    if (span.at(at)) f.force[index % 3] = span.value;
  };
  return judge_readings(run, span);
}

FaultOutcome s1b(std::uint64_t seed, int index) {
  FaultRun run(seed);
  if (!run.engage()) return not_engaged();
  const BadSpan span = bad_span(run, index);
  run.layers().reply = [&](Nanos at, RobotReply& reply) {
    if (span.at(at)) reply.q_measured[index % kJoints] = span.value;
  };
  return judge_readings(run, span);
}

// Without a hand the command stays, the force goes at once, and nothing has to be reset.
FaultOutcome s1c(std::uint64_t seed, int index) {
  FaultRun run(seed);
  if (!run.engage()) return not_engaged();
  const BadSpan span = bad_span(run, index);
  run.layers().hand = [&](Nanos at, HandReading& hand) {
    if (span.at(at)) hand.X_MH.p[index % 3] = span.value;
  };
  double force = 0.0;
  for (int i = 0; i < 1000; ++i) {
    run.tick();
    const bool bad = span.at(run.now() - kMillisecond);
    if (bad) force = std::max(force, run.cell().master().f_H_M.force.norm());
  }
  const bool moving = run.auditor().moving();
  FaultOutcome out = run.outcome();
  measure(out, force, 0.0);
  find(out, !(force <= 0.0), "force on a hand nobody knows");
  find(out, span.to == kForever && moving, "moving without a hand");
  find(out, !run.engaged(), "not engaged");
  return out;
}

// The sensor repeats its last reading bit for bit: a stop within 100 ms.
FaultOutcome s2a(std::uint64_t seed, int) {
  FaultRun run(seed);
  if (!run.engage()) return not_engaged();
  run.run(static_cast<Nanos>(run.random().uniform() * 1e9));
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
FaultOutcome s2b(std::uint64_t seed, int) {
  FaultRun run(seed);
  if (!run.engage()) return not_engaged();
  run.run(3600 * kSecond);
  FaultOutcome out = run.outcome();
  find(out, run.auditor().report().stops, "false alarms");
  find(out, !run.engaged(), "not engaged at the end");
  measure(out, static_cast<double>(run.auditor().report().stops), 0.0);
  return out;
}

Vec3 tip_of(FaultRun& run) { return run.cell().slave().X_ST_command.p; }

// One wild sample, a drift, twice the scale, two axes exchanged: in free space none of them leads
// the tip away from where it goes without.
FaultOutcome s3a(std::uint64_t seed, int index) {
  constexpr double kAway = 1e-5;  // [m]
  FaultRun clean(seed);
  FaultRun run(seed);
  if (!clean.engage() || !run.engage()) return not_engaged();
  const Nanos from = run.now() + 300 * kMillisecond;
  const int axis = (index / 4) % 3;
  run.layers().force = [&](Nanos at, Wrench& f, bool&) {
    if (at < from) return;
    switch (index % 4) {
      case 0:
        if (at < from + kCycle) f.force[axis] += 200.0;  // one that a cycle reads
        break;
      case 1:
        f.force[axis] += std::min(1.5, 0.5 * to_seconds(at - from));
        break;
      case 2:
        f.force *= 2.0;
        break;
      default:
        std::swap(f.force[axis], f.force[(axis + 1) % 3]);
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
FaultOutcome s3b(std::uint64_t seed, int index) {
  FaultRun run(seed);
  if (!run.engage()) return not_engaged();
  BadSpan span = bad_span(run, 2 * index + 1);
  run.layers().force = [&](Nanos at, Wrench& f, bool& valid) {
    if (!span.at(at)) return;
    f.force[index % 3] = 1000.0;
    valid = false;
  };
  return judge_readings(run, span);
}

// The stop circuit opens for a millisecond, bounces, or stays open.
FaultOutcome s4(std::uint64_t seed, int index) {
  FaultRun run(seed);
  if (!run.engage()) return not_engaged();
  run.run(static_cast<Nanos>(run.random().uniform() * 1e9));
  run.auditor().must_stop(run.now());
  const int level = index % 3;
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

// Where a servo of 25 to 70 ms lag may be: outside, it does not follow.
class LagEnvelope {
 public:
  bool outside(const JointVector& command, const JointVector& measured, double dt) {
    if (!started_) fast_ = slow_ = last_ = command;
    started_ = true;
    // The robot heard of the last command a cycle ago.
    fast_ += (last_ - fast_) * (1.0 - std::exp(-dt / 0.025));
    slow_ += (last_ - slow_) * (1.0 - std::exp(-dt / 0.070));
    const JointVector room = JointVector::Constant(0.03) + 0.5 * (command - last_).cwiseAbs();
    last_ = command;
    const JointVector low = fast_.cwiseMin(slow_) - room;
    const JointVector high = fast_.cwiseMax(slow_) + room;
    return !((measured - low).minCoeff() >= 0.0 && (high - measured).minCoeff() >= 0.0);
  }

 private:
  JointVector fast_;
  JointVector slow_;
  JointVector last_;
  bool started_ = false;
};

// A servo follows late, stops following, or runs away. Late ones within the envelope may go on.
FaultOutcome s5(std::uint64_t seed, int index) {
  constexpr double kLateLag = 0.4;  // [s]
  constexpr double kRunaway = 0.5;  // [rad/s]
  FaultRun run(seed);
  if (!run.engage()) return not_engaged();
  run.run(static_cast<Nanos>(run.random().uniform() * 1e9));
  const int level = index % 3;
  const int joint = (index / 3) % 3;  // the first three carry the motion
  double q = 0.0;
  bool failing = false;
  bool lost = false;
  LagEnvelope envelope;
  double commanded = 0.0;
  run.layers().reply = [&](Nanos at, RobotReply& reply) {
    const double dt = to_seconds(kCycle);
    if (!failing) q = reply.q_measured[joint];
    failing = true;
    if (level == 0) q += (commanded - q) * (1.0 - std::exp(-dt / kLateLag));
    if (level == 2) q += kRunaway * dt;
    reply.q_measured[joint] = q;
    if (envelope.outside(run.cell().follow().q_target, reply.q_measured, dt) && !lost) {
      lost = true;
      run.auditor().must_stop(at + Auditor::kWatchdog);
    }
  };
  for (int i = 0; i < 4000; ++i) {
    commanded = run.cell().follow().q_target[joint];
    run.tick();
  }
  const bool engaged = run.engaged();
  FaultOutcome out = run.outcome();
  find(out, !lost && level > 0, "the fault was too small to matter");
  find(out, lost && engaged, "not found");
  return out;
}

}  // namespace

const std::vector<FaultRow>& device_rows() {
  static const std::vector<FaultRow> rows = {
      {"S1a", "NaN, Inf or 1e308 from the force sensor", "ms to stop", 12, s1a},
      {"S1b", "NaN, Inf or 1e308 from an encoder", "ms to stop", 12, s1b},
      {"S1c", "NaN, Inf or 1e308 from the haptic device", "N", 12, s1c},
      {"S2a", "the force sensor repeats itself: found in 100 ms", "ms to stop", 10, s2a},
      {"S2b", "a clean hour: no false alarm", "false alarms", 1, s2b},
      {"S3a", "spike, drift, scale and exchanged axes of the sensor", "mm away", 12, s3a},
      {"S3b", "a saturated axis of the sensor", "ms to stop", 6, s3b},
      {"S4", "local stop circuit pressed, bouncing, open", "ms to stop", 9, s4},
      {"S5", "a servo follows late, stops following, runs away", "ms to stop", 9, s5},
  };
  return rows;
}

std::vector<FaultRow> fault_rows() {
  std::vector<FaultRow> all = network_rows();
  const auto add = [&](const std::vector<FaultRow>& more, char first, bool is) {
    std::copy_if(more.begin(), more.end(), std::back_inserter(all),
                 [&](const FaultRow& row) { return (row.id[0] == first) == is; });
  };
  add(process_rows(), 'X', false);
  add(device_rows(), 'X', false);
  add(process_rows(), 'X', true);
  return all;
}

}  // namespace handrail
