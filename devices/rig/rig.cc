#include "devices/rig/rig.h"

#include <limits>

#include "server/kinematics/arm_of.h"

namespace handrail {

void run_only_listed(const Scene& scene, RigOptions& options) {
  if (!scene.simulate) return;
  const Simulate& list = *scene.simulate;
  ServoArmOptions& arm = options.controller.arm;
  arm.geometry = arm_of(scene);
  const auto* lag = list.find<ServoLagSpec>();
  arm.lag = lag != nullptr ? lag->lag : 0.0;
  arm.spread = lag != nullptr ? lag->spread : 0.0;
  if (lag == nullptr) arm.joint_lag.setZero();
  const auto* offsets = list.find<EncoderOffsetsSpec>();
  arm.repeatability = offsets != nullptr ? offsets->repeatability : 0.0;

  FtSourceOptions& sensor = options.sensor;
  const auto* noise = list.find<SensorNoiseSpec>();
  sensor.noise_n = noise != nullptr ? noise->force : 0.0;
  sensor.noise_n_m = noise != nullptr ? noise->torque : 0.0;
  const auto* drift = list.find<SensorDriftSpec>();
  sensor.drift_n_per_s = drift != nullptr ? drift->rate : 0.0;
  sensor.drift_n = drift != nullptr ? drift->range : 0.0;
  sensor.zero = drift != nullptr ? drift->start : Wrench();
  const auto* step = list.find<SensorQuantisationSpec>();
  sensor.step_n = step != nullptr ? step->force : 0.0;
  sensor.step_n_m = step != nullptr ? step->torque : 0.0;
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  const auto* range = list.find<SensorSaturationSpec>();
  sensor.range_n = range != nullptr ? range->force : kEndless;
  sensor.range_n_m = range != nullptr ? range->torque : kEndless;
  options.world = workpiece_of(scene).world;
}

Workpiece workpiece_of(const Scene& scene) {
  Workpiece out;
  out.geometry = arm_of(scene);
  if (scene.simulate && World::is_needed(*scene.simulate)) out.world = scene.simulate;
  return out;
}

Rig::Rig(const RigOptions& options, Nanos start) noexcept
    : control_period_(options.controller.period),
      sensor_period_(options.sensor.period),
      control_next_(start + control_period_),
      sensor_next_(start + sensor_period_),
      controller_(options.controller),
      sensor_(options.sensor),
      world_at_(start) {
  // The arm's time starts here.
  controller_.tick(start);
  if (options.world) {
    const ServoArmOptions& arm = options.controller.arm;
    world_.emplace(*options.world, arm.geometry, arm.q_start);
  }
}

RigEvent Rig::step(Nanos now) noexcept {
  const std::uint64_t before = skipped_;
  skip_late(now, control_period_, control_next_);
  if (skipped_ != before) controller_.leave_out();
  skip_late(now, sensor_period_, sensor_next_);
  if (next() > now) return RigEvent::kNone;
  if (control_next_ <= sensor_next_) {
    controller_.tick(control_next_);
    control_next_ += control_period_;
    return RigEvent::kControl;
  }
  if (world_) step_world(sensor_next_);
  sensor_.tick();
  sensor_next_ += sensor_period_;
  return RigEvent::kSensor;
}

void Rig::step_world(Nanos now) noexcept {
  controller_.pass(now);
  world_->step(controller_.arm().joints(), to_seconds(now - world_at_));
  world_at_ = now;
  sensor_.set_wrench(world_->on_sensor());
}

std::optional<TipInside> Rig::play(const Workpiece& piece) noexcept {
  std::optional<World> next;
  if (piece.world) next.emplace(*piece.world, piece.geometry, controller_.arm().joints());
  if (next) {
    if (const auto inside = next->inside()) return inside;
  }
  world_ = next;
  world_at_ = sensed_at();
  sensor_.set_wrench(world_ ? world_->on_sensor() : Wrench());
  return std::nullopt;
}

void Rig::skip_late(Nanos now, Nanos period, Nanos& next) noexcept {
  if (now - next <= kPatience) return;
  const Nanos count = (now - next) / period;
  skipped_ += static_cast<std::uint64_t>(count);
  next += count * period;
}

}  // namespace handrail
