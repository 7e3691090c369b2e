#include "devices/config/card_options.h"

#include <algorithm>

#include "devices/config/device_config_io.h"
#include "server/base/units.h"

namespace handrail {
namespace {

Vec3 three_of(const google::protobuf::RepeatedField<double>& values) {
  if (values.size() != 3) return Vec3::Zero();
  return {values.Get(0), values.Get(1), values.Get(2)};
}

// As many as the configuration has, which a check made to fit.
template <typename From, typename To>
void copy_given(const From& from, To& to) {
  for (int i = 0; i < from.size() && static_cast<std::size_t>(i) < to.size(); ++i) {
    to[static_cast<std::size_t>(i)] = from.Get(i);
  }
}

}  // namespace

ComediJoystickOptions joystick_options(const pb::JoystickConfig& c) {
  ComediJoystickOptions out;
  out.place = {c.device(), c.library(), c.board()};
  copy_given(c.encoder_subdevice(), out.encoder_subdevice);
  copy_given(c.encoder_channel(), out.encoder_channel);
  if (c.setup() == pb::JoystickConfig::NI_X4) out.setup = EncoderSetup::kNiX4;
  copy_given(c.counts_per_turn(), out.counts_per_turn);
  if (c.has_torque_subdevice()) out.torque_subdevice = c.torque_subdevice();
  copy_given(c.torque_channel(), out.torque_channel);
  copy_given(c.volts_per_n_m(), out.volts_per_n_m);
  if (c.has_most_force_n()) out.most_force = std::min(c.most_force_n(), kJoystickPeakForce);
  if (c.homing() == pb::JoystickConfig::CENTRE) out.homing = StickHoming::kCentre;
  out.travel = c.travel_mm() * kMm;
  if (c.has_button_subdevice()) out.button_subdevice = c.button_subdevice();
  out.button_channels.assign(c.button_channel().begin(), c.button_channel().end());
  out.button_low = c.button_low();
  return out;
}

FtMount mount_of(const pb::FtMountConfig& c) {
  return {{three_of(c.offset_mm()) * kMm, rotation_exp(three_of(c.turn_deg()) * kDeg)}};
}

ComediFtOptions comedi_sensor_options(const pb::FtConfig& config) {
  const pb::ComediFtConfig& c = config.comedi();
  ComediFtOptions out;
  if (c.kind() == pb::ComediFtConfig::ANALOG) out.kind = ComediFtKind::kAnalog;
  out.place = {c.device(), c.library(), ""};
  if (c.has_subdevice()) out.subdevice = c.subdevice();
  out.rate = c.rate_hz();
  out.filter = c.filter();
  copy_given(c.channel(), out.channels);
  out.range = c.input_range();
  out.reference = static_cast<unsigned int>(c.reference());
  for (int i = 0; i < c.matrix_size() && i < 36; ++i) out.matrix(i / 6, i % 6) = c.matrix(i);
  for (int i = 0; i < c.bias_v_size() && i < 6; ++i) out.bias[i] = c.bias_v(i);
  out.range_n = config.range_n();
  out.mount = mount_of(config.mount());
  return out;
}

}  // namespace handrail
