#include "server/lab/stability/long_run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "server/base/units.h"
#include "server/kinematics/arm_of.h"
#include "server/kinematics/rv2a.h"
#include "server/lab/stability/bench_device.h"
#include "server/lab/stability/bench_scene.h"
#include "server/master/wall_runs.h"
#include "server/model/rv2a_limits.h"

namespace handrail {
namespace {

constexpr double kLongGrip = 250.0;         // the middle of what is published [N/m]
constexpr double kReach = 20.0 * kMm;       // of the hand from where it began, at most, chosen
constexpr double kTurned = 0.4;             // of the stylus, from side to side, chosen [rad]
constexpr double kBelow = 10.0 * kMm;       // of the surface, from where the tip begins
constexpr double kMove = 1.5, kHome = 6.0;  // a move; going home and resting there [s]
constexpr double kNoDrift = 1e-6;           // ten times what 32 bits on the wire round [m]
constexpr double kNoLater = 5.0;            // a run of lost datagrams more or less [ms]
constexpr double kTurnRadius = 20.0 * kMm;  // chosen: within every device's reach [m]

bool raised(const std::atomic<bool>* cancelled) {
  return cancelled != nullptr && cancelled->load();
}

Scene long_scene(bool surface) {
  Scene scene;
  scene.name = "long-run";
  scene.limits.joints = rv2a_limits();
  scene.guidance.local_surface = true;
  const ArmGeometry arm = arm_of(scene);
  PlaneSpec plane;
  plane.at = forward(arm, ServoArmOptions::default_start()).p - kBelow * Vec3::UnitZ();
  plane.surface.stiffness = 10e3;
  plane.surface.damping = 50.0;
  scene.simulate = Simulate{{ServoLagSpec(), ArmComplianceSpec{}, SensorSaturationSpec()}};
  if (surface) scene.simulate->effects.push_back(plane);
  return scene;
}

WholeLoopOptions long_options(std::uint64_t seed, bool surface) {
  WholeLoopOptions out;
  out.scene = long_scene(surface);
  out.grip = stylus_grip(kLongGrip);
  out.way.delay = 10 * kMillisecond;
  out.way.jitter = kMillisecond;
  out.way.loss = 0.01;
  out.seed = seed;
  return out;
}

// What must not grow.
constexpr std::size_t kCounted = 8;
struct Counted {
  std::array<double, kCounted> n{};

  static Counted of(WholeLoop& loop) {
    Cell& cell = loop.cell();
    const CellNet& net = *cell.net();
    const LinkSnapshot &master = net.master().snapshot(), &slave = net.slave().snapshot();
    return {{static_cast<double>(loop.held()), static_cast<double>(cell.slave().silences),
             static_cast<double>(cell.follow_state().halts),
             static_cast<double>(cell.follow_state().guarded),
             static_cast<double>(master.rejected + master.unsendable + master.withheld),
             static_cast<double>(slave.rejected + slave.unsendable + slave.withheld),
             static_cast<double>(cell.rig().controller().counters().lost_moves),
             static_cast<double>(cell.rig().skipped())}};
  }
  double sum() const {
    double out = 0.0;
    for (const double one : n) out += one;
    return out;
  }
};

// How much more of anything there was later, as a share of what chance explains: six deviations of
// a count, and as many when there were none.
double growth(const Counted& half, const Counted& whole) {
  double most = 0.0;
  for (std::size_t i = 0; i < kCounted; ++i) {
    const double before = half.n[i], later = whole.n[i] - half.n[i];
    most = std::max(most, (later - before) / (6.0 * std::sqrt(before) + 6.0));
  }
  return most;
}

class Day {
 public:
  Day(const LongRun& run, std::uint64_t seed)
      : run_(run), random_(seed), loop_(long_options(seed, run.surface)) {}

  CaseOutcome run();

 private:
  void pass(double seconds);
  void part();
  bool over() { return loop_.ended() || raised(run_.cancelled); }

