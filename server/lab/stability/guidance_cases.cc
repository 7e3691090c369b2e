// The force of position tools, alone and beside a surface that the slave tells of, at a device that
// is kicked.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "server/base/random.h"
#include "server/base/units.h"
#include "server/lab/stability/bench_device.h"
#include "server/lab/stability/contact_meter.h"
#include "server/lab/stability/engaged_step.h"
#include "server/lab/stability/stability_case.h"
#include "server/lab/stability/wall_cell.h"
#include "server/master/haptic_settings.h"

namespace handrail {
namespace {

constexpr double kSmallest = 1e-6;  // chosen: where there are none [m]
constexpr double kSettles = 0.3;    // until what is called and told is whole [s]
constexpr double kRigid = 1e6;      // more than any hand is let feel [N/m]

struct Arrangement {
  const char* name = "";
  ToolKind tool = ToolKind::kNone;
  double slant = 0.0;  // of a line from the surface [deg]
  bool surface = false;
  bool damped = false;     // the tool, by the device's `damping`
  bool published = false;  // the proxy moves in steps
  bool disturbed = false;  // tried with late ticks and late forces, too
};

constexpr std::array kArrangements = {
    Arrangement{"surface", ToolKind::kNone, 0.0, true},
    Arrangement{"line", ToolKind::kLine},
    Arrangement{"line+damper", ToolKind::kLine, 0.0, false, true, false, true},
    Arrangement{"line+steps", ToolKind::kLine, 0.0, false, false, true},
    Arrangement{"line0+surface", ToolKind::kLine, 0.0, true},
    Arrangement{"line30+surface", ToolKind::kLine, 30.0, true},
    Arrangement{"line60+surface", ToolKind::kLine, 60.0, true, false, false, true},
    Arrangement{"line60+surface+damper", ToolKind::kLine, 60.0, true, true},
    Arrangement{"line60+surface+steps", ToolKind::kLine, 60.0, true, false, true},
    Arrangement{"line90+surface", ToolKind::kLine, 90.0, true},
    Arrangement{"point+surface", ToolKind::kPoint, 0.0, true, false, false, true},
    Arrangement{"point+surface+damper", ToolKind::kPoint, 0.0, true, true},
};

// SI. The hand moves in a plane: Y along the surface, X out of it.
struct GuidanceCell {
  const BenchDevice* device = nullptr;
  GripKind grip = GripKind::kNone;
  Arrangement of;
  double stiffness = 800.0;  // of the tool, and at most of the surface [N/m]
  double gap = 0.0;          // the most by which a tick is late, at random [s]
  int delay = 0;             // until a force acts on the device, which says so [ticks]
  double kick = 0.5;         // [m/s], within a fifth; later again by half of it, anywhere
  Governing governing = Governing::kOff;
};

HapticSettings settings_of(const GuidanceCell& cell) {
  Scene scene;
  scene.guidance.stiffness = cell.stiffness;
  scene.guidance.local_surface = true;
  scene.guidance.damping = cell.of.damped ? cell.device->damping : 0.0;
  scene.guidance.published_method = cell.of.published;
  HapticCapabilities device = cell.device->capabilities;
  device.dynamics.delay = cell.delay * GovernorSettings().period;
  HapticSettings out = haptic_settings(scene, device, cell.governing != Governing::kOff);
  if (cell.governing != Governing::kEnergy) return out;
  out.guide.most_stiffness = 1e9;
  out.surface_stiffness = cell.stiffness;
  out.damping = scene.guidance.damping;
  return out;
}

// Leans on the surface where there is one.
PassiveGrip grip_of(const GuidanceCell& cell) {
  PassiveGrip out = cell.device->grip(cell.grip);
  if (cell.of.surface) out.push = {-cell.device->lean, 0.0};
  return out;
}

class GuidanceBench {
 public:
  GuidanceBench(const GuidanceCell& cell, std::uint64_t seed);
  CaseFigures run();

 private:
  CaseFigure over() const { return judged("over_mj", 1e3 * meter_.over(), 1e3 * kMostGiven); }
  CaseFigures figures() const;
  void watch(double until);
  Vec3 in_M(const Vec2& v) const { return v.x() * out_M_ + v.y() * along_M_; }
  Vec2 force(double dt);
  void tick();
  void kick(double speed);

