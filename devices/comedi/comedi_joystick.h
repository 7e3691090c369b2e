// The dissertation's 2-DOF force-reflection joystick, at a card that comedi drives.
#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "devices/comedi/joystick_card.h"
#include "devices/comedi/joystick_force.h"
#include "devices/comedi/joystick_homing.h"
#include "devices/haptic_device.h"
#include "devices/input/turn_gate.h"

namespace handrail {

// What the thread that reads and pushes said last.
struct JoystickTick {
  Nanos at = -kForever;
  HapticSample sample;
  bool there = false;  // the card answers
  bool homed = false;
  StickWays seen{};               // how far it has been from side to side, ever [m]
  std::array<bool, 2> reached{};  // both of its stops
  bool hot = false;               // held at the rated force
  std::uint64_t ticks = 0;        // since it was opened
  std::uint64_t losses = 0;       // times that the card was gone
  Vec2 force = Vec2::Zero();      // what acts [N]
  DeviceTrouble lost_for{};       // why the card was lost, until it is homed anew
};

// M: X right, Y up (away from the user on a desk), the tip's arc at 15 cm; Z = 0.
//
// A thread of its own reads and pushes a thousand times a second, and calls in the loop between the
// two, for kAnswerPatience at most. Readings are not valid before the
// stick is homed, while the card is gone, which takes the homing with it, and 20 ms after the
// thread stood still. A card whose counts cannot be right, as they leap or go further than the
// stick has room for, is given up and opened again as one that was gone. The force is what
// JoystickForce allows: none before homing, none 50 ms after the last write(), within half a second
// back. The card keeps its voltages when a program is killed: closing sets them to zero, and what
// else can, only the motors' own drivers can.
class ComediJoystick final : public HapticDevice {
 public:
  explicit ComediJoystick(const ComediJoystickOptions& options);
  ~ComediJoystick() override { close(); }

  const HapticCapabilities& capabilities() const override { return capabilities_; }
  // One that is not homed is opened.
  Status open() override;
  HapticSample read(Nanos now) noexcept override;
  DeviceTrouble trouble() const noexcept override;
  Nanos wait(Nanos due) noexcept override;
  // Torque and Z are ignored; a force that is not finite counts as none.
  void write(const Wrench& f_H_M) noexcept override;
  void close() noexcept override;

  // The newest tick that read() has seen.
  const JoystickTick& tick() const noexcept { return tick_; }
  // "jr3_pci_1, driven by jr3_pci"; of the card that was opened.
  const std::string& card() const noexcept { return card_text_; }

 private:
  void run();
  bool turn(Nanos dt) noexcept;
  void look(const StickReading& reading, double dt) noexcept;
  bool refused(const char* what, int error) noexcept;
  bool went_too_far() noexcept;
  void lose() noexcept;
  void try_again(Nanos now);
  void begin_card() noexcept;

  ComediJoystickOptions options_;
  HapticCapabilities capabilities_;
  std::optional<ComediApi> api_;
  std::string card_text_;
  std::thread thread_;
  std::atomic<bool> stopping_{false};
  TurnGate<JoystickTick> gate_;

  // Of the thread.
  std::optional<JoystickCard> card_;
  JoystickHoming homing_;
  JoystickForce force_;
  JoystickTick now_;
  Nanos retry_at_ = 0;

  // Of who reads.
  JoystickTick tick_;
};

}  // namespace handrail
