// The steps of master and slave, whole, and the parts that have targets of their own.
#include <algorithm>
#include <cmath>
#include <vector>

#include "server/constraint/position_tool.h"
#include "server/follow/follow_ledger.h"
#include "server/haptic/ledger.h"
#include "server/motion/guard.h"
#include "server/stability/energy_governor.h"
#include "tests/bench/percentile.h"
#include "tests/unit/constraint/tool_samples.h"
#include "tests/unit/follow/follow_rig.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail::bench {
namespace {

constexpr double kToolTarget = 50.0;       // [ns]
constexpr double kLedgerTarget = 50.0;     // [ns]
constexpr double kHapticTarget = 1000.0;   // [ns]
constexpr double kGuardTarget = 100.0;     // [ns]
constexpr double kGovernorTarget = 100.0;  // [ns]
// Beside KDL's forward kinematics in the same run.
constexpr double kFollowFactor = 6.0;
constexpr double kLimitsFactor = 9.0;
constexpr double kLateFactor = 40.0;
constexpr std::int64_t kFollowCycles = 1000000;  // the worst of so many is told
constexpr int kBatch = 20;

// A hand at up to 0.2 m/s along a fixed pattern: 0.2 mm a tick.
struct Hand {
  std::vector<Vec3> p;
  std::size_t i = 0;

  explicit Hand(double size) {
    test::Dice dice(7);
    Vec3 v = Vec3::Zero(), x = Vec3::Zero();
    for (int k = 0; k < 4096; ++k) {
      v += 0.02 * (dice.within(2e-3) - v) - 1e-5 / size * x;
      x += v;
      p.push_back(x);
    }
  }
  const Vec3& next() { return p[i = (i + 1) % p.size()]; }
};

struct ToolAdvance {
  PositionTool tool;
  Hand hand{0.05};
  ToolAdvance(const ToolDefinition& definition, GuidanceMethod method)
      : tool(definition, method, 2e-4) {
    tool.start(Vec3::Zero(), Vec3::Zero());
  }
  Vec3 operator()() { return tool.advance(hand.next()); }
};

ToolDefinition line() { return test::line_along(Vec3::Zero(), Vec3(1, 2, 3)); }
ToolDefinition one_way_line() { return test::line_along(Vec3::Zero(), Vec3(1, 2, 3), true); }
ToolDefinition plane() {
  ToolDefinition tool = test::plane_across(Vec3::Zero(), Vec3(1, 2, 3));
  tool.direction_S = tool.normal_S.unitOrthogonal();
  return tool;
}

// The whole tick, engaged and moving, with the tools asked for.
struct HapticTick {
  test::HapticRig rig;
  Hand hand{0.05};
  Pose start;
  Quat turn = rotation_exp({1e-4, 2e-4, -1e-4});

  explicit HapticTick(bool tools) {
    rig.spring_slack = false;
    rig.engage();
    start = rig.in.hand.X_MH;
    if (!tools) return;
    rig.call(test::line_call({1, 2, 3}));
    rig.call(test::call_of(ToolKind::kNRotation));
  }
  const HapticOutput* operator()() {
    rig.in.hand.X_MH.p = start.p + hand.next();
    rig.in.hand.X_MH.q = turn * rig.in.hand.X_MH.q;
    haptic_step(rig.settings, rig.in, 1e-3, *rig.state, rig.out);
    benchmark::DoNotOptimize(rig.out);
    return &rig.out;
  }
};

// The whole cycle along a line through home. `slow`: free; else the target jumps to and fro and the
// joints' limits shorten every step.
struct FollowCycle {
  test::FollowRig rig;
  Pose start;
  bool slow;
  int n = 0;