  const LongRun& run_;
  Random random_;
  WholeLoop loop_;
  Vec2 meant_ = Vec2::Zero();
  Vec3 turned_ = Vec3::Zero();
  Vec3 tip_ = Vec3::Zero(), home_ = Vec3::Zero();
  double path_ = 0.0, drift_ = 0.0;
  bool home_known_ = false;
  Nanos oldest_ = 0;  // since the half began
};

void Day::pass(double seconds) {
  const auto ticks = static_cast<std::int64_t>(std::lround(seconds * 1e3));
  for (std::int64_t i = 0; i < ticks && !over(); ++i) {
    loop_.tick();
    const Vec3 tip = loop_.cell().rig().true_tip().p;
    path_ += (tip - tip_).norm();
    tip_ = tip;
    oldest_ = std::max(oldest_, loop_.cell().master_input().link.loop_age);
  }
}

void Day::part() {
  const int moves = static_cast<int>((run_.part - kHome) / kMove);
  for (int i = 0; i < moves && !over(); ++i) {
    const double angle = 2.0 * std::numbers::pi * random_.uniform();
    const Vec2 to = kReach * random_.uniform() * Vec2(std::cos(angle), std::sin(angle));
    const Vec3 turned = kTurned * Vec3(random_.uniform() - 0.5, random_.uniform() - 0.5, 0.0);
    loop_.lead(to - meant_, 0.8 * kMove, turned - turned_);
    meant_ = to;
    turned_ = turned;
    pass(kMove);
  }
  // 1 mm above where it began: the surface is far.
  const Vec2 home(-0.5e-3, 0.0);
  loop_.lead(home - meant_, kMove, -turned_);
  meant_ = home;
  turned_.setZero();
  pass(run_.part - moves * kMove);
  const Vec3 off = tip_ - loop_.asked_as_read();
  if (!home_known_) home_ = off;
  home_known_ = true;
  drift_ = std::max(drift_, (off - home_).norm());
}

CaseOutcome Day::run() {
  if (!loop_.engage(10.0)) return Refused{std::string("refused: ") + describe(loop_.why())};
  tip_ = loop_.cell().rig().true_tip().p;
  pass(2.0);
  oldest_ = 0;
  const Counted begun = Counted::of(loop_);
  Counted half;
  Nanos oldest = 0;
  for (int i = 0; i < run_.parts && !over(); ++i) {
    part();
    if (i + 1 != run_.parts / 2) continue;
    half = Counted::of(loop_);
    oldest = std::exchange(oldest_, 0);
  }
  Counted whole = Counted::of(loop_);
  for (std::size_t i = 0; i < kCounted; ++i) {
    half.n[i] -= begun.n[i];
    whole.n[i] -= begun.n[i];
  }
  return {CaseFigures{judged("drift_um", 1e6 * drift_, 1e6 * kNoDrift),
                      judged("growth", growth(half, whole), 1.0),
                      judged("later_ms", 1e3 * to_seconds(oldest_ - oldest), kNoLater),
                      judged("bounds", loop_.bounds(), 1.0 + 1e-9),
                      judged("ended", loop_.ended() ? 1.0 : 0.0, 0.0),
                      told("hours", loop_.time() / 3600.0), told("path_m", path_),
                      told("counted", whole.sum()),
                      told("oldest_ms", 1e3 * to_seconds(std::max(oldest, oldest_)))},
          loop_.ended_by()};
}

// Engages, moves, stops and resets, five times. The tip at every tick.
struct Rounds {
  static constexpr int kRounds = 5;
  std::vector<Vec3> tips;
  int engagements = 0;

