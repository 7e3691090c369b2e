#include <algorithm>
#include <array>

#include "server/base/fnv.h"
#include "server/lab/faults/fault_rows.h"

namespace handrail::rows {

// The master stopped for 5 ms to 10 s, or killed and started anew; what waited comes in a burst.
FaultOutcome p1(const RowRun& row) {
  constexpr std::array<int, 6> kSpans = {5, 30, 150, 1000, 10'000, 1000};
  const bool killed = &row.level(kSpans) == &kSpans.back();
  const Nanos span = row.level(kSpans) * kMillisecond;
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  run.run(run.up_to(kSecond));
  run.cell().net()->stop_master(true);
  run.run(span);
  if (killed) run.restart_master();
  run.cell().net()->stop_master(false);
  run.run(kSecond);
  if (span > Auditor::kLatch) run.drive(6 * kSecond);
  const bool engaged = run.engaged();
  FaultOutcome out = run.outcome();
  find(out, !engaged, "not engaged again");
  return out;
}

// The haptic thread stands still for 50 ms or for good; its process goes on.
FaultOutcome p5(const RowRun& row) {
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  run.run(run.up_to(kSecond));
  run.stall_master(true);
  run.run(row.index % 2 == 0 ? 50 * kMillisecond : 2 * kSecond);
  run.stall_master(false);
  run.run(kSecond);
  return run.outcome();
}

namespace {

std::uint64_t joints_after(FaultRun& run, Nanos span) {
  Fnv fnv;
  for (const Nanos end = run.now() + span; run.now() < end;) {
    run.tick();
    for (int i = 0; i < kJoints; ++i) fnv.f64(run.cell().follow().q_target[i]);
  }
  return fnv.value();
}

}  // namespace

// The two monotonic clocks are 5000 s apart: the same bits as without, over a bad network too.
FaultOutcome c2(const RowRun& row) {
  constexpr Nanos kOff = 5000 * kSecond;
  FaultRun plain(row);
  FaultOptions clocks;
  (row.index % 2 == 0 ? clocks.master_clock : clocks.slave_clock) = kOff;
  FaultRun off(row, clocks);
  LinkFaults faults;
  faults.delay = 20 * kMillisecond;
  faults.jitter = 5 * kMillisecond;
  faults.burst_enter = 0.005;
  faults.burst_leave = 0.1;
  std::array<std::uint64_t, 2> bits{};
  for (std::size_t i = 0; i < 2; ++i) {
    FaultRun& run = i == 0 ? plain : off;
    if (!run.engage()) return not_engaged();
    run.set_network(faults);
    bits[i] = joints_after(run, 10 * kSecond);
  }
  FaultOutcome out = off.outcome();
  find(out, bits[0] != bits[1], "moved otherwise");
  return out;
}

namespace {

Vec3 random_vector(Random& random, double size) {
  Vec3 out;
  for (int k = 0; k < 3; ++k) out[k] = size * (2.0 * random.uniform() - 1.0);
  return out;
}

Quat random_turn(Random& random, double angle) {
  return Quat(Eigen::AngleAxisd(angle * random.uniform(), random_vector(random, 1.0).normalized()));
}

Vec3 any_direction(Random& random) { return random_vector(random, 1.0).normalized(); }

ToolDefinition hostile_tool(Random& random, const Vec3& p, std::uint32_t epoch) {
  ToolDefinition tool;
  tool.epoch = epoch;
  const double kind = random.uniform();
  if (kind < 0.25) return tool;
  tool.id = epoch;
  tool.p_SA = p + random_vector(random, 0.03);
  if (kind < 0.5) {
    tool.kind = ToolKind::kPoint;
  } else if (kind < 0.75) {
    tool.kind = ToolKind::kLine;
    tool.direction_S = random_vector(random, 1.0).normalized();
  } else {
    tool.kind = ToolKind::kPlane;
    tool.normal_S = random_vector(random, 1.0).normalized();
  }
  return tool;
}

}  // namespace

// An authentic master gone mad: every 20 ms another sequence of commands, jumps, noise, fast sines,
// the ends of reach, and tools that change under way.
FaultOutcome x2b(const RowRun& row) {
  // With its noise nearer than 10 m: what is further off no master sends, and its silence would end
  // the session.
  constexpr double kFar = 9.9;  // [m]
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  Random& random = run.random();
  MasterState state = run.cell().master().link;
  const Pose home = state.X_SU;
  Pose aim = home;
  double noise = 0.0;
  run.send_instead(&state);
  for (int sequence = 0; sequence < 2500; ++sequence) {
    const double kind = random.uniform();
    if (kind < 0.2) aim.p = home.p + random_vector(random, 0.6);
    if (kind >= 0.2 && kind < 0.5) aim.p = home.p + random_vector(random, 0.08);
    if (kind >= 0.5 && kind < 0.6) aim.p = kFar * random.uniform() * any_direction(random);
    if (kind >= 0.6 && kind < 0.8) aim.q = random_turn(random, 1.5) * home.q;
    if (kind >= 0.8) noise = random.uniform() < 0.5 ? 0.0 : 0.02 * random.uniform();
    if (random.uniform() < 0.02) {
      const std::uint32_t epoch = state.position_tool.epoch + 1;
      state.position_tool = hostile_tool(random, run.auditor().tip(), epoch);
    }
    for (int i = 0; i < 20; ++i) {
      state.X_SU.p = aim.p + random_vector(random, noise);
      state.X_SU.q = aim.q;
      run.tick();
    }
  }
  FaultOutcome out = run.outcome();
  const AuditReport& report = run.auditor().report();
  measure(out, std::max({report.speed, report.acceleration, report.jerk}), 1.0);
  find(out, run.cell().net()->master().snapshot().unsendable, "commands that were never sent");
  find(out, report.moved < report.cycles / 2, "hardly moved: nothing was tried");
  return out;
}

// A hand that goes far out of the arm's reach, turns, and stands. While it stands the arm goes no
// further from it.
FaultOutcome x2d(const RowRun& row) {
  constexpr int kWay = 1400;     // [ms]
  constexpr int kStands = 6000;  // [ms]
  constexpr Nanos kComesToRest = 400 * kMillisecond;
  FaultRun run(row);
  const Vec3 way = (0.1 + 0.4 * run.random().uniform()) * any_direction(run.random());
  const Vec3 turn = 1.5 * run.random().uniform() * any_direction(run.random());
  double done = 0.0;
  run.layers().hand = [&](Nanos, HandReading& hand) {
    hand.X_MH.p = done * way;
    hand.X_MH.q = rotation_exp(done * turn);
    hand.v_MH.setZero();
  };
  if (!run.engage()) return not_engaged();
  for (int i = 1; i <= kWay; ++i) {
    done = static_cast<double>(i) / kWay;
    run.tick();
  }
  run.run(kComesToRest);
  double nearest = run.auditor().behind(), away = 0.0;
  for (int i = 0; i < kStands; ++i) {
    run.tick();
    nearest = std::min(nearest, run.auditor().behind());
    away = std::max(away, run.auditor().behind() - nearest);
  }
  FaultOutcome out = run.outcome();
  // A hand in reach is gone to, whatever the way: the auditor judges that.
  const double left = nearest > Auditor::kRoom ? away : 0.0;
  measure(out, 1e3 * left, 1e3 * Auditor::kRoom);
  find(out, left > Auditor::kRoom, "left a hand that stands");
  return out;
}

// A second master talks to the slave at the same time, engaging and leading elsewhere.
FaultOutcome x9a(const RowRun& row) {
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  MasterPeer second(run.random().bits() | 1);
  std::array<std::uint8_t, kMaxDatagram> bytes{};
  for (int i = 0; i < 10'000; ++i) {
    MasterState state = run.cell().master().link;
    state.state = i % 3000 < 500 ? SessionState::kAligning : SessionState::kEngaged;
    state.X_SU.p += Vec3(0.05, 0.0, 0.0);
    const std::size_t size = second.poll(run.now(), state, bytes);
    run.cell().net()->link().to_slave().inject(std::span(bytes).first(size), run.now());
    run.tick();
  }
  FaultOutcome out = run.outcome();
  const std::uint64_t accepted = run.cell().net()->slave().snapshot().accepted;
  measure(out, static_cast<double>(accepted) - static_cast<double>(run.auditor().report().fresh),
          0.0);
  find(out, out.worst != 0.0, "datagrams of the second master applied");
  find(out, run.auditor().report().stops, "trips");
  find(out, !run.engaged(), "not engaged at the end");
  return out;
}

}  // namespace handrail::rows
