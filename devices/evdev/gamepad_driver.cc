#include "devices/evdev/gamepad_driver.h"

#include <memory>
#include <utility>

#include "devices/evdev/pad_sightings.h"
#include "devices/self_test/hand_test.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

std::string gamepad_block(const GamepadOptions& o) {
  return "device { kind: GAMEPAD gamepad { " +
         (o.path.empty() ? "" : "device: \"" + o.path + "\" ") +
         "dead_share: " + number_text(o.dead_share) + " } }";
}

}  // namespace

std::vector<Sighting> GamepadDriver::probe() {
  return pad_sightings(kernel_, options_.path, options_.input_folder, gamepad_wish());
}

StartedTest GamepadDriver::test(const TestWishes& wishes) {
  auto device = std::make_unique<GamepadDevice>(options_, kernel_);
  if (const Status opened = device->open(); !opened) return opened;
  // Its sticks turn the hand about the vertical alone.
  return StartedTest(std::make_unique<HandTest>(std::move(device), wishes, gamepad_block(options_),
                                                std::array{false, true, false}));
}

StartedTest GamepadDriver::calibrate() {
  return Status::error(
      "gamepad: there is nothing to find out, the kernel knows its ranges; of "
      "one that creeps "
      "while it is let go of, raise device.gamepad.dead_share");
}

}  // namespace handrail
