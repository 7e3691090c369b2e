#include "devices/evdev/gamepad_driver.h"

#include <unistd.h>

#include <filesystem>
#include <memory>
#include <utility>

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
  const bool named = !options_.path.empty();
  std::vector<Sighting> out;
  for (const std::string& path :
       named ? std::vector{options_.path} : gamepad_paths(options_.input_folder)) {
    const auto opened = open_evdev(kernel_, path, EvdevUse::kShare);
    if (!opened) {
      const bool there = std::filesystem::exists(std::filesystem::symlink_status(path));
      // Of those that nobody may read it is not known what they are: a name of
      // udev's says it.
      if (named || path.ends_with("-event-joystick")) {
        out.push_back(sighting_of(path, there ? Readiness::kUnfinished : Readiness::kAbsent,
                                  opened.message()));
      }
      continue;
    }
    ::close(opened->fd);
    const std::string name(text_of(opened->name));
    if (drives(*opened)) {
      out.push_back({path, Readiness::kReady,
                     name + (is_gamepad(*opened) ? ", a gamepad" : ", a joystick"), ""});
    } else if (named) {
      out.push_back({path, Readiness::kUnfinished, name + " has no stick with two axes and buttons",
                     "name a gamepad or joystick in device.gamepad.device"});
    }
  }
  if (out.empty()) {
    out.push_back(
        {options_.input_folder, Readiness::kAbsent, "no gamepad and no joystick", "plug one in"});
  }
  return out;
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
