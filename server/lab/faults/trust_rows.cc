#include <array>
#include <cmath>
#include <limits>

#include "server/lab/faults/contact_push.h"
#include "server/lab/faults/fault_rows.h"

namespace handrail::rows {
namespace {

constexpr double kHasty = 0.1;  // of the hand, faster than the promise ever allows [m/s]

}  // namespace

// Encoders off by almost as much as is believed, for a cycle each, before a hasty contact.
FaultOutcome s1e(const RowRun& row) {
  constexpr double kGlitch = 0.09;  // [rad]
  Push push(row, true);
  push.speed = kHasty;
  const Nanos patience = 5 * kSecond;
  if (!push.roam(patience)) return not_engaged();
  const Nanos from = push.run.now() + kMillisecond;
  push.run.layers().reply = [&](Nanos at, RobotReply& reply) {
    const Nanos cycle = (at - from) / Push::kCycle;
    if (at < from || cycle >= 18 || cycle % 6 != 0) return;
    reply.q_measured[row.index % kJoints] += row.index < kJoints ? kGlitch : -kGlitch;
  };
  push.pass(18 * Push::kCycle);
  push.go_down();
  push.pass(5 * kSecond);
  const bool engaged = push.run.engaged();
  FaultOutcome out = push.outcome();
  find(out, !engaged, "not engaged after single glitches");
  return out;
}

// An encoder that is wrong for a tenth of a second stops the arm; reset, it is led to a hasty
// contact at once.
FaultOutcome s1f(const RowRun& row) {
  constexpr std::array<double, 3> kWrong = {0.5, -0.5, std::numeric_limits<double>::quiet_NaN()};
  Push push(row, true);
  push.speed = kHasty;
  if (!push.roam(5 * kSecond)) return not_engaged();
  const Nanos from = push.run.now() + kMillisecond;
  push.run.layers().reply = [&](Nanos at, RobotReply& reply) {
    if (at < from || at >= from + 100 * kMillisecond) return;
    reply.q_measured[row.index % kJoints] += row.level(kWrong);
  };
  push.pass(20 * kMillisecond);
  push.run.auditor().must_stop(from + 3 * Push::kCycle);
  push.pass(200 * kMillisecond);
  const bool went_on = push.run.engaged();
  for (int i = 0; i < 5000 && !push.run.engaged(); ++i) push.pass(kMillisecond, true);
  push.go_down();
  push.pass(5 * kSecond);
  const bool engaged = push.run.engaged();
  FaultOutcome out = push.outcome();
  find(out, went_on, "not found");
  find(out, !engaged, "not engaged again");
  return out;
}

// Packets to and from the robot's controller are lost, before a hasty contact and in it.
FaultOutcome r1c(const RowRun& row) {
  constexpr std::array<double, 4> kLost = {0.01, 0.02, 0.05, 0.1};  // each way
  Push push(row, true);
  LinkFaults faults;
  faults.loss = row.level(kLost);
  push.run.set_robot_line(faults, faults);
  push.speed = kHasty;
  if (!push.roam(5 * kSecond)) return not_engaged();
  push.go_down();
  push.pass(5 * kSecond);
  const bool engaged = push.run.engaged();
  FaultOutcome out = push.outcome();
  find(out, !engaged, "not engaged");
  find(out, push.peak < 30.0, "no contact");
  return out;
}

// Ten minutes of contacts that come, rest or slide, and go, with a sensor that has no noise. Every
// other hand trembles.
FaultOutcome s2d(const RowRun& row) {
  FaultOptions options;
  options.sensor_noise = false;
  Push push(row, row.index % 4 >= 2, options);
  const auto lead = push.run.layers().hand;
  push.run.layers().hand = [&](Nanos at, HandReading& hand) {
    lead(at, hand);
    if (row.index % 2 == 1) hand.X_MH.p.z() += 1e-4 * std::sin(62.8 * to_seconds(at));
  };
  if (!push.begin()) return not_engaged();
  Random& random = push.run.random();
  for (const Nanos end = push.run.now() + row.span(600 * kSecond); push.run.now() < end;) {
    push.go_down();
    push.pass(static_cast<Nanos>(20e9 * random.uniform()));
    push.retreat();
    push.pass(static_cast<Nanos>(5e9 * random.uniform()));
  }
  const bool engaged = push.run.engaged();
  FaultOutcome out = push.outcome();
  find(out, !engaged, "not engaged at the end");
  return out;
}

// A sensor without noise repeats itself in a contact that is gone into or left: a stop within 100
// ms of what its load must have changed by. Where the tip slides as well, a surface that falls off
// as the friction's cone does might explain it for a while: before the promise is passed.
FaultOutcome s2e(const RowRun& row) {
  // Half a millimetre, and four deviations of what the encoders are off, at 57 N/mm [N].
  constexpr double kChanged = 45.0;
  const bool leaves = row.index % 3 == 1, slides = row.index % 3 == 2;
  FaultOptions options;
  options.sensor_noise = false;
  Push push(row, slides, options);
  if (!push.begin()) return not_engaged();
  if (push.pass_until(12.0 + 20.0 * push.run.random().uniform()) == kForever) return not_engaged();
  if (leaves) push.pass(5 * kSecond);
  const double force = push.run.true_force();
  push.freeze_sensor();
  if (leaves) push.retreat();
  const auto changed = [&] {
    return slides ? !push.run.engaged() : std::abs(push.run.true_force() - force) > kChanged;
  };
  for (int i = 0; i < 5000 && !changed(); ++i) push.pass(kMillisecond);
  push.run.auditor().must_stop(push.run.now() + (slides ? 0 : 100 * kMillisecond));
  push.pass(3 * kSecond);
  const bool engaged = push.run.engaged();
  FaultOutcome out = push.outcome(true);
  find(out, engaged, "not found");
  return out;
}

}  // namespace handrail::rows
