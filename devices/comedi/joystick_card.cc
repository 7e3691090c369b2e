#include "devices/comedi/joystick_card.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>

#include "devices/comedi/ft_scale.h"
#include "server/base/clock.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr int kCounters[] = {kComediCounter};
constexpr int kOutputs[] = {kComediAnalogOut};
constexpr int kDigital[] = {kComediDigitalIn, kComediDigitalBoth};
// A counter of fewer bits would go round within a stroke: 8 bits are 24 mm.
constexpr unsigned int kLeastCounter = 0xffff;

constexpr const char* kMotors[] = {"right-left", "up-down"};

constexpr double kStickTurn = 2.0 * std::numbers::pi * kJoystickStick;  // at the tip [m]

}  // namespace

Result<JoystickTorques> JoystickTorques::find(const ComediCard& card,
                                              const ComediJoystickOptions& options) {
  const auto subdevice = card.subdevice("torque", options.torque_subdevice, kOutputs);
  if (!subdevice) return subdevice.status();
  JoystickTorques out;
  out.volts_per_n_m_ = options.volts_per_n_m;
  for (std::size_t i = 0; i < 2; ++i) {
    out.channels_[i] = {*subdevice, options.torque_channel[i], 0, 0};
    const auto range = card.range(out.channels_[i]);
    if (!range) return range.status();
    // From one side to the other, or there is no voltage that means none.
    if (range->unit != kComediVolt || range->min >= 0.0 || range->max <= 0.0) {
      return card.error("torque " + std::string(kMotors[i]) + ": channel " +
                        std::to_string(options.torque_channel[i]) + " gives " +
                        number_text(range->min) + " to " + number_text(range->max) +
                        ", expected volts of both signs; another card, or another channel");
    }
    out.range_[i] = *range;
    out.max_data_[i] = card.max_data(out.channels_[i]);
  }
  return out;
}

Status JoystickTorques::hold(ComediCard& card) {
  if (card.api().lock(card.handle(), channels_[0].subdevice) < 0) {
    return card.error("its torques are another program's; end that program, a master most likely");
  }
  // Whatever was left at the outputs ends.
  const int error = push(card, Vec2::Zero());
  if (error == 0) return Status::ok();
  return card.error(std::string("its torques cannot be set to zero: ") + std::strerror(error) +
                    "; does another program use it?");
}

int JoystickTorques::push(ComediCard& card, const Vec2& force) noexcept {
  std::array<unsigned int, 2> values{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double torque = force[static_cast<Eigen::Index>(i)] * kJoystickStick;  // [N m]
    values[i] = comedi_number(torque * volts_per_n_m_[i], range_[i], max_data_[i]);
  }
  return card.write(channels_, values);
}

Result<JoystickCard> JoystickCard::found(const ComediApi& api,
                                         const ComediJoystickOptions& options) {
  auto card = ComediCard::open(api, options.place);
  if (!card) return card.status();
  JoystickCard out(std::move(*card), options);
  auto torques = JoystickTorques::find(out.card_, options);
  if (!torques) return torques.status();
  out.torques_ = *torques;
  if (Status s = out.find_encoders(); !s) return s;
  if (Status s = out.find_buttons(); !s) return s;
  return out;
}

Result<std::string> JoystickCard::look(const ComediApi& api, const ComediJoystickOptions& options) {
  const auto card = found(api, options);
  if (!card) return card.status();
  return card->board() + ", driven by " + card->driver();
}

Result<JoystickCard> JoystickCard::open(const ComediApi& api,
                                        const ComediJoystickOptions& options) {
  auto out = found(api, options);
  if (!out) return out;
  if (Status s = out->torques_.hold(out->card_); !s) return s;
  if (options.setup == EncoderSetup::kNiX4) {
    if (Status s = out->set_up_ni(); !s) return s;
  }
  if (Status s = out->begin(); !s) return s;
  return out;
}

