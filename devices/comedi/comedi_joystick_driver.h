// The 2-DOF joystick for `handrail devices`.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/comedi/comedi_joystick.h"
#include "devices/driver.h"
#include "devices/self_test/hand_test.h"

namespace handrail {

class ComediJoystickDriver final : public Driver {
 public:
  explicit ComediJoystickDriver(const ComediJoystickOptions& options) : options_(options) {}

  std::string what() const override { return "2-DOF force-reflection joystick, by comedi"; }
  std::string daemon() const override { return "handrail-master"; }
  // Looks at the card, and sets nothing: it may be another device's.
  std::vector<Sighting> probe() override;
  StartedTest test(const TestWishes& wishes) override;
  // Finds its travel from stop to stop.
  StartedTest calibrate() override;

 private:
  StartedTest start(const std::optional<TestWishes>& wishes) const;

  ComediJoystickOptions options_;
};

// Homed by hand within 60 s, then looked at as any haptic device. Without wishes: moved to its
// stops until it goes no further, which gives its travel.
class ComediJoystickTrial final : public SelfTest {
 public:
  // `device` is open.
  ComediJoystickTrial(std::unique_ptr<ComediJoystick> device,
                      const std::optional<TestWishes>& wishes,
                      const ComediJoystickOptions& options);

  bool turn(Nanos now) override;
  std::string asks() const override;
  std::vector<TestItem> items() const override;
  std::string block() const override;

 private:
  const JoystickTick& tick() const { return device_->tick(); }
  bool homes(Nanos now);
  bool measures(Nanos now);
  TestItem homing() const;
  TestItem travel(std::size_t motor) const;

  std::unique_ptr<ComediJoystick> own_;  // until it is homed
  ComediJoystick* device_;
  std::unique_ptr<HandTest> test_;  // owns it then
  std::optional<TestWishes> wishes_;
  ComediJoystickOptions options_;
  bool started_ = false, gave_up_ = false;
  Nanos began_ = 0, grew_at_ = 0;
  StickWays seen_{};
  bool was_hot_ = false;
};

}  // namespace handrail