  explicit FollowCycle(bool free_of_limits) : slow(free_of_limits) {
    rig.engage();
    start = rig.state.motion.X_ST;
  }
  const FollowOutput* operator()() {
    ++n;
    rig.in.master.X_SU.p.y() =
        start.p.y() + (slow ? 0.05 * std::sin(0.02 * n) : (n / 40 % 2 == 0 ? 0.15 : -0.15));
    follow_step(rig.settings, rig.in, rig.state, rig.out);
    rig.in.q_measured = rig.in.q_commanded = rig.out.q_target;
    benchmark::DoNotOptimize(rig.out);
    return &rig.out;
  }
};

struct GuardCall {
  GuardLimits limits{rv2a_limits(), ArmGeometry(), Workspace(), 0.0071};
  GuardState start;
  JointVector wanted = test::home();
  GuardCall(bool pass, bool moving) {
    start.q = test::home();
    start.clearance = 1.0;
    if (moving) start.step = 0.5 * rv2a_limits().max_speed * 0.0071;
    wanted += start.step;
    if (!pass) wanted += rv2a_limits().max_speed * 0.0071;
  }
  Verdict operator()() {
    GuardState state = start;
    benchmark::DoNotOptimize(wanted);
    const Verdict verdict = guard(limits, state, wanted);
    benchmark::DoNotOptimize(state);
    return verdict;
  }
};

// Governor and tank of a tick, a wall of 1 N/mm on one side of the hand.
struct GovernorCall {
  GovernorSettings settings;
  EnergyGovernor governor;
  EnergyTank tank;
  Hand hand{0.05};
  Vec3 last = Vec3::Zero();
  explicit GovernorCall(double friction) {
    settings.on = true;
    settings.friction = friction;
  }
  const EnergyGovernor* operator()() {
    const Vec3& p = hand.next();
    const Vec3 wall(-1000.0 * std::max(p.x(), 0.0), 0.0, 0.0);
    const Vec3 moved = p - last;
    last = p;
    governor.told(governor.govern(settings, {wall, wall, 1000.0}, moved, 1e-3).force);
    tank.told(tank.govern(settings, -200.0 * p, 200.0, moved, 1e-3).force);
    benchmark::DoNotOptimize(governor);
    benchmark::DoNotOptimize(tank);
    return &governor;
  }
};

// Both ledgers of the master's tick, from the same points as in the step.
struct Ledgers {
  Hand hand{0.05};
  ForceShares shares;
  Guidance guidance;
  SlaveState slave;
  ForceLedger force;
  MotionLedger motion;
  Ledgers() {
    slave.ledger.off_S.setConstant(1e-3f);
    slave.ledger.why[3] = Reason::kSingularity;
  }
  Vec3 operator()() {
    const Vec3& p = hand.next();
    shares.device = p;
    force = account(shares, p, p, p, p, p);
    guidance.X_SP.p = 2.0 * p;
    guidance.X_SC.p = 3.0 * p;
    account({p, Quat::Identity()}, guidance, slave, motion);
    benchmark::DoNotOptimize(force);
    benchmark::DoNotOptimize(motion);
    return motion.off_S.col(0);
  }
};

// The slave's, with every stage acting: one cycle's differences of points, reasons and copy into
// the state that is sent.
struct FollowLedgers {
  Hand hand{0.05};
  SlaveState slave;
  const FollowLedger* operator()() {
    const Vec3& p = hand.next();
    FollowLedger ledger;
    put_stage(ledger, FollowStage::kTube, p - 0.9 * p, Reason::kToolTube);
    put_stage(ledger, FollowStage::kBumper, 0.9 * p - 0.8 * p, Reason::kBumper);
    put_stage(ledger, FollowStage::kReach, 0.8 * p - 0.7 * p, Reason::kOutOfReach);
    put_stage(ledger, FollowStage::kLimits, 0.7 * p - 0.6 * p, Reason::kSingularity);
    slave.ledger = ledger;
    benchmark::DoNotOptimize(slave);
    return &slave.ledger;
  }
};

void exact_line(benchmark::State& s) {
  run(s, "tool/line exact", kBatch, kToolTarget, ToolAdvance(line(), GuidanceMethod::kExact));
}
void exact_one_way(benchmark::State& s) {
  run(s, "tool/one-way line exact", kBatch, kToolTarget,
      ToolAdvance(one_way_line(), GuidanceMethod::kExact));
}
void exact_plane(benchmark::State& s) {
  run(s, "tool/plane exact", kBatch, kToolTarget, ToolAdvance(plane(), GuidanceMethod::kExact));
}
void published_line(benchmark::State& s) {
  run(s, "tool/line published", kBatch, 0.0, ToolAdvance(line(), GuidanceMethod::kPublished));
}
void published_plane(benchmark::State& s) {
  run(s, "tool/plane published", kBatch, 0.0, ToolAdvance(plane(), GuidanceMethod::kPublished));
}
void haptic_tools(benchmark::State& s) {
  run(s, "haptic_step/line and N-rotation", 1, kHapticTarget, HapticTick(true));
}
void haptic_free(benchmark::State& s) {
  run(s, "haptic_step/no tool", 1, kHapticTarget, HapticTick(false));
}
void follow_free(benchmark::State& s) { run(s, "follow_step/line", 1, 0.0, FollowCycle(true)); }
void follow_limited(benchmark::State& s) {
  run(s, "follow_step/line under limits", 1, 0.0, FollowCycle(false));
}
void guard_pass(benchmark::State& s) {
  run(s, "guard/passes", kBatch, kGuardTarget, GuardCall(true, true));
}
void guard_refuse(benchmark::State& s) {
  run(s, "guard/brakes", kBatch, kGuardTarget, GuardCall(false, true));
}

void governor_idle(benchmark::State& s) {
  run(s, "governor and tank/within limits", kBatch, kGovernorTarget, GovernorCall(1.0));
}
void governor_acting(benchmark::State& s) {
  run(s, "governor and tank/acting", kBatch, kGovernorTarget, GovernorCall(0.0));
}
void ledgers(benchmark::State& s) { run(s, "ledger/master", kBatch, kLedgerTarget, Ledgers()); }
void follow_ledgers(benchmark::State& s) {
  run(s, "ledger/slave", kBatch, kLedgerTarget, FollowLedgers());
}

BENCHMARK(governor_idle)->Name("governor_idle");
BENCHMARK(governor_acting)->Name("governor_acting");
BENCHMARK(ledgers)->Name("ledger_master");
BENCHMARK(follow_ledgers)->Name("ledger_slave");
BENCHMARK(exact_line)->Name("tool_line_exact");
BENCHMARK(exact_one_way)->Name("tool_one_way_line_exact");
BENCHMARK(exact_plane)->Name("tool_plane_exact");
BENCHMARK(published_line)->Name("tool_line_published");
BENCHMARK(published_plane)->Name("tool_plane_published");
BENCHMARK(haptic_tools)->Name("haptic_step_tools");
BENCHMARK(haptic_free)->Name("haptic_step_free");
BENCHMARK(follow_free)->Name("follow_step_free")->Iterations(kFollowCycles);
BENCHMARK(follow_limited)->Name("follow_step_limited")->Iterations(kFollowCycles);
BENCHMARK(guard_pass)->Name("guard_passes");
BENCHMARK(guard_refuse)->Name("guard_brakes");

[[maybe_unused]] const bool steps_compared = [] {
  // The same targets on the machine where KDL's forward took 595 ns.
  compare("haptic_step/line and N-rotation", "interleaved/kdl_forward", 1000.0 / 595.0);
  compare("follow_step/line", "interleaved/kdl_forward", kFollowFactor);
  compare("follow_step/line under limits", "interleaved/kdl_forward", kLimitsFactor);
  compare_late("follow_step/line", "interleaved/kdl_forward", kLateFactor);
  compare_late("follow_step/line under limits", "interleaved/kdl_forward", kLateFactor);
  compare("tool/line exact", "interleaved/kdl_forward", 50.0 / 595.0);
  return true;
}();

}  // namespace
}  // namespace handrail::bench