  const GuidanceCell cell_;
  Random random_;
  double resolution_;
  EngagedStep master_;
  Vec3 out_M_, along_M_;  // unit: X and Y of the device
  BareDevice device_;
  Encoder encoder_;
  ContactMeter meter_{true, 0.0};
  Swing kicked_;                // by the first kick
  std::vector<Swing> windows_;  // one after the other
  double kick_;                 // [m/s]
  double t_ = 0.0, dt_;         // [s]
  ToldForces on_way_;
};

GuidanceBench::GuidanceBench(const GuidanceCell& cell, std::uint64_t seed)
    : cell_(cell),
      random_(seed),
      resolution_(cell.device->capabilities.dynamics.resolution),
      master_(settings_of(cell)),
      device_(cell.device->body(), grip_of(cell),
              resolution_ * Vec2(random_.uniform(), random_.uniform())),  // a part of a count
      encoder_(resolution_, cell.device->cutoff),
      kick_(cell.kick * (0.8 + 0.4 * random_.uniform())),
      dt_(master_.period()) {
  const Vec3 n_S = Vec3(random_.normal(), random_.normal(), random_.normal()).normalized();
  const Vec3 along_S = n_S.unitOrthogonal();
  const Engagement& engagement = master_.state().command.engagement;
  out_M_ = engagement.turn_to_hand(n_S);
  along_M_ = engagement.turn_to_hand(along_S);
  if (cell.of.surface) master_.touch({n_S, n_S.dot(EngagedStep::kStart.p), kRigid});
  if (cell.of.tool != ToolKind::kNone) {
    const double slant = cell.of.slant * kDeg;
    ToolCall tool;
    tool.kind = cell.of.tool;
    if (tool.kind == ToolKind::kLine)
      tool.direction_S = std::cos(slant) * along_S + std::sin(slant) * n_S;
    master_.call(tool);
  }
  for (double t = 0.0; t < kSettles; t += dt_) force(dt_);
}

Vec2 GuidanceBench::force(double dt) {
  encoder_.read(device_.position(), dt);
  const Pose X_MH{in_M(encoder_.position()), Quat::Identity()};
  on_way_.add(master_.step(X_MH, in_M(encoder_.velocity()), dt).force);
  const Vec3& acting = on_way_.acting(cell_.delay);
  return {acting.dot(out_M_), acting.dot(along_M_)};
}

void GuidanceBench::tick() {
  const Vec2 pushed = force(dt_);
  const bool comes_late = cell_.gap > 0.0 && random_.uniform() < kLateShare;
  const double late = comes_late ? cell_.gap * random_.uniform() : 0.0;
  dt_ = master_.period() + late;
  const double work = device_.given(), taken = device_.lost(), speed = device_.velocity().norm();
  device_.advance(dt_, pushed);
  const double fastest = std::max(speed, device_.velocity().norm());
  meter_.add(true, pushed.norm(), device_.given() - work, device_.lost() - taken,
             cell_.device->capabilities.max_force * fastest * late);
  if (t_ >= kWindow * static_cast<double>(windows_.size())) windows_.emplace_back();
  t_ += dt_;
  windows_.back().add(device_.position());
  if (t_ < kSecondKick) kicked_.add(device_.position());
}

void GuidanceBench::watch(double until) {
  while (t_ < until) tick();
}

void GuidanceBench::kick(double speed) {
  const double angle = 2.0 * std::numbers::pi * random_.uniform();
  device_.kick(speed * Vec2(std::cos(angle), std::sin(angle)));
}

// Late ticks drive a motion anew, by as much as is allowed: it may come and go, and is judged by
// the first kick's too.
CaseFigures GuidanceBench::figures() const {
  const SwingHalves swing(windows_);
  const Swing &last = windows_.back(), &before = windows_[windows_.size() - 2];
  const double kicked = cell_.gap > 0.0 ? kicked_.peak_to_peak() : 0.0;
  const double first = std::max(swing.first, kicked);
  const double moved = std::max(before.peak_to_peak(), kicked);
  const double fine = std::max(kSwingCounts * resolution_, kSmallest);
  return {
      over(),
      judged("swing_mm", swing.second / kMm, (kMoreSwing * first + fine) / kMm),
      judged("drift_mm", (last.mean() - before.mean()).norm() / kMm, (0.5 * moved + fine) / kMm),
      judged("engaged", master_.engaged() ? 0.0 : 1.0, 0.0),
      told("given_mj", 1e3 * meter_.worst()),
      told("tool_n_mm",
           master_.state().command.guide.stiffness(master_.settings().guide) / kNewtonPerMm),
      told("seconds", kWindow * static_cast<double>(windows_.size()))};
}

// Along a tool nothing but the device's damping ends a motion: what is not over yet may be later.
// One that makes energy does not get better.
CaseFigures GuidanceBench::run() {
  kick(kick_);
  watch(kSecondKick);
  kick(0.5 * kick_);
  watch(kSeconds);
  for (double end = kSeconds; end < kLongestWatch && over().holds() && !all_hold(figures());) {
    watch(end *= kWatchLonger);
  }
  return figures();
}

}  // namespace

std::vector<StabilityCase> guidance_cases() {
  std::vector<StabilityCase> out;
  GuidanceCell cell;
  const auto put = [&](const std::string& how) {
    for (const auto& [governing, name] : kGoverning) {
      cell.governing = governing;
      out.push_back(
          {fmt::format("guidance/{}/{}/{}/K{:g}{}/{}", cell.device->name, name_of(cell.grip),
                       cell.of.name, cell.stiffness / kNewtonPerMm, how, name),
           governing == Governing::kOn, true,
           [cell](std::uint64_t seed) { return GuidanceBench(cell, seed).run(); },
           CaseSize::kLarge});
    }
  };
  for (const BenchDevice& device : bench_devices()) {
    cell.device = &device;
    for (const GripKind grip : kGripKinds) {
      cell.grip = grip;
      for (const double stiffness : {100.0, 800.0, 1500.0, 10000.0}) {
        cell.stiffness = stiffness;
        for (const Arrangement& of : kArrangements) {
          cell.of = of;
          put("");
          if (!of.disturbed) continue;
          for (const double gap : {5.0, 20.0}) {
            cell.gap = 1e-3 * gap;
            put(fmt::format("/late{:g}ms", gap));
          }
          cell.gap = 0.0;
          for (const int delay : {1, 5}) {
            cell.delay = delay;
            put(fmt::format("/delay{}ms", delay));
          }
          cell.delay = 0;
        }
      }
    }
  }
  return out;
}

}  // namespace handrail
