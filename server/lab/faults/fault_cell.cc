#include "server/lab/faults/fault_cell.h"

#include <spdlog/fmt/fmt.h>

#include <stdexcept>

#include "devices/omni/omni_data.h"
#include "proto/config.pb.h"
#include "proto/record.pb.h"
#include "server/kinematics/arm_of.h"
#include "server/lab/replay/replay.h"
#include "server/master/wall_runs.h"
#include "server/scene/scene_io.h"
#include "server/slave/follow_settings.h"

namespace handrail {
namespace {

constexpr char kName[] = "faults";
constexpr double kSensorRange = 1000.0;  // [N]

std::string scene_text(const FaultOptions& fault) {
  std::string text = fmt::format("name: '{}'\n", kName);
  if (!fault.contact) return text;
  const ArmGeometry arm = arm_of(Scene());
  const Vec3 at =
      (forward(arm, ServoArmOptions::default_start()).p - kFaultGap * fault_normal()) / 1e-3;
  text += fmt::format(
      "bumper {{ approach {{ force_n: 200 }} }}\n"
      "simulate {{ effect {{ servo_lag {{}} }} effect {{ encoder_offsets {{}} }}\n"
      "  effect {{ arm_compliance {{}} }}\n"
      "  effect {{ plane {{ at_mm: [{}, {}, {}] normal: [0, 0, 1] }} }}\n"
      "  effect {{ sensor_saturation {{}} }} {} }}\n",
      at.x(), at.y(), at.z(), fault.sensor_noise ? "effect { sensor_noise {} }" : "");
  return text;
}

pb::MasterConfig config_of(const FaultOptions& fault) {
  pb::MasterConfig out;
  out.set_presence(fault.presence == Presence::kNone     ? pb::MasterConfig::NONE
                   : fault.presence == Presence::kButton ? pb::MasterConfig::BUTTON
                                                         : pb::MasterConfig::HOLD);
  out.set_loop_limit_ms(to_seconds(fault.fade_loop) * 1e3);
  out.set_governor(false);
  return out;
}

pb::RecordedScene recorded_fault_scene(const FaultOptions& fault) {
  pb::RecordedScene out;
  out.set_number(kCellScene);
  out.set_name(kName);
  out.set_text(scene_text(fault));
  return out;
}

void add_side(const std::string& side, const std::string& bytes, FaultRecording::Again& out) {
  std::istringstream in(bytes);
  const auto result = replay(in, {});
  const auto complain = [&](const std::string& what) { out.problem = side + ": " + what; };
  if (!result) return complain(result.message());
  out.replayed += result->replayed;
  out.different += result->different;
  if (result->first) {
    complain(fmt::format("{}: {}", result->first->number, result->first->field));
  } else if (!result->damage.empty()) {
    complain(result->damage);
  } else if (result->replayed != result->entries || result->missing != 0) {
    complain(fmt::format("{} of {} done again, {} missing", result->replayed, result->entries,
                         result->missing));
  }
}

}  // namespace

const Vec3& fault_normal() {
  static const Vec3 up = Vec3::UnitZ();
  return up;
}

Scene fault_scene(const FaultOptions& fault) {
  auto scene = parse_scene(std::string(kName) + std::string(kSceneExtension), scene_text(fault));
  // A text of ours: there is nothing that a user could do about it.
  if (!scene) throw std::logic_error(scene.message());
  return std::move(*scene);
}

std::unique_ptr<Cell> fault_cell(std::uint64_t seed, const FaultOptions& fault) {
  const Scene scene = fault_scene(fault);
  auto options = std::make_unique<CellOptions>();
  WallRuns none;
  options->haptic = loop_scene_of(scene, omni_capabilities(false), config_of(fault), none).haptic;
  options->follow = follow_settings(scene, options->rig.controller.period, true, kSensorRange);
  options->rig.controller.arm.geometry = arm_of(scene);
  run_only_listed(scene, options->rig);
  options->rig.controller.arm.seed = seed;
  options->rig.sensor.seed = seed + 1;
  options->rig.controller.queues = fault.queues;
  if (fault.short_form) options->packet_bytes = kMxtShort;
  options->robot_line = seed + 3;
  options->net = CellNetOptions{seed + 2, fault.master_clock, fault.slave_clock};
  return std::make_unique<Cell>(*options);
}

FaultRecording::FaultRecording(Cell& cell, const FaultOptions& fault)
    : recording_(cell, cell_master(config_of(fault), omni_capabilities(false)),
                 cell_slave(kMxtPeriod, kSensorRange), recorded_fault_scene(fault), master_,
                 slave_) {}

FaultRecording::Again FaultRecording::again() {
  recording_.finish();
  Again out;
  add_side("master", master_.str(), out);
  add_side("slave", slave_.str(), out);
  return out;
}

}  // namespace handrail
