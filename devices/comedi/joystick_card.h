// The card behind the 2-DOF joystick: two counters, two voltages, and digital inputs for buttons.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "devices/comedi/comedi_card.h"
#include "devices/comedi/encoder_count.h"
#include "devices/comedi/joystick_homing.h"
#include "devices/input/leap_guard.h"
#include "devices/input/reopen_pause.h"
#include "devices/joystick/joystick_data.h"

namespace handrail {

enum class EncoderSetup : std::uint8_t {
  kCounting,  // they count already
  kNiX4,      // counters of National Instruments, to be set up
};

// Two of each: of the motor that moves the stick right and left, and of that for up and down.
struct ComediJoystickOptions {
  ComediPlace place;
  std::array<std::optional<unsigned int>, 2> encoder_subdevice;  // none: the first with counters
  std::array<unsigned int, 2> encoder_channel = {0, 1};
  EncoderSetup setup = EncoderSetup::kCounting;
  // Motor MSMA041A1E: 2500 lines, four counts each. Negative: it counts the other way.
  std::array<double, 2> counts_per_turn = {10000.0, 10000.0};
  std::optional<unsigned int> torque_subdevice;  // none: the first with analog outputs
  std::array<unsigned int, 2> torque_channel = {0, 1};
  // Not in the dissertation: 10 V at the peak torque of 3.8 N m, which the motor's driver is set up
  // for. Negative: it turns the other way.
  std::array<double, 2> volts_per_n_m = {10.0 / 3.8, 10.0 / 3.8};
  double most_force = kJoystickPeakForce;  // at the tip, of each motor [N]
  StickHoming homing = StickHoming::kStops;
  double travel = 2.0 * kJoystickHalf;           // from stop to stop, at the tip [m]
  std::optional<unsigned int> button_subdevice;  // none: the first with digital inputs
  std::vector<unsigned int> button_channels;     // clutch, drop, dead-man; at most three
  bool button_low = true;                        // pressed is low
  Nanos reopen_pause = kReopenPause;             // from a millisecond on
};

struct StickReading {
  StickWays way{};  // since it was opened, at the tip [m]
  std::uint32_t buttons = 0;
  DeviceTrouble leap{};  // it went faster since the last reading than any hand; empty: it did not
};

// Two voltages that ask two motors for torque. Used by one thread.
class JoystickTorques {
 public:
  // Looks them up, and sets nothing.
  static Result<JoystickTorques> find(const ComediCard& card, const ComediJoystickOptions& options);
  // Holds them until the device is closed, and sets them to zero. When a program is killed the
  // kernel lets go of them, and leaves the voltages.
  Status hold(ComediCard& card);
  // Force at the tip [N]. 0, or errno. Real-time safe as far as the card's driver is.
  int push(ComediCard& card, const Vec2& force) noexcept;

 private:
  std::array<ComediChannel, 2> channels_;
  std::array<ComediRange, 2> range_;
  std::array<unsigned int, 2> max_data_{};
  std::array<double, 2> volts_per_n_m_{};
};

// Used by one thread.
class JoystickCard {
 public:
  // Opens it, sets the counters up and the torques to zero. The error says what the card has not.
  static Result<JoystickCard> open(const ComediApi& api, const ComediJoystickOptions& options);

  // Opens it, looks whether it has all that, and closes it: nothing is set. "BOARD, driven by
  // DRIVER".
  static Result<std::string> look(const ComediApi& api, const ComediJoystickOptions& options);

  // 0, or errno. Real-time safe as far as the card's driver is.
  int read(StickReading& out) noexcept;
  // Force at the tip [N].
  int push(const Vec2& force) noexcept { return torques_.push(card_, force); }

  const std::string& board() const { return card_.board(); }
  const std::string& driver() const { return card_.driver(); }

 private:
  JoystickCard(ComediCard card, const ComediJoystickOptions& options)
      : card_(std::move(card)), options_(options), guard_(a_count(options)) {}
  static Result<JoystickCard> found(const ComediApi& api, const ComediJoystickOptions& options);
  Status find_encoders();
  Status find_buttons();
  Status set_up_ni();
  Status begin();
  // Of each motor, at the tip [m].
  static Vec3 a_count(const ComediJoystickOptions& options);
  DeviceTrouble leap_of(Nanos from, Nanos to) noexcept;

  ComediCard card_;
  ComediJoystickOptions options_;
  std::array<ComediChannel, 2> encoders_;
  std::array<ComediChannel, 5> inputs_;  // encoders, then buttons
  std::size_t input_count_ = 2;
  JoystickTorques torques_;
  std::array<EncoderCount, 2> counts_;
  LeapGuard guard_;
};

}  // namespace handrail
