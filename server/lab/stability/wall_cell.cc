#include "server/lab/stability/wall_cell.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/base/random.h"
#include "server/base/units.h"
#include "server/lab/stability/bench_scene.h"
#include "server/lab/stability/contact_meter.h"
#include "server/master/governing.h"
#include "server/master/wall_runs.h"

namespace handrail {
namespace {

constexpr double kComes = 0.050;                // in which effects come on [s]
constexpr double kEffectsAreOn = 2.0 * kComes;  // [s]
constexpr double kNominalRate = 1000.0;         // of the master's loop [Hz]
constexpr double kStart = 0.2e-3;               // from the wall [m]
constexpr double kSmall = 0.02e-3;              // where there are none [m]
constexpr int kLateEvery = 50;                  // ticks, where they are late periodically
constexpr double kMostAngle = 0.35;             // of the first kick from straight at the wall [rad]

HapticCapabilities seen(const WallCell& cell) {
  HapticCapabilities out = cell.device->capabilities;
  if (cell.resolution >= 0.0) out.dynamics.resolution = std::max(cell.resolution, kFinest);
  if (!cell.declared) out.dynamics.resolution = 0.0;
  out.dynamics.delay = cell.delay / cell.rate;
  const double cutoff = cell.cutoff < 0.0 ? cell.device->cutoff : cell.cutoff;
  out.velocity_lag = cutoff > 0.0 ? 1.0 / (2.0 * std::numbers::pi * cutoff) : 0.0;
  return out;
}

// What of it the master would render if that were its loop's period [s].
double share_at(const Scene& scene, const HapticCapabilities& device, double period) {
  RenderingLoop loop = rendering_loop(device);
  loop.period = period;
  double share = 1.0;
  for (const Rendering& r : renderings_of(scene, loop)) {
    share = std::min(share, kGoverned * margin_of(device.dynamics, loop, r).share);
  }
  return share;
}

std::unique_ptr<WallRun> run_of(const WallCell& cell) {
  const Scene scene = bench_scene(cell);
  const HapticCapabilities device = seen(cell);
  auto run = make_wall_run(scene, device, cell.governing == Governing::kOn);
  WallSettings& settings = run->settings;
  settings.governor.on = cell.governing != Governing::kOff;
  settings.governor.period = 1.0 / cell.rate;
  settings.governor.delay = cell.delay;
  // The master's own loop has the nominal rate alone.
  if (cell.governing == Governing::kOn && cell.rate != kNominalRate) {
    settings.share = share_at(scene, device, settings.governor.period);
  }
  return run;
}

// Device, driver, walls and what is measured of them.
class Bench {
 public:
  Bench(const WallCell& cell, std::uint64_t seed);

  CaseFigures run();

 private:
  double resolution() const {
    return cell_.resolution < 0.0 ? cell_.device->capabilities.dynamics.resolution
                                  : cell_.resolution;
  }
  Vec2 ahead() const;
  PassiveGrip grip() const;
  double late();
  double came_by_itself() const;
  void tick();
  bool driven() const { return cell_.lateness != Lateness::kNone; }
  double fine() const { return std::max(kSwingCounts * resolution(), kSmall); }
  bool undecided() const;
  CaseFigure over() const { return judged("over_mj", 1e3 * meter_.over(), 1e3 * kMostGiven); }
  CaseFigure swing() const;
  CaseFigure drift() const;
  CaseFigures figures() const;

