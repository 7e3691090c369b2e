#include <algorithm>
#include <array>
#include <vector>

#include "server/lab/faults/fault_rows.h"
#include "server/master/lease.h"

namespace handrail::rows {

// Over a link that is not GOOD nobody engages; one that turns POOR holds the arm.
FaultOutcome n1d(const RowRun& row) {
  FaultRun run(row);
  run.let_hold();
  LinkFaults faults;
  std::uint64_t engaged = 0;
  if (row.index % 2 == 0) {
    faults.loss = 0.4;
    run.set_network(faults);
    for (int i = 0; i < 5000; ++i) {
      run.tick(order_of(OrderKind::kEngage));
      engaged += run.engaged();
    }
  } else {
    if (!run.engage()) return not_engaged();
    faults.loss = 0.75;
    run.set_network(faults);
    run.run(500 * kMillisecond);
    for (int i = 0; i < 2000; ++i) {
      run.tick();
      engaged += run.engaged();
    }
  }
  // Of 100 datagrams as many may come by luck, now and then.
  FaultOutcome out = run.outcome();
  measure(out, static_cast<double>(engaged), 50.0);
  find(out, engaged > 50, "ms engaged over a link that is not good");
  return out;
}

// Whoever held the device lets go: the arm comes to rest, and after two seconds the engagement
// ends. At rest is what creeps by less than a tenth of the arm's repeatability of 0.04 mm: out of
// reach the tip wavers by a micrometre about the nearest place it can go to.
FaultOutcome s6(const RowRun& row) {
  constexpr double kRest = 4e-6;  // of the tip's commands [m]
  FaultOptions options;
  options.presence = Presence::kButton;
  FaultRun run(row, options);
  bool held = true;
  run.layers().hand = [&](Nanos, HandReading& hand) { hand.enable_button = held; };
  if (!run.engage()) return not_engaged();
  run.run(run.up_to(kSecond));
  held = false;
  run.tick();
  const Vec3 command = run.cell().master().link.X_SU.p;
  run.run(500 * kMillisecond);
  const bool led_on = (run.cell().master().link.X_SU.p - command).norm() > 0.0;
  const Vec3 tip = run.auditor().tip();
  double crept = 0.0;
  for (int i = 0; i < 2000; ++i) {
    run.tick();
    crept = std::max(crept, (run.auditor().tip() - tip).norm());
  }
  const bool engaged = run.engaged();
  held = true;
  run.run(kSecond);
  FaultOutcome out = run.outcome();
  find(out, led_on, "led by nobody");
  measure(out, crept * 1e6, kRest * 1e6);
  find(out, crept > kRest, "moving half a second later");
  find(out, engaged, "still engaged");
  find(out, run.engaged(), "engaged by itself");
  return out;
}

// The operator's stop at 30 % loss is latched there and echoed; and a datagram with a stop stops,
// whatever else it says.
FaultOutcome x4(const RowRun& row) {
  constexpr Nanos kEcho = 50 * kMillisecond;
  FaultRun run(row);
  if (!run.engage()) return not_engaged();
  run.run(run.up_to(kSecond));
  MasterState mad = run.cell().master().link;
  const Nanos from = run.now();
  if (row.index % 2 == 0) {
    LinkFaults faults;
    faults.loss = 0.3;
    run.set_network(faults);
    run.tick(order_of(OrderKind::kStop));
  } else {
    ++mad.stop_epoch;
    run.send_instead(&mad);
  }
  Nanos echo = -1;
  for (int i = 0; i < 1000; ++i) {
    mad.X_SU.p.y() += 1e-4;
    run.tick();
    const std::uint64_t epoch =
        row.index % 2 == 0 ? run.cell().master().link.stop_epoch : mad.stop_epoch;
    if (echo < 0 && run.cell().slave().stop_epoch == epoch) echo = run.now() - from;
  }
  const bool latched = run.cell().slave().state == SessionState::kFault;
  FaultOutcome out = run.outcome();
  find(out, echo < 0 || echo > kEcho, "the stop was not echoed");
  find(out, !latched, "the stop was not latched");
  return out;
}

// All datagrams of an engagement and a drive, recorded and played to a slave that has just started,
// its arm where the recording began.
FaultOutcome x11(const RowRun& row) {
  std::vector<std::vector<std::uint8_t>> recording;
  FaultRun live(row);
  for (int i = 0; i < 6000; ++i) {
    live.tick(order_of(i < 3000 && !live.engaged() ? OrderKind::kEngage : OrderKind::kNone));
    const auto bytes = live.cell().net()->link().to_slave().newest();
    recording.emplace_back(bytes.begin(), bytes.end());
  }
  FaultRun run(row.next());
  run.cell().net()->stop_master(true);
  std::uint64_t engaged = 0;
  for (const std::vector<std::uint8_t>& datagram : recording) {
    run.cell().net()->link().to_slave().inject(datagram, run.now());
    run.tick();
    engaged += run.engaged();
  }
  FaultOutcome out = run.outcome();
  find(out, !live.engaged() || live.auditor().report().moved < 100, "nothing was recorded");
  find(out, engaged, "ms engaged with a recording");
  measure(out, static_cast<double>(run.auditor().report().moved), 0.0);
  return out;
}

// Two operators give orders all the time; each order of somebody who does not hold the lease
// reaches the arm's master if the lease is no lock.
FaultOutcome x9b(const RowRun& row) {
  Random random(row.seed);
  Lease lease;
  constexpr std::array<const char*, 2> kNames = {"anna", "ben"};
  Nanos now = 0;
  std::uint64_t both = 0;
  std::uint64_t changes = 0;
  int driver = -1;
  for (int i = 0; i < 100'000; ++i) {
    now += static_cast<Nanos>(random.uniform() * 4e7);
    lease.poll(driver >= 0, now);
    const int who = random.uniform() < 0.5 ? 0 : 1;
    const std::string name = kNames[static_cast<std::size_t>(who)];
    if (random.uniform() < 0.001 && who == driver) {
      // Whoever drives gives it back: only from then on may it be another.
      if (lease.release(name, now).allowed) driver = -1;
      continue;
    }
    if (!lease.drive(name, true, now).allowed) continue;
    if (driver >= 0 && driver != who) ++both;
    changes += driver < 0;
    driver = who;
  }
  FaultOutcome out;
  measure(out, static_cast<double>(both), 0.0);
  find(out, both, "orders of two operators at a time");
  find(out, changes < 10, "the lease hardly changed hands");
  return out;
}

// A master that speaks the protocol and holds another scene: it engages nothing, and what the right
// one had engaged ends.
FaultOutcome d3(const RowRun& row) {
  constexpr Nanos kHeard = 20 * kMillisecond;  // the first such datagram, and a robot cycle
  FaultRun run(row);
  run.let_hold();
  if (row.index % 2 == 0 && !run.engage()) return not_engaged();
  run.run(kSecond);
  MasterState other = run.cell().master().link;
  const std::array<Reason, 4> reasons = {Reason::kSceneDiffers, Reason::kHashMapping,
                                         Reason::kHashLimits, Reason::kHashRobot};
  const auto what = static_cast<std::size_t>(row.index / 2) % reasons.size();
  if (what == 0) other.scene = SceneName();
  if (what == 1) other.hashes.mapping ^= 1;
  if (what == 2) other.hashes.limits ^= 1;
  if (what == 3) other.hashes.robot ^= 1;
  other.desired = Desired::kEngaged;
  other.has_command = true;
  run.send_instead(&other);
  const Nanos from = run.now();
  std::uint64_t engaged = 0;
  for (int i = 0; i < 3000; ++i) {
    const SlaveState& slave = run.cell().slave();
    if (follows(slave.state)) {
      other.state = SessionState::kEngaged;
      other.X_SU.p.y() += 1e-4;
    } else {
      other.state = SessionState::kAligning;
      other.X_SU = slave.X_ST_command;
    }
    run.tick();
    engaged += run.engaged() && run.now() - from > kHeard;
  }
  const bool named = run.cell().slave().reason == reasons[what];
  FaultOutcome out = run.outcome();
  measure(out, static_cast<double>(engaged), 0.0);
  find(out, engaged, "ms engaged with another scene");
  find(out, !named, "the difference is not named");
  return out;
}

// A minute of orders, faults and restarts as they come, over a link that is late: no reset but one
// given after a fault releases it, and no stop is echoed before the slave can have it.
FaultOutcome p8(const RowRun& row) {
  FaultRun run(row);
  run.let_hold();
  if (!run.engage()) return not_engaged();
  LinkFaults late;
  late.delay = 10 * kMillisecond;
  late.jitter = 8 * kMillisecond;
  late.loss = 0.05;
  run.set_network(late);
  Random& random = run.random();
  SlaveState before = run.cell().slave();
  Nanos latched = -1, reset = -1;
  std::uint64_t unseen = 0, early = 0, releases = 0;
  for (int i = 0; i < 60'000; ++i) {
    OrderKind order = OrderKind::kNone;
    const double what = 1e4 * random.uniform();
    if (what < 5.0) order = OrderKind::kStop;
    if (what >= 5.0 && what < 20.0) order = OrderKind::kReset;
    if (what >= 20.0 && what < 50.0) order = OrderKind::kEngage;
    if (what >= 50.0 && what < 52.0) order = OrderKind::kDisengage;
    if (what >= 52.0 && what < 54.0) run.restart_master();
    // A slave that is killed in motion leaves its arm to the controller: that is P2's.
    if (what >= 54.0 && what < 59.0 && !run.auditor().moving()) {
      run.cell().restart_slave();
      before = run.cell().slave();
    }
    if (what >= 59.0 && what < 61.0) {
      run.auditor().must_stop(run.now());
      run.cell().open_stop_circuit(true);
    }
    run.tick(order_of(order));
    run.cell().open_stop_circuit(false);
    const HapticOutput& master = run.cell().master();
    const SlaveState& seen = run.cell().net()->master().newest();
    early += order == OrderKind::kStop && seen.stop_epoch == master.link.stop_epoch;
    if (order == OrderKind::kReset && master.order_result == Reason::kNone) reset = run.now();
    const SlaveState& after = run.cell().slave();
    if (after.fault_epoch != before.fault_epoch) latched = run.now();
    if (before.state == SessionState::kFault && after.state != SessionState::kFault) {
      ++releases;
      unseen += reset <= latched;
    }
    before = after;
  }
  run.set_network({});
  run.drive(8 * kSecond);
  const bool engaged = run.engaged();
  FaultOutcome out = run.outcome();
  find(out, unseen, "released without a reset that saw it");
  find(out, early, "stops confirmed before they can have arrived");
  find(out, !engaged, "not engaged again");
  find(out, releases < 3, "hardly anything was released");
  return out;
}

}  // namespace handrail::rows
