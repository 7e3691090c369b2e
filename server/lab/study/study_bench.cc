#include "server/lab/study/study_bench.h"

#include "server/kinematics/arm_of.h"
#include "server/master/haptic_settings.h"
#include "server/slave/follow_settings.h"

namespace handrail {
namespace {

constexpr double kEngagePatience = 1.0;  // [s]
constexpr double kAtRest = 0.3;          // between engaging and the first thought [s]

// What the machine adds between hand and tip, as practice teaches it.
double lag_of(const StudyMachine& machine) {
  const double smoother = 0.5 * (machine.scene.smoother_samples - 1) * to_seconds(machine.tick);
  const double cycles = 1.5 * to_seconds(machine.rig.controller.period);
  return smoother + cycles + to_seconds(machine.transit) + machine.rig.controller.arm.lag;
}

}  // namespace

Result<std::unique_ptr<CellOptions>> study_cell(const StudyMachine& machine, const Pose& X_ST,
                                                const char* what, std::uint64_t arm_seed,
                                                std::uint64_t sensor_seed) {
  auto cell = std::make_unique<CellOptions>();
  cell->rig = machine.rig;
  cell->rig.controller.arm.seed = arm_seed;
  cell->rig.sensor.seed = sensor_seed;
  ServoArmOptions& arm = cell->rig.controller.arm;
  arm.geometry = arm_of(machine.scene);
  if (inverse_near(arm.geometry, X_ST, ServoArmOptions::default_start(), arm.q_start) !=
      InverseStatus::kOk) {
    return Status::error("scene '" + machine.scene.name + "': the arm cannot stand at " + what);
  }
  run_only_listed(machine.scene, cell->rig);
  cell->haptic = haptic_settings(machine.scene, omni_capabilities(machine.torque));
  cell->follow =
      follow_settings(machine.scene, cell->rig.controller.period, true, kStudySensorRange);
  cell->transit = machine.transit;
  cell->tick = machine.tick;
  return cell;
}

StudyBench::StudyBench(const StudyMachine& machine, const CellOptions& cell,
                       const OperatorParameters& person, std::uint64_t seed)
    : dt_(to_seconds(machine.tick)),
      cell_(cell),
      omni_(hand_options(person, seed), machine.torque),
      mind_(person,
            {machine.scene.mapping.scale, Quat(machine.scene.mapping.R_SM), lag_of(machine)},
            seed + 1),
      tip_(cell_.rig().true_tip()) {
  (void)omni_.open();
}

Status StudyBench::record(const StudyMachine& machine, const std::string& trial) {
  if (machine.recording.folder.empty()) return Status::ok();
  if (Status s = TrialRecording::is_new(machine.recording.folder, trial); !s) return s;
  recording_ = std::make_unique<TrialRecording>(cell_, machine, trial);
  return Status::ok();
}

Status StudyBench::finish_recording(const std::string& end) {
  const auto recording = std::move(recording_);
  return recording ? recording->finish(end) : Status::ok();
}

bool StudyBench::engage() {
  HapticOrder order;
  order.kind = OrderKind::kEngage;
  while (cell_.master_state().lead.session != SessionState::kClutched) {
    if (now_ > kEngagePatience) return false;
    tick(order);
  }
  const double until = now_ + kAtRest;
  while (now_ < until) tick({});
  return true;
}

void StudyBench::tick(const HapticOrder& order) {
  now_ += dt_;
  HandReading hand = hand_reading(omni_.read(cell_.now()));
  hand.clutch_button = clutch_;
  cell_.tick(hand, order);
  if (recording_) recording_->pull();
  omni_.write(cell_.master().f_H_M);
  if (cell_.robot_cycle() || cell_.rig().world() != nullptr) tip_ = cell_.rig().true_tip();
  mind_.step(dt_, in_sight(), cell_.master().f_H_M.force, *omni_.hand());
}

// What the operator sees: of a tool that touches how far it has come by its end, and sideways by
// its body, since a bent one looks crooked.
Pose StudyBench::in_sight() const {
  if (cell_.rig().world() == nullptr) return tip_;
  const Vec3 bent = cell_.rig().world()->untouched() - tip_.p, axis = tip_.q * Vec3::UnitZ();
  return {tip_.p + bent - bent.dot(axis) * axis, tip_.q};
}

}  // namespace handrail
