#include "devices/config/device_config_io.h"

#include <algorithm>

#include "devices/config/card_options.h"
#include "server/base/units.h"

namespace handrail {
namespace {

// Of a port or an output, as the check of the configuration leaves it.
std::uint16_t port_of(std::uint32_t value) { return static_cast<std::uint16_t>(value); }

MxtGripper gripper_of(const pb::GripperConfig& config) {
  MxtGripper out;
  out.close = port_of(config.close_output());
  if (config.has_open_output()) out.open = port_of(config.open_output());
  return out;
}

DeflectionSettings deflection_of(const pb::DeflectionConfig& config) {
  DeflectionSettings out;
  out.mode = config.mode() == pb::DeflectionConfig::POSITION ? DeflectionMode::kPosition
                                                             : DeflectionMode::kVelocity;
  out.speed = config.speed_mm_s() * kMm;
  out.turn_rate = config.turn_deg_s() * kDeg;
  out.reach = config.reach_mm() * kMm;
  out.tilt = config.tilt_deg() * kDeg;
  return out;
}

SpaceMouseOptions spacemouse_options(const pb::SpaceMouseConfig& config) {
  SpaceMouseOptions out;
  out.socket = config.socket();
  out.motion = deflection_of(config.motion());
  out.full_counts = config.full_counts();
  out.patience = static_cast<Nanos>(config.patience_ms() * 1e6);
  out.clutch_button = static_cast<int>(config.clutch_button());
  out.drop_button = static_cast<int>(config.drop_button());
  if (config.has_enable_button()) out.enable_button = static_cast<int>(config.enable_button());
  return out;
}

ForceStickOptions force_stick_options(const pb::ForceStickConfig& config) {
  ForceStickOptions out;
  out.path = config.device();
  if (config.axes() == pb::ForceStickConfig::WHEEL) out.axes = ForceStickAxes::kWheel;
  out.reach = config.reach_mm() * kMm;
  for (int i = 0; i < config.full_force_n_size() && i < 2; ++i) {
    out.full[static_cast<std::size_t>(i)] = config.full_force_n(i);
  }
  out.upload_period = 1.0 / config.upload_hz();
  out.most_upload = config.upload_ms() * 1e-3;
  out.delay = config.delay_ms() * 1e-3;
  out.axis_counts = static_cast<int>(config.axis_counts());
  out.mass = config.mass_kg();
  out.damping = config.damping_n_s_m();
  out.friction = config.friction_n();
  return out;
}

}  // namespace

HapticDeviceOptions haptic_options(const pb::DeviceConfig& config) {
  HapticDeviceOptions out;
  switch (config.kind()) {
    case pb::DeviceConfig::SIM_OMNI: out.kind = HapticDeviceKind::kSimOmni; break;
    case pb::DeviceConfig::SIM_OMNI_TORQUE: out.kind = HapticDeviceKind::kSimOmniTorque; break;
    case pb::DeviceConfig::RECORDED: out.kind = HapticDeviceKind::kRecorded; break;
    case pb::DeviceConfig::SIM_JOYSTICK: out.kind = HapticDeviceKind::kSimJoystick; break;
    case pb::DeviceConfig::PAGE: out.kind = HapticDeviceKind::kPage; break;
    case pb::DeviceConfig::SPACEMOUSE: out.kind = HapticDeviceKind::kSpaceMouse; break;
    case pb::DeviceConfig::TOUCH: out.kind = HapticDeviceKind::kTouch; break;
    case pb::DeviceConfig::GAMEPAD: out.kind = HapticDeviceKind::kGamepad; break;
    case pb::DeviceConfig::JOYSTICK: out.kind = HapticDeviceKind::kJoystick; break;
    case pb::DeviceConfig::FORCE_STICK: out.kind = HapticDeviceKind::kForceStick; break;
  }
  out.spacemouse = spacemouse_options(config.spacemouse());
  out.gamepad.path = config.gamepad().device();
  out.gamepad.motion = deflection_of(config.gamepad().motion());
  out.gamepad.dead_share = config.gamepad().dead_share();
  out.gamepad.rumble_share = config.gamepad().rumble_share();
  out.touch = {config.touch().name(), config.touch().library()};
  out.joystick = joystick_options(config.joystick());
  out.force_stick = force_stick_options(config.force_stick());
  const pb::HandModel& hand = config.hand();
  out.recording_path = config.recording();
  const bool cursor = out.kind == HapticDeviceKind::kPage;
  if (cursor || out.kind == HapticDeviceKind::kSimJoystick) {
    // The defaults of a hand are those of a stylus; around a handle it is another, and one that is
    // led by a person does not wander by itself.
    out.hand = usual_hand(out.kind, hand.seed());
    if (hand.has_mass_kg()) out.hand.mass = hand.mass_kg();
    if (hand.has_stiffness_n_mm()) out.hand.stiffness = hand.stiffness_n_mm() * kNewtonPerMm;
    if (hand.has_damping_ratio()) out.hand.damping_ratio = hand.damping_ratio();
    if (!cursor || hand.has_tremor_rms_mm()) out.hand.tremor_rms = hand.tremor_rms_mm() * kMm;
    if (!cursor || hand.has_drift_rms_mm()) out.hand.drift_rms = hand.drift_rms_mm() * kMm;
    if (!cursor || hand.has_reaction_ms()) out.hand.reaction = hand.reaction_ms() * 1e-3;
    return out;
  }
  out.hand.seed = hand.seed();
  out.hand.mass = hand.mass_kg();
  out.hand.stiffness = hand.stiffness_n_mm() * kNewtonPerMm;
  out.hand.damping_ratio = hand.damping_ratio();
  out.hand.tremor_rms = hand.tremor_rms_mm() * kMm;
  out.hand.drift_rms = hand.drift_rms_mm() * kMm;
  out.hand.drift_rotation_rms = hand.drift_rms_deg() * kDeg;
  out.hand.reaction = hand.reaction_ms() * 1e-3;
  return out;
}

MelfaOptions robot_options(const pb::RobotConfig& config) {
  MelfaOptions out;
  out.address = config.address();
  out.port = port_of(config.port());
  out.command_port = port_of(config.command_port());
  out.program = config.program();
  out.client.packet_bytes = config.packet_bytes();
  if (config.has_gripper()) out.client.gripper = gripper_of(config.gripper());
  return out;
}

NetFtOptions sensor_options(const pb::FtConfig& config) {
  NetFtOptions out;
  out.address = config.address();
  out.port = port_of(config.port());
  out.range_n = config.range_n();
  out.mount = mount_of(config.mount());
  RdtClientOptions& client = out.client;
  client.counts_per_n = config.counts_per_n();
  client.counts_per_n_m = config.counts_per_n_m();
  if (config.dialect() != pb::FtConfig::ONROBOT) return out;
  client.dialect = RdtDialect::kOnRobot;
  if (!config.has_counts_per_n()) client.counts_per_n = kOnRobotCountsPerN;
  if (!config.has_counts_per_n_m()) client.counts_per_n_m = kOnRobotCountsPerNm;
  if (config.has_rate_hz()) client.period_ms = 1000 / config.rate_hz();
  if (config.has_sensor_filter_hz()) {
    const auto found = std::find(kRdtFilters.begin(), kRdtFilters.end(), config.sensor_filter_hz());
    client.filter = static_cast<std::uint32_t>(found - kRdtFilters.begin());
  }
  return out;
}

MadeSensor make_sensor(const pb::FtConfig& config, ComediFtSensor::Say say, bool waits) {
  if (!config.enabled()) return {};
  if (config.has_comedi()) {
    ComediFtOptions options = comedi_sensor_options(config);
    options.waits = waits;
    return {std::make_unique<ComediFtSensor>(options, std::move(say)), nullptr};
  }
  NetFtOptions options = sensor_options(config);
  options.waits = waits;
  auto net = std::make_unique<NetFtSensor>(options);
  NetFtSensor* const known = net.get();
  return {std::move(net), known};
}

std::optional<StopSwitchOptions> switch_options(const pb::SlaveConfig& config) {
  if (!config.has_stop_switch()) return std::nullopt;
  StopSwitchOptions out;
  out.path = config.stop_switch().device();
  if (config.stop_switch().has_key()) out.key = static_cast<int>(config.stop_switch().key());
  return out;
}

}  // namespace handrail
