#include <functional>
#include <memory>
#include <string>

#include "devices/evdev/gamepad_device.h"
#include "devices/evdev/stop_switch.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/kernel/trial.h"
#include "tests/kernel/uinput_device.h"

namespace handrail::kernel {
namespace {

constexpr char kPadLink[] = "/tmp/pad";
constexpr char kSwitchLink[] = "/tmp/switch";

std::unique_ptr<UinputDevice> plug_pad() {
  return std::make_unique<UinputDevice>("Handrail pad",
                                        std::vector<int>{BTN_SOUTH, BTN_EAST, BTN_TL, BTN_TR},
                                        std::vector<int>{ABS_X, ABS_Y, ABS_RX, ABS_RY}, kPadLink);
}

std::unique_ptr<UinputDevice> plug_switch() {
  return std::make_unique<UinputDevice>("Handrail switch", std::vector<int>{KEY_B},
                                        std::vector<int>{}, kSwitchLink);
}

// Within five seconds.
bool becomes(const std::function<bool()>& what) {
  for (int i = 0; i < 5000; ++i) {
    if (what()) return true;
    sleep_until(monotonic_now() + kMillisecond);
  }
  return false;
}

// Plugged in: it moves the hand, and its dead-man is felt. Unplugged: nothing is valid.
bool pad_round(GamepadDevice& device) {
  const auto pad = plug_pad();
  const auto read = [&] { return device.read(monotonic_now()); };
  if (!pad->there() || !becomes([&] { return read().valid; })) return false;
  const double before = read().X_MH.p.x();
  pad->send(EV_ABS, ABS_X, 1);
  pad->send(EV_ABS, ABS_X, 30000);
  pad->send(EV_KEY, BTN_TR, 1);
  return becomes([&] {
    const HapticSample s = read();
    return s.X_MH.p.x() > before && s.buttons == 4;
  });
}

bool try_pad(int times) {
  auto first = plug_pad();
  GamepadOptions options;
  options.path = kPadLink;
  options.motion.reach = 10.0;  // room for a hundred rounds
  GamepadDevice device(options);
  const Status opened = device.open();
  if (!said(first->there() && opened.is_ok(), "a gamepad of uinput " + opened.message())) {
    return false;
  }
  int failed = 0;
  first.reset();
  for (int i = 0; i < times; ++i) {
    if (!becomes([&] { return !device.read(monotonic_now()).valid; })) ++failed;
    if (!pad_round(device)) ++failed;
  }
  return said(failed == 0, "plugged in and unplugged " + std::to_string(times) + " times, " +
                               std::to_string(failed) + " of them otherwise than it should");
}

bool switch_round(StopSwitch& stop) {
  const auto device = plug_switch();
  if (!device->there() || !becomes([&] { return !stop.is_open(); })) return false;
  device->send(EV_KEY, KEY_B, 1);
  if (!becomes([&] { return stop.is_open(); })) return false;
  device->send(EV_KEY, KEY_B, 0);
  return becomes([&] { return !stop.is_open(); });
}

// Unplugged is pressed, for as long as it is.
bool stays_open(StopSwitch& stop) {
  for (int i = 0; i < 20; ++i) {
    if (!stop.is_open()) return false;
    sleep_until(monotonic_now() + kMillisecond);
  }
  return true;
}

bool try_switch(int times) {
  auto first = plug_switch();
  StopSwitch stop({kSwitchLink, KEY_B});
  const Status started = stop.start();
  if (!said(first->there() && started.is_ok(), "a foot switch of uinput " + started.message())) {
    return false;
  }
  int failed = 0;
  first.reset();
  for (int i = 0; i < times; ++i) {
    if (!becomes([&] { return stop.is_open(); }) || !stays_open(stop)) ++failed;
    if (!switch_round(stop)) ++failed;
  }
  return said(failed == 0, "plugged in, pressed and unplugged " + std::to_string(times) +
                               " times, " + std::to_string(failed) +
                               " of them otherwise than it should");
}

}  // namespace

bool try_input(int times) {
  const bool pad = try_pad(times);
  return try_switch(times) && pad;
}

}  // namespace handrail::kernel
