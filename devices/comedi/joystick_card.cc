#include "devices/comedi/joystick_card.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <utility>

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
// Straight punches of Olympic boxers come at 9.14 m/s, with a deviation of 2.06 (Walilko, Viano and
// Bir 2005, doi 10.1136/bjsm.2004.014126), and have more room to get so fast than a stick has.
// Let go of under its motors' peak force this one comes to less: 25 N move 0.3 kg over 0.2 m to
// 5.8 m/s. [m/s]
constexpr double kFastestStick = 10.0;

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
  read_from_ = monotonic_now();
  const int error = card_.read(std::span(inputs_).first(input_count_), raw);
  if (error != 0) {
    return card_.error(std::string("its inputs cannot be read: ") + std::strerror(error) +
                       "; comedi_board_info shows the channels");
  }
  for (std::size_t i = 0; i < 2; ++i) counts_[i].begin(raw[i], card_.max_data(encoders_[i]));
  return Status::ok();
}

// N counts are a way of more than N - 1 of them.
DeviceTrouble JoystickCard::leap_in(Nanos time) const noexcept {
  for (std::size_t i = 0; i < 2; ++i) {
    const auto counts = static_cast<double>(counts_[i].step());
    const double a_count = kStickTurn / std::abs(options_.counts_per_turn[i]);
    if ((std::abs(counts) - 1.0) * a_count <= kFastestStick * to_seconds(time)) continue;
    std::array<char, 200> text{};
    std::snprintf(text.data(), text.size(),
                  "its encoder %s leapt by %.0f counts, %.1f mm, in %.2f ms: %.0f m/s, and at most "
                  "%.0f are a hand's; look at its cable",
                  kMotors[i], counts, 1e3 * counts * a_count, 1e3 * to_seconds(time),
                  std::abs(counts) * a_count / to_seconds(time), kFastestStick);
    return fixed_text<DeviceTrouble>(text.data());
  }
  return {};
}

int JoystickCard::read(StickReading& out) noexcept {
  std::array<unsigned int, 5> raw{};
  const Nanos from = monotonic_now();
  const int error = card_.read(std::span(inputs_).first(input_count_), raw);
  if (error != 0) return error;
  const Nanos since = std::exchange(read_from_, from);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto counts = static_cast<double>(counts_[i].next(raw[i]));
    out.way[i] = kStickTurn * counts / options_.counts_per_turn[i];
  }
  out.leap = leap_in(monotonic_now() - since);
  out.buttons = 0;
  for (std::size_t i = 2; i < input_count_; ++i) {
    if ((raw[i] == 0) == options_.button_low) out.buttons |= 1u << (i - 2);
  }
  return 0;
}

}  // namespace handrail
