#include "server/scene/cards/card_check.h"

#include <cmath>
#include <filesystem>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

using CardProblem = std::optional<FieldProblem>;

template <typename Config>
CardProblem check_place(const Config& c, const std::string& block) {
  if (!c.device().starts_with("/")) {
    return FieldProblem{
        block + ".device",
        "'" + shown(c.device()) + "', expected the path of a device of comedi, from / on"};
  }
  if (c.library().empty()) {
    return FieldProblem{block + ".library", "empty, expected a library such as libcomedi.so.0"};
  }
  return std::nullopt;
}

template <typename List>
CardProblem check_none_twice(const List& channels, const std::string& field) {
  for (int j = 1; j < channels.size(); ++j) {
    for (int i = 0; i < j; ++i) {
      if (channels.Get(i) != channels.Get(j)) continue;
      return FieldProblem{field + "[" + std::to_string(j) + "]",
                          std::to_string(channels.Get(j)) + " is there already"};
    }
  }
  return std::nullopt;
}

CardProblem check_not_small(const google::protobuf::RepeatedField<double>& values,
                            const std::string& field, double least) {
  for (int i = 0; i < values.size(); ++i) {
    if (std::abs(values.Get(i)) >= least) continue;
    return FieldProblem{field + "[" + std::to_string(i) + "]",
                        number_text(values.Get(i)) + ", expected " + number_text(least) +
                            " or more, or, for the other direction, as much below 0"};
  }
  return std::nullopt;
}

// A row of zeros is an axis that never feels anything.
CardProblem check_matrix(const pb::ComediFtConfig& c, const std::string& block) {
  if (c.matrix_size() == 0) {
    return FieldProblem{
        block + ".matrix",
        "missing, but kind ANALOG needs the 36 numbers of the sensor's calibration"};
  }
  for (int row = 0; row < 6; ++row) {
    bool any = false;
    for (int i = 0; i < 6; ++i) any = any || c.matrix(6 * row + i) != 0.0;
    if (any) continue;
    return FieldProblem{block + ".matrix", "row " + std::to_string(row) +
                                               " (of 0 to 5) is all 0: that axis would "
                                               "feel nothing"};
  }
  return std::nullopt;
}

std::string beside(const std::string& file, const std::string& library) {
  const std::filesystem::path path(library);
  if (library.find('/') == std::string::npos || path.is_absolute()) return library;
  return (std::filesystem::path(file).parent_path() / path).string();
}

}  // namespace

std::optional<FieldProblem> check_joystick(const pb::DeviceConfig& config) {
  const bool used = config.kind() == pb::DeviceConfig::JOYSTICK;
  if (config.has_joystick() && !used) {
    return FieldProblem{"device.joystick", "only used with kind: JOYSTICK"};
  }
  const pb::JoystickConfig& c = config.joystick();
  const std::string block = "device.joystick";
  if (CardProblem p = check_place(c, block)) return p;
  // Fewer would be coarser than 1 mm at the tip.
  if (CardProblem p = check_not_small(c.counts_per_turn(), block + ".counts_per_turn", 1000.0)) {
    return p;
  }
  if (CardProblem p = check_not_small(c.volts_per_n_m(), block + ".volts_per_n_m", 0.01)) return p;
  if (CardProblem p = check_none_twice(c.torque_channel(), block + ".torque_channel")) return p;
  if (CardProblem p = check_none_twice(c.button_channel(), block + ".button_channel")) return p;
  if (c.button_channel_size() > 3) {
    return FieldProblem{block + ".button_channel", std::to_string(c.button_channel_size()) +
                                                       " channels, expected at most 3: clutch, "
                                                       "drop, dead-man"};
  }
  if (c.encoder_subdevice_size() == 2 && c.encoder_subdevice(0) != c.encoder_subdevice(1)) {
    return std::nullopt;  // counters of their own: their channels may be alike
  }
  return check_none_twice(c.encoder_channel(), block + ".encoder_channel");
}

std::optional<FieldProblem> check_comedi_sensor(const pb::FtConfig& config,
                                                const std::string& sensor) {
  const pb::FtMountConfig& mount = config.mount();
  if (mount.turn_deg_size() == 3) {
    const double turn = std::hypot(mount.turn_deg(0), mount.turn_deg(1), mount.turn_deg(2));
    if (turn > 180.0 * (1.0 + 1e-12)) {
      return FieldProblem{sensor + ".mount.turn_deg", number_text(std::round(10.0 * turn) / 10.0) +
                                                          " deg long, expected at most 180"};
    }
  }
  if (!config.has_comedi()) return std::nullopt;
  const char* const network = config.has_address()          ? "address"
                              : config.has_port()           ? "port"
                              : config.has_counts_per_n()   ? "counts_per_n"
                              : config.has_counts_per_n_m() ? "counts_per_n_m"
                              : config.has_dialect()        ? "dialect"
                                                            : nullptr;
  if (network != nullptr) {
    return FieldProblem{sensor + "." + network,
                        "is for a sensor on the network, but comedi is one at a card: expected one "
                        "of them"};
  }
  const pb::ComediFtConfig& c = config.comedi();
  const std::string block = sensor + ".comedi";
  if (CardProblem p = check_place(c, block)) return p;
  if (c.kind() == pb::ComediFtConfig::ANALOG) {
    if (c.has_filter()) return FieldProblem{block + ".filter", "only used with kind: JR3"};
    if (CardProblem p = check_none_twice(c.channel(), block + ".channel")) return p;
    return check_matrix(c, block);
  }
  const char* const analog = c.channel_size() > 0  ? ".channel"
                             : c.has_input_range() ? ".input_range"
                             : c.has_reference()   ? ".reference"
                             : c.matrix_size() > 0 ? ".matrix"
                             : c.bias_v_size() > 0 ? ".bias_v"
                                                   : nullptr;
  if (analog == nullptr) return std::nullopt;
  return FieldProblem{block + analog, "only used with kind: ANALOG"};
}

void resolve_libraries(const std::string& file, pb::DeviceConfig& config) {
  if (config.has_touch()) {
    config.mutable_touch()->set_library(beside(file, config.touch().library()));
  }
  if (config.has_joystick()) {
    config.mutable_joystick()->set_library(beside(file, config.joystick().library()));
  }
}

void resolve_libraries(const std::string& file, pb::FtConfig& config) {
  if (!config.has_comedi()) return;
  config.mutable_comedi()->set_library(beside(file, config.comedi().library()));
}

}  // namespace handrail