Status JoystickCard::find_encoders() {
  for (std::size_t i = 0; i < 2; ++i) {
    const auto subdevice = card_.subdevice("encoder", options_.encoder_subdevice[i], kCounters);
    if (!subdevice) return subdevice.status();
    encoders_[i] = {*subdevice, options_.encoder_channel[i], 0, 0};
    const unsigned int most = card_.max_data(encoders_[i]);
    if (most >= kLeastCounter) continue;
    return card_.error("encoder " + std::string(kMotors[i]) + ": channel " +
                       std::to_string(options_.encoder_channel[i]) + " counts to " +
                       std::to_string(most) +
                       ", expected 65535 or more; comedi_board_info shows the counters");
  }
  return Status::ok();
}

Status JoystickCard::find_buttons() {
  std::copy(encoders_.begin(), encoders_.end(), inputs_.begin());
  input_count_ = 2;
  if (options_.button_channels.empty()) return Status::ok();
  const auto subdevice = card_.subdevice("buttons", options_.button_subdevice, kDigital);
  if (!subdevice) return subdevice.status();
  for (const unsigned int channel : options_.button_channels) {
    if (input_count_ == inputs_.size()) break;
    inputs_[input_count_++] = {*subdevice, channel, 0, 0};
  }
  return Status::ok();
}

// As libcomedi's own example gpct_encoder.c does; which inputs the tracks are at stays as the card
// has it.
Status JoystickCard::set_up_ni() {
  const ComediApi& api = card_.api();
  for (std::size_t i = 0; i < 2; ++i) {
    const unsigned int s = encoders_[i].subdevice;
    if (api.reset(card_.handle(), s) >= 0 &&
        api.gate(card_.handle(), s, 0, 0, kComediNiNoGate) >= 0 &&
        api.gate(card_.handle(), s, 0, 1, kComediNiNoGate) >= 0 &&
        api.counter_mode(card_.handle(), s, 0, kComediNiX4 | kComediNiUpDown) >= 0 &&
        api.arm(card_.handle(), s, 0) >= 0) {
      continue;
    }
    return card_.error("encoder " + std::string(kMotors[i]) + ": the counter at subdevice " +
                       std::to_string(s) +
                       " cannot be set up as one of National Instruments; setup: COUNTING for "
                       "others");
  }
  return Status::ok();
}

Status JoystickCard::begin() {
  std::array<unsigned int, 5> raw{};
  const int error = card_.read(std::span(inputs_).first(input_count_), raw);
  if (error != 0) {
    return card_.error(std::string("its inputs cannot be read: ") + std::strerror(error) +
                       "; comedi_board_info shows the channels");
  }
  for (std::size_t i = 0; i < 2; ++i) counts_[i].begin(raw[i], card_.max_data(encoders_[i]));
  return Status::ok();
}

Vec3 JoystickCard::a_count(const ComediJoystickOptions& options) {
  const auto& turn = options.counts_per_turn;
  return Vec3(kStickTurn / std::abs(turn[0]), kStickTurn / std::abs(turn[1]), 0.0);
}

DeviceTrouble JoystickCard::leap_of(Nanos from, Nanos to) noexcept {
  const Vec3 counts(static_cast<double>(counts_[0].count()),
                    static_cast<double>(counts_[1].count()), 0.0);
  const auto leap = guard_.next(counts.cwiseProduct(a_count(options_)), from, to);
  if (!leap) return {};
  const auto i = static_cast<std::size_t>(leap->axis);
  std::array<char, 80> what{};
  std::snprintf(what.data(), what.size(), "its encoder %s leapt by %lld counts,", kMotors[i],
                static_cast<long long>(counts_[i].step()));
  return leap_text(what.data(), *leap);
}

int JoystickCard::read(StickReading& out) noexcept {
  std::array<unsigned int, 5> raw{};
  const Nanos from = monotonic_now();
  const int error = card_.read(std::span(inputs_).first(input_count_), raw);
  if (error != 0) return error;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto counts = static_cast<double>(counts_[i].next(raw[i]));
    out.way[i] = kStickTurn * counts / options_.counts_per_turn[i];
  }
  out.leap = leap_of(from, monotonic_now());
  out.buttons = 0;
  for (std::size_t i = 2; i < input_count_; ++i) {
    if ((raw[i] == 0) == options_.button_low) out.buttons |= 1u << (i - 2);
  }
  return 0;
}

}  // namespace handrail