  explicit Rounds(const LoopCounters& counters) {
    WholeLoopOptions options = long_options(1, true);
    options.counters = counters;
    WholeLoop loop(options);
    for (int i = 0; i < kRounds; ++i) {
      engagements += loop.engage(5.0);
      loop.lead({i % 2 == 0 ? 10.0 * kMm : -10.0 * kMm, 0.0}, 1.0);
      order(loop, OrderKind::kNone, 2000);
      order(loop, OrderKind::kStop, 1000);
      order(loop, OrderKind::kReset, 1000);
      loop.start_anew();
    }
  }
  void order(WholeLoop& loop, OrderKind kind, int ticks) {
    HapticOrder order;
    order.kind = kind;
    for (int i = 0; i < ticks; ++i) {
      loop.tick(i == 0 ? order : HapticOrder());
      tips.push_back(loop.cell().rig().true_tip().p);
    }
  }
};

}  // namespace

CaseOutcome run_long(const LongRun& run, std::uint64_t seed) { return Day(run, seed).run(); }

CaseOutcome run_turns(double seconds, const std::atomic<bool>* cancelled) {
  constexpr double kMost = 1e-9;  // ten roundings of what a day of turns comes to [rad]
  constexpr std::int64_t kTicksOfTurn = 1000;
  WallCell cell;
  cell.device = &bench_devices()[2];
  cell.at_wall = false;
  cell.effects = {EffectKind::kProgressive};
  const Scene scene = bench_scene(cell);
  const Vec2 centre = scene.effects.front().at;
  auto walls = make_wall_run(scene, cell.device->capabilities, true);
  WallOutput out;
  WallInput in;
  in.hand.valid = true;
  const double sense = scene.effects.front().clockwise ? -1.0 : 1.0;
  const auto ticks = static_cast<std::int64_t>(std::lround(1e3 * seconds));
  for (std::int64_t i = 0; i <= ticks && !raised(cancelled); ++i) {
    const double angle =
        sense * 2.0 * std::numbers::pi * 1e-3 * static_cast<double>(i % kTicksOfTurn);
    const Vec2 arm = kTurnRadius * Vec2(std::cos(angle), std::sin(angle));
    in.hand.X_MH.p.head<2>() = centre + arm;
    in.hand.v_MH.head<2>() = sense * 2.0 * std::numbers::pi * Vec2(-arm.y(), arm.x());
    wall_step(walls->settings, in, 1e-3, walls->state, out);
  }
  const ProgressiveFriction* friction = walls->state.effects.find<ProgressiveFriction>();
  const double turned = 2.0 * std::numbers::pi * 1e-3 * static_cast<double>(ticks);
  const double off = friction == nullptr ? std::nan("") : friction->alpha() - turned;
  return CaseFigures{judged("off_urad", 1e6 * std::abs(off), 1e6 * kMost),
                     told("turns", turned / (2.0 * std::numbers::pi)),
                     told("force_n", out.f_H_M.force.norm())};
}

CaseOutcome run_counters(const LoopCounters& counters) {
  const Rounds rounds(counters), none{LoopCounters{.epoch = 1000}};
  double apart = 0.0;
  for (std::size_t i = 0; i < std::min(rounds.tips.size(), none.tips.size()); ++i) {
    apart = std::max(apart, (rounds.tips[i] - none.tips[i]).norm());
  }
  return CaseFigures{
      judged("apart_um", 1e6 * apart, 0.0),
      judged("engagements_missing", static_cast<double>(Rounds::kRounds - rounds.engagements), 0.0),
      told("way_mm", (none.tips[1999] - none.tips.front()).norm() / kMm)};
}

CaseOutcome run_last_datagram() {
  constexpr std::uint64_t kLeft = 10'000;  // a millisecond each
  WholeLoopOptions options = long_options(1, true);
  options.counters.sequence = ~std::uint64_t{0} - kLeft;
  WholeLoop loop(options);
  if (!loop.engage(5.0)) return Refused{std::string("refused: ") + describe(loop.why())};
  // It moves as the last one comes.
  (void)loop.pass(9.0 - loop.time());
  loop.lead({-20.0 * kMm, 0.0}, 3.0);
  (void)loop.pass(3.0);
  for (int i = 0; i < 1000; ++i) loop.tick();
  const Vec3 stood = loop.cell().rig().true_tip().p;
  double moved = 0.0;
  for (int i = 0; i < 1000; ++i) {
    loop.tick();
    moved = std::max(moved, (loop.cell().rig().true_tip().p - stood).norm());
  }
  return CaseFigures{judged("tip_moved_um", 1e6 * moved, 1e6 * kNoDrift),
                     judged("still_engaged", loop.ended() ? 0.0 : 1.0, 0.0)};
}

}  // namespace handrail
