#include "devices/rig/rig_options_io.h"

#include "proto/config.pb.h"
#include "server/base/units.h"
#include "server/kinematics/rv2a.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

// Reads a list of six into `out` times `unit`; an empty one leaves `out` alone.
template <typename List>
Status read_joints(const char* field, const List& list, double unit, JointVector& out) {
  if (list.empty()) return Status::ok();
  if (list.size() != kJoints) {
    return Status::error(std::string(field) + ": " + std::to_string(list.size()) +
                         " values, expected 6 or none");
  }
  for (int i = 0; i < kJoints; ++i) out[i] = list.Get(i) * unit;
  return Status::ok();
}

Status check_start(const JointVector& q) {
  const JointLimits& limits = rv2a_limits();
  for (int i = 0; i < kJoints; ++i) {
    if (q[i] >= limits.lower[i] && q[i] <= limits.upper[i]) continue;
    return Status::error("start_joints_deg: J" + std::to_string(i + 1) + " = " +
                         std::to_string(q[i] / kDeg) + ", expected " +
                         std::to_string(limits.lower[i] / kDeg) + " to " +
                         std::to_string(limits.upper[i] / kDeg));
  }
  return Status::ok();
}

}  // namespace

Result<RigOptions> rig_options(const pb::RigConfig& config) {
  constexpr double kMilli = 1e-3;
  RigOptions options;
  ServoArmOptions& arm = options.controller.arm;
  arm.seed = config.seed();
  arm.lag = config.servo_lag_ms() * kMilli;
  arm.spread = config.servo_spread();
  arm.repeatability = config.repeatability_mm() * kMm;
  if (Status s = read_joints("joint_lag_ms", config.joint_lag_ms(), kMilli, arm.joint_lag); !s) {
    return s;
  }
  if (Status s = read_joints("start_joints_deg", config.start_joints_deg(), kDeg, arm.q_start);
      !s) {
    return s;
  }
  if (Status s = check_start(arm.q_start); !s) return s;
  options.controller.time_out_cycles = config.mxttout_cycles();
  options.controller.drop_share = config.drop_share();
  options.controller.drop_seed = config.seed() + 1000;

  FtSourceOptions& sensor = options.sensor;
  constexpr double kLever = 0.05;  // torque noise per force noise: gauges 50 mm from the centre [m]
  sensor.seed = config.seed() + 2000;
  sensor.counts_per_n = config.counts_per_n();
  sensor.counts_per_n_m = config.counts_per_n_m();
  sensor.range_n = config.sensor_range_n();
  sensor.range_n_m = 0.1 * config.sensor_range_n();
  sensor.noise_n = config.sensor_noise_n();
  sensor.noise_n_m = kLever * config.sensor_noise_n();
  sensor.drop_share = config.drop_share();

  const pb::RigSwitchesConfig& switches = config.switches();
  options.switches = {
      !switches.off(),    switches.teach(),        static_cast<int>(switches.override_percent()),
      switches.program(), switches.rights_taken(), switches.emergency_stop()};

  if (config.has_scene()) {
    const SceneLibrary library({config.scene_path().begin(), config.scene_path().end()});
    const Result<Scene> scene = library.load(config.scene());
    if (!scene) return Status::error("scene: " + scene.message());
    run_only_listed(*scene, options);
  }
  return options;
}

Result<RigOptions> rig_options(const std::vector<Override>& overrides) {
  constexpr char kPrefix[] = "rig.";
  pb::RigConfig config;
  if (Status s = set_fields(config, overrides, kPrefix); !s) return s;
  Result<RigOptions> options = rig_options(config);
  if (!options) return Status::error(kPrefix + options.message());
  return options;
}

}  // namespace handrail
