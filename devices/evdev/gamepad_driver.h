// The gamepad for `handrail devices`.
#pragma once

#include <string>
#include <vector>

#include "devices/driver.h"
#include "devices/evdev/gamepad_device.h"

namespace handrail {

class GamepadDriver final : public Driver {
 public:
  explicit GamepadDriver(const GamepadOptions& options, EvdevKernel& kernel = evdev_kernel())
      : options_(options), kernel_(kernel) {}

  std::string what() const override { return "gamepad or joystick, through the kernel"; }
  std::string daemon() const override { return "handrail-master"; }
  // The configured one, else every gamepad and joystick there is.
  std::vector<Sighting> probe() override;
  StartedTest test(const TestWishes& wishes) override;
  // There is nothing to find out: the kernel knows the ranges of the axes.
  StartedTest calibrate() override;

 private:
  GamepadOptions options_;
  EvdevKernel& kernel_;
};

}  // namespace handrail
