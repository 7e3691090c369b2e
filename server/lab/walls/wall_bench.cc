#include "server/lab/walls/wall_bench.h"

#include <algorithm>
#include <utility>

#include "server/master/wall_runs.h"

namespace handrail {
namespace {

// The walls of a scene, moved so that `middle` lies at M's origin.
std::shared_ptr<const Walls> centred(const Walls& walls, const Vec2& middle) {
  auto out = std::make_shared<Walls>(walls);
  for (WallStage& stage : out->stages) stage.pose.p = -Pose2::turned(middle, stage.pose.angle);
  return out;
}

}  // namespace

const EffectSpec* effect_of(const Scene& scene, EffectKind kind) {
  const auto it = std::find_if(scene.effects.begin(), scene.effects.end(),
                               [&](const EffectSpec& e) { return e.kind == kind; });
  return it == scene.effects.end() ? nullptr : &*it;
}

WallBench::WallBench(const Scene& scene, const HandOptions& hand,
                     std::optional<RecordedMotion> recording, const Vec2& middle)
    : joystick_(hand, device_effects(scene.effects), recording),
      hand_mass_(hand.mass),
      device_mass_(device_effects(scene.effects).inertia ? kJoystickMass : 0.0) {
  Scene placed = scene;
  if (recording) placed.walls = centred(*scene.walls, middle);
  pose_ = placed.walls->stages.front().pose;
  run_ = make_wall_run(placed, joystick_.capabilities());
  std::erase_if(placed.effects, [](const EffectSpec& e) { return e.kind != EffectKind::kWall; });
  walls_alone_ = make_wall_run(placed, joystick_.capabilities())->state.effects;
  // Opening a simulated joystick cannot fail.
  static_cast<void>(joystick_.open());
}

void WallBench::follow(const Vec2& p, const Vec2& v) noexcept {
  joystick_.follow(pose_.to_world(p), Pose2::turned(v, pose_.angle));
}

const WallTick& WallBench::step() noexcept {
  const HapticSample sample = joystick_.read(ticks_ * kMillisecond);
  WallInput in;
  in.hand.X_MH = sample.X_MH;
  in.hand.v_MH = sample.v_MH;
  in.hand.valid = sample.valid;
  WallOutput out;
  wall_step(run_->settings, in, kBenchTick, run_->state, out);
  joystick_.write(out.f_H_M);

  const auto turned = [&](const Vec2& v) { return Pose2::turned(v, -pose_.angle); };
  const Vec2 velocity = joystick_.velocity();
  const Vec2 handle = joystick_.handle_force();
  tick_.t = static_cast<double>(ticks_) * kBenchTick;
  tick_.hand = pose_.to_local(joystick_.position());
  tick_.velocity = turned(velocity);
  tick_.handle = turned(handle);
  tick_.effort = turned(handle + hand_mass_ / kBenchTick * (velocity - last_velocity_));
  tick_.device = turned(out.f_H_M.force.head<2>());
  const Walls& walls = *run_->settings.walls;
  EffectInput alone;
  alone.hand = out.hand;
  alone.velocity = turned(sample.v_MH.head<2>());
  alone.proxy = out.contact.proxy;
  alone.region = &walls.regions[out.contact.region];
  alone.wall = out.contact.touching ? &walls.regions[out.contact.wall] : nullptr;
  alone.dt = kBenchTick;
  tick_.wall = walls_alone_.step(alone).force;
  tick_.contact = out.contact;
  tick_.effects = out.effects;
  const auto* friction = run_->state.effects.find<ProgressiveFriction>();
  tick_.turned = friction != nullptr ? friction->alpha() : 0.0;
  last_velocity_ = velocity;
  ++ticks_;
  return tick_;
}

}  // namespace handrail
