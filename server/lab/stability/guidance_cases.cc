// The force of position tools, alone and beside a surface that the slave tells of, at a device that
// is kicked.
#include <fmt/format.h>

#include <cmath>

#include "server/base/random.h"
#include "server/base/units.h"
#include "server/lab/stability/bench_device.h"
#include "server/lab/stability/contact_meter.h"
#include "server/lab/stability/engaged_step.h"
#include "server/lab/stability/stability_case.h"
#include "server/lab/stability/wall_cell.h"
#include "server/master/governing.h"
#include "server/master/haptic_settings.h"

namespace handrail {
namespace {

constexpr double kCounts = 2.0;    // of the device, what a swing may be anyway, as at walls
constexpr double kWatched = 24.0;  // what is not over by then, as at walls [s]
constexpr double kSettles = 0.3;   // until what is called and told is whole [s]
constexpr double kRigid = 1e6;     // more than any hand is let feel [N/m]

// SI. The hand moves in a plane: Y along the surface, X out of it.
struct GuidanceCell {
  const BenchDevice* device = nullptr;
  GripKind grip = GripKind::kNone;
  std::optional<double> slant;  // of a line from the surface, none: no tool [rad]
  bool surface = false;
  double stiffness = 800.0;  // of the tool, and at most of the surface [N/m]
  double kick = 0.5;         // [m/s], within a fifth; later again by half of it, anywhere
  Governing governing = Governing::kOff;
};

HapticSettings settings_of(const GuidanceCell& cell) {
  Scene scene;
  scene.guidance.stiffness = cell.stiffness;
  scene.guidance.local_surface = true;
  HapticSettings out =
      haptic_settings(scene, cell.device->capabilities, cell.governing != Governing::kOff);
  if (cell.governing != Governing::kEnergy) return out;
  out.guide.most_stiffness = 1e9;
  out.surface_stiffness = cell.stiffness;
  return out;
}

// Leans on the surface where there is one.
PassiveGrip grip_of(const GuidanceCell& cell) {
  PassiveGrip out = cell.device->grip(cell.grip);
  if (cell.surface) out.push = {-cell.device->lean, 0.0};
  return out;
}

class GuidanceBench {
 public:
  GuidanceBench(const GuidanceCell& cell, std::uint64_t seed);
  CaseFigures run();

 private:
  CaseFigures figures() const;
  std::int64_t ticks_of(double seconds) const { return std::llround(seconds / master_.period()); }
  void watch(double until);
  Vec3 in_M(const Vec2& v) const { return v.x() * out_M_ + v.y() * along_M_; }
  Vec2 force();
  void tick();
  void kick(double speed);