  const WallCell& cell_;
  Random random_;
  double period_;  // [s]
  std::unique_ptr<WallRun> walls_;
  WallOutput out_;
  BareDevice device_;
  Encoder encoder_;
  ContactMeter meter_;
  Swing kicked_;                // by the first kick
  std::vector<Swing> windows_;  // one after the other
  bool hot_ = false;            // its force was lowered to what the device can sustain, after 2 s
  double t_ = 0.0, dt_, end_ = kSeconds;  // [s]
  std::int64_t ticks_ = 0;
  Vec2 force_ = Vec2::Zero();  // [N]
  ToldForces on_way_;
  double change_ = 0.0;                  // most of the force from tick to tick [N]
  std::int64_t pushed_ = 0, acted_ = 0;  // ticks with a force, and with one that was governed
};

Bench::Bench(const WallCell& cell, std::uint64_t seed)
    : cell_(cell),
      random_(seed),
      period_(1.0 / cell.rate),
      walls_(run_of(cell)),
      device_(cell.device->body(), grip(),
              // A drawn part of a count, too.
              Vec2(cell.at_wall ? -kStart * ahead() : Vec2(Vec2::Zero())) +
                  resolution() * Vec2(random_.uniform(), random_.uniform())),
      encoder_(resolution(), cell.cutoff < 0.0 ? cell.device->cutoff : cell.cutoff),
      meter_(!cell.at_wall, std::max(cell.resolution, 0.0)),
      dt_(period_) {}

// Into the wall, or the corner; where there is none, along X.
Vec2 Bench::ahead() const {
  return cell_.form == WallForm::kCorner ? Vec2(Vec2::Ones().normalized()) : Vec2(Vec2::UnitX());
}

PassiveGrip Bench::grip() const {
  PassiveGrip out = cell_.device->grip(cell_.grip);
  if (cell_.at_wall) out.push = cell_.device->lean * ahead();
  return out;
}

double Bench::late() {
  if (cell_.lateness == Lateness::kPeriodic) return ticks_ % kLateEvery == 0 ? cell_.gap : 0.0;
  if (cell_.lateness == Lateness::kNone || random_.uniform() >= kLateShare) return 0.0;
  return cell_.gap * random_.uniform();
}

// Where a lock opens, the spring that it held back comes within kComes, stretched as it will be
// then: the scene's own doing [J].
double Bench::came_by_itself() const {
  const ReturnSpring* spring = walls_->state.effects.find<ReturnSpring>();
  if (spring == nullptr) return 0.0;
  double out = 0.0;
  for (int i = 0; i < out_.effects.event_count; ++i) {
    if (out_.effects.events[static_cast<std::size_t>(i)].kind != EffectEvent::Kind::kUnlocked)
      continue;
    // It pulls to the origin.
    const double stretched = device_.position().norm() + kComes * device_.velocity().norm();
    out += 0.5 * spring->stiffness() * stretched * stretched;
  }
  return out;
}

void Bench::tick() {
  encoder_.read(device_.position(), dt_);
  WallInput in;
  in.hand.X_MH.p.head<2>() = encoder_.position();
  in.hand.v_MH.head<2>() = encoder_.velocity();
  in.hand.valid = true;
  wall_step(walls_->settings, in, dt_, walls_->state, out_);
  const Vec2 force = out_.f_H_M.force.head<2>();
  if (ticks_ > 0) change_ = std::max(change_, (force - force_).norm());
  pushed_ += !force.isZero(0.0);
  acted_ += out_.reasons.has(Reason::kForceEnergy);
  force_ = force;
  on_way_.add({force.x(), force.y(), 0.0});
  const Vec2 acting = on_way_.acting(cell_.delay).head<2>();
  const double late = this->late();
  dt_ = period_ + late;
  const double work = device_.given(), taken = device_.lost(), speed = device_.velocity().norm();
  device_.advance(dt_, acting);
  const double fastest = std::max(speed, device_.velocity().norm());
  // A governor may ask for no force amid a wall.
  const bool contact =
      !acting.isZero(0.0) || !force_.isZero(0.0) || !out_.effects.force.isZero(0.0);
  meter_.add(contact, acting.norm(), device_.given() - work, device_.lost() - taken,
             cell_.device->capabilities.max_force * fastest * late + came_by_itself());
  t_ += dt_;
  ++ticks_;
  if (t_ < kSecondKick) kicked_.add(device_.position());
  hot_ |= t_ >= kWindow && out_.reasons.has(Reason::kForceContinuous);
  const auto window = static_cast<std::size_t>(std::min(t_, end_ - 0.5 * kWindow) / kWindow);
  windows_.resize(std::max(windows_.size(), window + 1));
  windows_[window].add(device_.position());
}

CaseFigures Bench::run() {
  const double speed = cell_.kick * (0.8 + 0.4 * random_.uniform());
  const double angle = kMostAngle * (2.0 * random_.uniform() - 1.0);
  while (!cell_.at_wall && t_ < kEffectsAreOn) tick();
  device_.kick(speed * Pose2::turned(ahead(), angle));
  bool again = true;
  while (t_ < end_) {
    tick();
    if (again && t_ >= kSecondKick) {
      again = false;
      const double anywhere = 2.0 * std::numbers::pi * random_.uniform();
      device_.kick(0.5 * speed * Vec2(std::cos(anywhere), std::sin(anywhere)));
    }
    if (t_ >= end_ && end_ < kLongestWatch && undecided()) end_ *= kWatchLonger;
  }
  return figures();
}

// Without any loss a swing in a corner wanders from one wall to the other and back, and neither
// grows nor dies: one that grows is larger yet in a longer run. A force that the device cannot
// sustain falls for seconds, and what it held back gives way.
bool Bench::undecided() const {
  if (!over().holds()) return false;
  return !swing().holds() || (hot_ && end_ == kSeconds);
}

// What ticks that are late make drives a motion anew, by as much as is allowed: it may come and go,
// and is judged by the first kick's too where that was larger.
CaseFigure Bench::swing() const {
  const SwingHalves swing(windows_);  // the first window has the second kick
  const double before = driven() ? std::max(swing.first, kicked_.peak_to_peak()) : swing.first;
  return judged("swing_mm", swing.second / kMm, (kMoreSwing * before + fine()) / kMm);
}

CaseFigure Bench::drift() const {
  const bool settles = hot_ && end_ > kSeconds;
  const Swing& before = settles ? windows_[windows_.size() - 2] : windows_[1];
  const double swing = driven() ? std::max(windows_[1].peak_to_peak(), kicked_.peak_to_peak())
                                : windows_[1].peak_to_peak();
  return judged("drift_mm", (windows_.back().mean() - before.mean()).norm() / kMm,
                (0.5 * swing + fine()) / kMm);
}

CaseFigures Bench::figures() const {
  return {over(),
          swing(),
          drift(),
          judged("times_softer", 1.0 / walls_->settings.share, cell_.most_softer),
          told("seconds", end_),
          told("rest_mm", windows_.back().mean().dot(ahead()) / kMm),
          told("given_mj", 1e3 * meter_.worst()),
          told("contacts", meter_.contacts()),
          told("change_n", change_),
          told("governed_share", static_cast<double>(acted_) /
                                     static_cast<double>(std::max<std::int64_t>(pushed_, 1)))};
}

}  // namespace

CaseFigures run_wall_cell(const WallCell& cell, std::uint64_t seed) {
  return Bench(cell, seed).run();
}

}  // namespace handrail
