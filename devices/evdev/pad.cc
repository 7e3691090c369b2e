#include "devices/evdev/pad.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>

namespace handrail {
namespace {

constexpr GamepadLayout kPad = {ABS_X, ABS_Y, ABS_RY, ABS_RX, BTN_TL, BTN_SOUTH, BTN_TR};
constexpr GamepadLayout kStick = {ABS_X,     ABS_Y,      ABS_HAT0Y,  ABS_RZ,
                                  BTN_THUMB, BTN_THUMB2, BTN_TRIGGER};

Result<EvdevOpened> first_pad(EvdevKernel& kernel, const std::string& folder, const PadWish& wish) {
  int seen = 0;
  std::string closed_to_us;
  for (const std::string& path : gamepad_paths(folder)) {
    Result<EvdevOpened> device = open_evdev(kernel, path, EvdevUse::kShare);
    if (!device) {
      // The first one says why, and what to do.
      if (closed_to_us.empty()) closed_to_us = device.message();
      continue;
    }
    if (wish.fits(*device)) return device;
    ++seen;
    ::close(device->fd);
  }
  const std::string plug = std::string("plug one in, or name it in ") + wish.option;
  return Status::error(std::string(wish.name) + ": none among " + std::to_string(seen) +
                       " input devices of " + folder + "; " +
                       (closed_to_us.empty() ? plug : "there is another: " + closed_to_us));
}

}  // namespace

std::vector<std::string> gamepad_paths(const std::string& input_folder) {
  namespace fs = std::filesystem;
  std::vector<std::string> named, numbered;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(fs::path(input_folder) / "by-id", error)) {
    if (entry.path().string().ends_with(kJoystickEnding)) named.push_back(entry.path().string());
  }
  for (const auto& entry : fs::directory_iterator(input_folder, error)) {
    if (entry.path().filename().string().starts_with("event")) {
      numbered.push_back(entry.path().string());
    }
  }
  std::vector<std::string>& out = named.empty() ? numbered : named;
  std::sort(out.begin(), out.end());
  return out;
}

const GamepadLayout& gamepad_layout(bool gamepad) noexcept { return gamepad ? kPad : kStick; }

bool is_gamepad(const EvdevOpened& device) noexcept { return device.has_key[BTN_GAMEPAD]; }

std::uint32_t pad_buttons(const EvdevOpened& device, const EvdevState& state) noexcept {
  const GamepadLayout& layout = gamepad_layout(is_gamepad(device));
  const auto down = [&state](int key) {
    return state.keys[static_cast<std::size_t>(key)] ? 1u : 0u;
  };
  return down(layout.clutch) | down(layout.drop) << 1 | down(layout.enable) << 2;
}

Result<EvdevOpened> open_pad(EvdevKernel& kernel, const std::string& path,
                             const std::string& input_folder, const PadWish& wish) {
  if (path.empty()) return first_pad(kernel, input_folder, wish);
  Result<EvdevOpened> device = open_evdev(kernel, path, EvdevUse::kShare);
  if (!device || wish.fits(*device)) return device;
  ::close(device->fd);
  return Status::error("input device " + path + ": " + std::string(text_of(device->name)) + " " +
                       wish.lacks + "; expected " + wish.wanted);
}

}  // namespace handrail