  Random random_;
  double resolution_;
  EngagedStep master_;
  Vec3 out_M_, along_M_;  // unit: X and Y of the device
  BareDevice device_;
  Encoder encoder_;
  ContactMeter meter_{true, 0.0};
  std::vector<Swing> windows_;  // one after the other
  double kick_;                 // [m/s]
  std::int64_t ticks_ = 0;
};

GuidanceBench::GuidanceBench(const GuidanceCell& cell, std::uint64_t seed)
    : random_(seed),
      resolution_(cell.device->capabilities.dynamics.resolution),
      master_(settings_of(cell)),
      device_(cell.device->body(), grip_of(cell),
              resolution_ * Vec2(random_.uniform(), random_.uniform())),  // a part of a count
      encoder_(resolution_, cell.device->cutoff),
      kick_(cell.kick * (0.8 + 0.4 * random_.uniform())) {
  const Vec3 n_S = Vec3(random_.normal(), random_.normal(), random_.normal()).normalized();
  const Vec3 along_S = n_S.unitOrthogonal();
  const Engagement& engagement = master_.state().command.engagement;
  out_M_ = engagement.turn_to_hand(n_S);
  along_M_ = engagement.turn_to_hand(along_S);
  if (cell.surface) master_.touch({n_S, n_S.dot(EngagedStep::kStart.p), kRigid});
  if (cell.slant) {
    ToolCall line;
    line.kind = ToolKind::kLine;
    line.direction_S = std::cos(*cell.slant) * along_S + std::sin(*cell.slant) * n_S;
    master_.call(line);
  }
  for (double t = 0.0; t < kSettles; t += master_.period()) force();
}

Vec2 GuidanceBench::force() {
  encoder_.read(device_.position(), master_.period());
  const Vec3 asked =
      master_.step({in_M(encoder_.position()), Quat::Identity()}, in_M(encoder_.velocity())).force;
  return {asked.dot(out_M_), asked.dot(along_M_)};
}

void GuidanceBench::tick() {
  const Vec2 pushed = force();
  const double work = device_.given(), taken = device_.lost();
  device_.advance(master_.period(), pushed);
  meter_.add(true, pushed.norm(), device_.given() - work, device_.lost() - taken, 0.0);
  if (ticks_++ % ticks_of(kWindow) == 0) windows_.emplace_back();
  windows_.back().add(device_.position());
}

void GuidanceBench::watch(double until) {
  while (ticks_ < ticks_of(until)) tick();
}

void GuidanceBench::kick(double speed) {
  const double angle = 2.0 * std::numbers::pi * random_.uniform();
  device_.kick(speed * Vec2(std::cos(angle), std::sin(angle)));
}

// By its last two windows.
CaseFigures GuidanceBench::figures() const {
  const Swing &last = windows_.back(), &before = windows_[windows_.size() - 2];
  const double swing = before.peak_to_peak(), fine = std::max(kCounts * resolution_, 1e-6);
  return {
      judged("over_mj", 1e3 * meter_.over(), 1e3 * kMostGiven),
      judged("swing_mm", last.peak_to_peak() / kMm, (kMoreSwing * swing + fine) / kMm),
      judged("drift_mm", (last.mean() - before.mean()).norm() / kMm, (0.5 * swing + fine) / kMm),
      judged("engaged", master_.engaged() ? 0.0 : 1.0, 0.0),
      told("given_mj", 1e3 * meter_.worst()),
      told("tool_n_mm",
           master_.state().command.guide.stiffness(master_.settings().guide) / kNewtonPerMm),
      told("seconds", kWindow * static_cast<double>(windows_.size()))};
}

// Along a tool nothing but the device's damping ends a motion: what is not over yet may be later.
CaseFigures GuidanceBench::run() {
  kick(kick_);
  watch(kSecondKick);
  kick(0.5 * kick_);
  watch(kSeconds);
  if (!all_hold(figures())) watch(kWatched);
  return figures();
}

}  // namespace

std::vector<StabilityCase> guidance_cases() {
  std::vector<StabilityCase> out;
  GuidanceCell cell;
  const auto put = [&](const std::string& what) {
    for (const auto& [governing, name] : kGoverning) {
      cell.governing = governing;
      out.push_back({fmt::format("guidance/{}/{}/{}/K{:g}/{}", cell.device->name,
                                 name_of(cell.grip), what, cell.stiffness / kNewtonPerMm, name),
                     governing == Governing::kOn, true,
                     [cell](std::uint64_t seed) { return GuidanceBench(cell, seed).run(); }});
    }
  };
  for (const BenchDevice& device : bench_devices()) {
    cell.device = &device;
    for (const GripKind grip : kGripKinds) {
      cell.grip = grip;
      for (const double stiffness : {100.0, 500.0, 800.0, 1500.0, 3000.0, 10000.0}) {
        cell.stiffness = stiffness;
        cell.slant.reset(), cell.surface = true, put("surface");
        for (const double slant : {0.0, 30.0, 60.0, 90.0}) {
          cell.slant = slant * kDeg;
          if (slant == 0.0) cell.surface = false, put("line");
          cell.surface = true, put(fmt::format("line{:g}+surface", slant));
        }
      }
    }
  }
  return out;
}

}  // namespace handrail
