#include <algorithm>
#include <array>
#include <cmath>

#include "server/lab/faults/fault_rows.h"

namespace handrail::rows {
namespace {

constexpr Nanos kPeriod = kMxtPeriod;

// Every third run has 64-byte packets. Of the runs at all levels every second lot has a controller
// that queues, of four lots two a wrist turned briskly: joints at over half their rated speed.
FaultOptions robot_options(const RowRun& row, std::size_t levels) {
  const int lot = row.index / static_cast<int>(levels);
  FaultOptions options;
  options.queues = lot % 2 == 1;
  options.brisk = (lot / 2) % 2 == 1;
  options.short_form = row.index % 3 == 1;
  return options;
}

// What the controller accepted, as a share of what it may be asked.
FaultOutcome judge_controller(FaultRun& run) {
  FaultOutcome out = run.outcome();
  measure(out, run.controller().worst().worst(), 1.0);
  return out;
}

// The same of a run that has to end engaged.
FaultOutcome judge_led(FaultRun& run, const char* if_not) {
  const bool engaged = run.engaged();
  FaultOutcome out = judge_controller(run);
  find(out, !engaged, if_not);
  return out;
}

// However fast it was, an arm stands so long after its stop: v/a + 2.5 a/j of the slowest joint,
// 0.2 s, and the 29 ms that the stop may be late.
constexpr Nanos kStops = 250 * kMillisecond;
// So soon after the robot fell silent a gentle hand's stop ends within the 14 cycles that the slave
// plans on for.
constexpr Nanos kEarly = 20 * kMillisecond;

// Of a busy computer's packets, each way.
constexpr std::array<double, 5> kBusyLosses = {0.0, 0.01, 0.03, 0.05, 0.1};

// How far the controller moves any joint in the next second [rad].
double moved_in_a_second(FaultRun& run) {
  const ServoArm& arm = run.cell().rig().controller().arm();
  const JointVector q = arm.target();
  double moved = 0.0;
  for (const Nanos end = run.now() + kSecond; run.now() < end;) {
    run.tick();
    moved = std::max(moved, (arm.target() - q).cwiseAbs().maxCoeff());
  }
  return moved;
}

// The slave's program stands still.
void stand(FaultRun& run, Nanos span) {
  run.cell().net()->stop_slave(true);
  run.run(span);
  run.cell().net()->stop_slave(false);
}

// What happens while the controller is not heard.
enum class Meanwhile { kNothing, kStop, kStopCircuit, kCount };

// The slave stops for 5 ms to a minute, alone or with the master: the computers sleep. Every other
// time the way between them is so long that what was sent before still comes after they wake, and
// is read before the first step.
FaultOutcome paused(const RowRun& row, bool both) {
  constexpr std::array<int, 7> kSpans = {5, 12, 20, 60, 250, 5000, 60'000};
  const Nanos span = row.level(kSpans) * kMillisecond;
  FaultRun run(row, robot_options(row, kSpans.size()));
  const bool far = both && row.index % 2 == 0;
  if (far) {
    LinkFaults way;
    way.delay = 300 * kMillisecond;
    run.set_network(way);
  }
  if (!run.engage()) return not_engaged();
  run.run(run.up_to(kSecond));
  run.let_pause();
  CellNet& net = *run.cell().net();
  const auto sleep = [&](bool asleep) {
    net.stop_slave(asleep);
    if (both) net.stop_master(asleep);
    if (far) net.deliver(run.now());
  };
  sleep(true);
  run.run(span);
  if (far) {
    // What waits is dropped; what comes in the next millisecond looks new.
    sleep(false);
    sleep(true);
    run.tick();
  }
  sleep(false);
  run.run(2 * kPeriod);
  // Nobody engages: longer than the link may be silent, both have let go.
  bool went_on = false;
  for (int i = 0; i < 1000; ++i) {
    went_on = went_on || (span > Auditor::kLatch && run.engaged());
    run.tick();
  }
  run.drive(6 * kSecond);
  const bool engaged = run.engaged();
  FaultOutcome out = judge_controller(run);
  find(out, went_on, "engaged after a long pause");
  find(out, !engaged, "not engaged again");
  return out;
}
}  // namespace

// Packets lost each way.
FaultOutcome r1a(const RowRun& row) {
  constexpr std::array<double, 5> kLosses = {0.001, 0.01, 0.03, 0.05, 0.1};
  FaultRun run(row, robot_options(row, kLosses.size()));
  if (!run.engage()) return not_engaged();
  LinkFaults faults;
  faults.loss = row.level(kLosses);
  run.set_robot_line(faults, faults);
  run.run(row.span(30 * kSecond));
  return judge_led(run, "not engaged at the end");
}

// Replies late by up to a period, twice, both, out of order, or now and then by up to two, as those
// of a busy computer; commands late by up to half a period, or twice; or both ways long from the
// start, and packets lost: of up to 1.55 ms each, which wavers by 0.3 ms, or so long that the
// session must not open. A controller that queues plays what comes twice for two cycles, as it does
// what comes after its cycle: those holds are its own, and it is spared them here.
FaultOutcome r1b(const RowRun& row) {
  constexpr int kLevels = 7;  // [cases]: those below
  const FaultOptions options = robot_options(row, kLevels);
  FaultRun run(row, options);
  LinkFaults replies, commands;
  bool far = false, in_bursts = false;
  switch (row.index % kLevels) {
    case 0: replies.delay = replies.jitter = kPeriod / 2; break;
    case 1:
      replies.duplicate = 0.1;
      commands.duplicate = options.queues ? 0.0 : 0.1;
      break;
    case 2:
      replies.reorder = replies.duplicate = 0.1;
      replies.reorder_by = kPeriod * 9 / 10;
      break;
    case 3:
      replies.loss = commands.loss = 0.02;
      replies.duplicate = 0.05;
      replies.delay = replies.jitter = kPeriod / 4;
      break;
    case 4: commands.delay = commands.jitter = kPeriod / 4; break;
    case 5: in_bursts = true; break;
    default:
      far = row.index / kLevels % 4 % 3 != 0;  // of four lots two
      // Over a way that is longer by 2 ms an answer is given up in any case.
      commands.delay = from_seconds(far ? 0.0022 + 0.002 * run.random().uniform()
                                        : 0.00125 * run.random().uniform());
      commands.jitter = 300 * kMicrosecond;
      commands.loss = 0.02;
      commands.duplicate = options.queues ? 0.0 : 0.02;
      replies = commands;
      replies.duplicate = 0.02;
      run.set_robot_line(commands, replies);
  }
  const bool opened = run.engage();
  if (far) {
    FaultOutcome out = judge_controller(run);
    find(out, opened, "engaged over too long a way");
    return out;
  }
  if (!opened) return not_engaged();
  run.set_robot_line(commands, replies);
  for (const Nanos end = run.now() + row.span(30 * kSecond); run.now() < end;) {
    if (!in_bursts) {
      run.run(end - run.now());
      break;
    }
    replies.delay = replies.jitter = kPeriod;
    run.set_robot_line(commands, replies);
    run.run(run.up_to(kSecond / 10));
    run.set_robot_line(commands, {});
    run.run(run.up_to(kSecond / 2));
  }
  return judge_led(run, "not engaged at the end");
}

// The controller is silent for 10 ms to 1.4 s, or only the way to it or back is dark. In every
// other run the hand goes so gently that a whole stop is within a step of the last target heard.
FaultOutcome r2(const RowRun& row) {
  constexpr std::array<int, 5> kSpans = {10, 30, 100, 500, 1400};
  const Nanos span = row.level(kSpans) * kMillisecond;
  const auto meanwhile = static_cast<Meanwhile>(row.index % static_cast<int>(Meanwhile::kCount));
  FaultOptions options = robot_options(row, kSpans.size());
  options.gentle = row.index % 2 == 0;
  FaultRun run(row, options);
  if (!run.engage()) return not_engaged();
  run.run(run.up_to(kSecond));
  LinkFaults dark;
  dark.loss = 1.0;
  const int way = static_cast<int>(run.random().uniform() * 3.0);
  run.set_robot_line(way == 1 ? LinkFaults() : dark, way == 2 ? LinkFaults() : dark);
  // In the middle; or so early that the slave, which plans on for 14 cycles, ends its stop unheard.
  const Nanos until = run.random().uniform() < 0.5 ? span / 2 : std::min(span / 2, kEarly);
  run.run(until);
  if (meanwhile == Meanwhile::kStop) run.tick(order_of(OrderKind::kStop));
  if (meanwhile == Meanwhile::kStopCircuit) {
    run.cell().open_stop_circuit(true);
    run.tick();
    run.cell().open_stop_circuit(false);
  }
  // What the slave decides in its next cycle, silent or not.
  if (meanwhile != Meanwhile::kNothing) run.auditor().must_stop(run.now());
  run.run(span - until);
  run.set_robot_line({}, {});
  const double moved = moved_in_a_second(run);
  const bool stood = meanwhile != Meanwhile::kNothing && span - until >= kStops;
  const bool went_on = run.engaged() != (meanwhile == Meanwhile::kNothing);
  run.drive(5 * kSecond);
  const bool engaged = run.engaged();
  FaultOutcome out = judge_controller(run);
  find(out, went_on, "stop or silence not as before after it");
  find(out, stood && moved > 0.0, "moved after it had stood");
  find(out, !engaged, "not engaged again");
  return out;
}

FaultOutcome r3(const RowRun& row) { return paused(row, false); }
FaultOutcome r4(const RowRun& row) { return paused(row, true); }

// A busy computer: now and then the slave stands for up to a cycle. What it then sends may miss its
// cycle, and what it reads be late. Either way takes up to 0.6 ms.
FaultOutcome r3b(const RowRun& row) {
  FaultRun run(row, robot_options(row, kBusyLosses.size()));
  LinkFaults faults;
  faults.loss = row.level(kBusyLosses);
  faults.delay = faults.jitter = 300 * kMicrosecond;
  run.set_robot_line(faults, faults);
  if (!run.engage()) return not_engaged();
  run.let_pause();
  for (const Nanos end = run.now() + row.span(30 * kSecond); run.now() < end;) {
    stand(run, run.up_to(kPeriod));
    run.run(run.up_to(kSecond / 10));
  }
  return judge_led(run, "not engaged at the end");
}

// A computer that is taken away now and then, for up to three cycles, with the slave and with what
// simulates the controller: replies come late and together, and are read late. For spells replies
// take up to 3 ms, and the slave stands for as long. Or nothing is heard for 0.1 to 0.2 s.
FaultOutcome r3c(const RowRun& row) {
  FaultRun run(row, robot_options(row, kBusyLosses.size()));
  LinkFaults usual;
  usual.loss = row.level(kBusyLosses);
  usual.delay = usual.jitter = 100 * kMicrosecond;
  run.set_robot_line(usual, usual);
  if (!run.engage()) return not_engaged();
  run.let_pause();
  LinkFaults late = usual, dark = usual;
  dark.loss = 1.0;
  for (const Nanos end = run.now() + row.span(30 * kSecond); run.now() < end;) {
    const Nanos from = run.now();
    const double kind = run.random().uniform();
    if (kind < 0.4) {
      late.delay = run.up_to(3 * kPeriod);
      run.set_robot_line(usual, late);
      stand(run, late.delay + run.up_to(kMillisecond));
    } else if (kind < 0.9) {
      for (const Nanos until = from + run.up_to(7 * kPeriod); run.now() < until;) {
        late.delay = run.up_to(3 * kMillisecond);
        run.set_robot_line(usual, late);
        stand(run, run.up_to(3 * kMillisecond));
        run.run(run.up_to(kPeriod));
      }
    } else {
      run.set_robot_line(dark, dark);
      run.run(kSecond / 10 + run.up_to(kSecond / 10));
      run.set_robot_line(usual, usual);
      stand(run, run.up_to(kPeriod));
    }
    run.set_robot_line(usual, usual);
    run.run(run.up_to(kSecond / 20));
  }
  run.set_robot_line({}, {});
  run.drive(6 * kSecond);
  return judge_led(run, "not engaged again");
}

// The encoders read zero, or beyond a joint's range, from one moment on.
FaultOutcome r5(const RowRun& row) {
  FaultOptions options;
  options.short_form = row.index % 3 == 1;
  FaultRun run(row, options);
  if (!run.engage()) return not_engaged();
  run.run(run.up_to(kSecond));
  const Nanos from = run.now() + kMillisecond;
  const int joint = row.index % kJoints;
  run.layers().reply = [&](Nanos at, RobotReply& reply) {
    if (at < from) return;
    if (row.index % 2 == 0) {
      reply.q_measured.setZero();
    } else {
      reply.q_measured[joint] = rv2a_limits().upper[joint] + 0.1;
    }
  };
  run.run(22 * kMillisecond);
  run.auditor().must_stop(from + 3 * kPeriod);
  run.run(kSecond);
  const SlaveState told = run.cell().slave();
  // What was lost is not had back by a reset.
  run.drive(3 * kSecond);
  const bool engaged = run.engaged();
  FaultOutcome out = run.outcome();
  find(out, told.fault != Reason::kEncoderInvalid, "not found");
  find(out, told.ledger.joint < 0, "no joint named");
  find(out, engaged, "engaged with a blind arm");
  return out;
}

}  // namespace handrail::rows
