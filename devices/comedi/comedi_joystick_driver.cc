#include "devices/comedi/comedi_joystick_driver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "devices/comedi/comedi_sighting.h"
#include "server/base/plain_text.h"
#include "server/base/units.h"

namespace handrail {
namespace {

constexpr Nanos kStickHoming = 60 * kSecond;
constexpr Nanos kStopsReached = 5 * kSecond;  // it went no further for so long
constexpr double kMoved = 0.5 * kMm;          // further than a hand trembles; chosen [m]
constexpr double kWholeTurn = 0.95;           // of a stick of 15 cm, along the arc [m]
constexpr double kLeastTravel = 0.05;         // a stick that was moved [m]
// An arc of +-100 mm, or one whose chord that is (+-41.8 deg), and what rubber gives.
constexpr double kLeastStops = 0.19, kMostStops = 0.225;  // [m]

constexpr std::array kMotorNames = {"right-left", "up-down"};
constexpr std::array kTravelChecks = {"travel.right", "travel.up"};

template <typename... Values>
std::string stick_text(const char* format, Values... values) {
  std::array<char, 240> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

template <typename List>
std::string number_list(const List& values) {
  std::string out;
  for (const auto value : values) {
    out += (out.empty() ? "[" : ", ") + number_text(static_cast<double>(value));
  }
  return out + "]";
}

// `travel` in steps of a millimetre, as it is configured.
std::string joystick_block(const ComediJoystickOptions& o, double travel) {
  const ComediJoystickOptions usual;
  std::string inner = comedi_place_block(o.place);
  if (o.encoder_subdevice[0] && o.encoder_subdevice[1]) {
    inner += "encoder_subdevice: " +
             number_list(std::array{*o.encoder_subdevice[0], *o.encoder_subdevice[1]}) + " ";
  }
  if (o.encoder_channel != usual.encoder_channel) {
    inner += "encoder_channel: " + number_list(o.encoder_channel) + " ";
  }
  if (o.setup == EncoderSetup::kNiX4) inner += "setup: NI_X4 ";
  if (o.counts_per_turn != usual.counts_per_turn) {
    inner += "counts_per_turn: " + number_list(o.counts_per_turn) + " ";
  }
  if (o.torque_subdevice) inner += "torque_subdevice: " + std::to_string(*o.torque_subdevice) + " ";
  if (o.torque_channel != usual.torque_channel) {
    inner += "torque_channel: " + number_list(o.torque_channel) + " ";
  }
  if (o.volts_per_n_m != usual.volts_per_n_m) {
    inner += "volts_per_n_m: " + number_list(o.volts_per_n_m) + " ";
  }
  if (o.most_force < usual.most_force) {
    inner += "most_force_n: " + number_text(o.most_force) + " ";
  }
  if (o.homing == StickHoming::kCentre) inner += "homing: CENTRE ";
  if (o.button_subdevice) inner += "button_subdevice: " + std::to_string(*o.button_subdevice) + " ";
  if (!o.button_channels.empty()) {
    inner += "button_channel: " + number_list(o.button_channels) + " ";
  }
  if (!o.button_low) inner += "button_low: false ";
  if (std::abs(travel - usual.travel) > 0.5 * kMm) {
    inner += "travel_mm: " + number_text(std::round(travel / kMm)) + " ";
  }
  return "device { kind: JOYSTICK" + (inner.empty() ? "" : " joystick { " + inner + "}") + " }";
}

}  // namespace

std::vector<Sighting> ComediJoystickDriver::probe() {
  const auto api = load_comedi(options_.place.library);
  if (!api) return comedi_sightings(options_.place, api.message());
  const auto card = JoystickCard::look(*api, options_);
  if (!card) return comedi_sightings(options_.place, card.message());
  return {comedi_library_there(options_.place),
          {options_.place.device, Readiness::kReady,
           *card + ": two counters, two voltages; whether a joystick is at them cannot be seen",
           "handrail devices test joystick"}};
}

StartedTest ComediJoystickDriver::start(const std::optional<TestWishes>& wishes) const {
  ComediJoystickOptions options = options_;
  // How far it goes is what is asked for: till a whole turn nothing is too far, and nothing homed.
  if (!wishes) {
    options.homing = StickHoming::kStops;
    options.travel = kWholeTurn;
  }
  auto device = std::make_unique<ComediJoystick>(options);
  if (const Status opened = device->open(); !opened) return opened;
  return StartedTest(std::make_unique<ComediJoystickTrial>(std::move(device), wishes, options_));
}

StartedTest ComediJoystickDriver::test(const TestWishes& wishes) { return start(wishes); }

StartedTest ComediJoystickDriver::calibrate() { return start(std::nullopt); }

ComediJoystickTrial::ComediJoystickTrial(std::unique_ptr<ComediJoystick> device,
                                         const std::optional<TestWishes>& wishes,
                                         const ComediJoystickOptions& options)
    : own_(std::move(device)), device_(own_.get()), wishes_(wishes), options_(options) {}

bool ComediJoystickTrial::turn(Nanos now) {
  if (!std::exchange(started_, true)) began_ = grew_at_ = now;
  bool goes_on = false;
  if (test_ != nullptr) {
    goes_on = test_->turn(now);
  } else {
    (void)device_->read(now);
    goes_on = wishes_ ? homes(now) : measures(now);
  }
  was_hot_ = was_hot_ || tick().hot;
  return goes_on;
}

// False: it will not be homed.
bool ComediJoystickTrial::homes(Nanos now) {
  if (tick().homed) {
    test_ = std::make_unique<HandTest>(std::move(own_), *wishes_, block());
    return true;
  }
  gave_up_ = wishes_->alone || now - began_ >= kStickHoming;
  return !gave_up_;
}

// False: it goes no further.
bool ComediJoystickTrial::measures(Nanos now) {
  for (std::size_t i = 0; i < 2; ++i) {
    if (tick().seen[i] > seen_[i] + kMoved) {
      seen_[i] = tick().seen[i];
      grew_at_ = now;
    }
  }
  const bool moved = seen_[0] >= kLeastTravel && seen_[1] >= kLeastTravel;
  gave_up_ = !moved && now - began_ >= kStickHoming;
  return !gave_up_ && !(moved && now - grew_at_ >= kStopsReached);
}

std::string ComediJoystickTrial::asks() const {
  if (test_ != nullptr) return test_->asks();
  if (!wishes_) return "move it to its four stops: right, left, up, down, and round once";
  for (std::size_t i = 0; i < 2; ++i) {
    if (!tick().reached[i]) return std::string("move it to both of its stops, ") + kMotorNames[i];
  }
  return {};
}

TestItem ComediJoystickTrial::homing() const {
  if (!text_of(tick().lost_for).empty()) {
    return {"homing", Verdict::kBad, tick().lost_for.data(),
            "then move it to its four stops; handrail devices calibrate joystick"};
  }
  if (tick().homed) return {"homing", Verdict::kOk, "its middle is known", ""};
  return {"homing", gave_up_ ? Verdict::kBad : Verdict::kNotSeen,
          stick_text("it went %.0f by %.0f mm of the %.0f from stop to stop", tick().seen[0] / kMm,
                     tick().seen[1] / kMm, options_.travel / kMm),
          wishes_ && wishes_->alone
              ? "leave out --alone: it is homed by hand"
              : "move it to all four stops; a motor that shows 0 mm: its encoder's cable"};
}

TestItem ComediJoystickTrial::travel(std::size_t motor) const {
  const double way = seen_[motor];
  const bool good = way >= kLeastStops && way <= kMostStops;
  return {kTravelChecks[motor], good ? Verdict::kOk : Verdict::kBad,
          stick_text("from stop to stop %.1f mm, 200 mm as an arc or 219 mm as a chord expected",
                     way / kMm),
          good ? "" : "was it moved to both stops? else counts_per_turn is another, or its cable"};
}

std::vector<TestItem> ComediJoystickTrial::items() const {
  std::vector<TestItem> out = {
      {"card", tick().there ? Verdict::kOk : Verdict::kBad,
       device_->card() +
           stick_text("; it was gone %llu times", static_cast<unsigned long long>(tick().losses)),
       tick().there ? "" : "sudo dmesg | grep comedi"}};
  if (!wishes_) {
    out.push_back(travel(0));
    out.push_back(travel(1));
    return out;
  }
  out.push_back(homing());
  if (was_hot_) {
    out.push_back({"heat", Verdict::kBad, "it pushed more than it sustains, and was held at that",
                   "a smaller force"});
  }
  if (test_ == nullptr) return out;
  const std::vector<TestItem> more = test_->items();
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

// Of the smaller travel, so that both can be homed.
std::string ComediJoystickTrial::block() const {
  const bool measured = !wishes_ && seen_[0] >= kLeastTravel && seen_[1] >= kLeastTravel;
  return joystick_block(options_, measured ? std::min(seen_[0], seen_[1]) : options_.travel);
}

}  // namespace handrail
