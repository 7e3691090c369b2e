#include "devices/evdev/gamepad_device.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <utility>

namespace handrail {
namespace {

// A gamepad sends some hundred events a second; a loop that stood still for a
// second has caught up in one reading.
constexpr std::size_t kMostPadEvents = 128;
// How udev ends the names of gamepads and joysticks (systemd,
// 60-persistent-input.rules).
constexpr char kJoystickEnding[] = "-event-joystick";

constexpr GamepadLayout kPad = {ABS_X, ABS_Y, ABS_RY, ABS_RX, BTN_TL, BTN_SOUTH, BTN_TR};
constexpr GamepadLayout kStick = {ABS_X,     ABS_Y,      ABS_HAT0Y,  ABS_RZ,
                                  BTN_THUMB, BTN_THUMB2, BTN_TRIGGER};

Result<EvdevOpened> first_gamepad(EvdevKernel& kernel, const std::string& folder) {
  int seen = 0;
  std::string closed_to_us;
  for (const std::string& path : gamepad_paths(folder)) {
    Result<EvdevOpened> device = open_evdev(kernel, path, EvdevUse::kShare);
    if (!device) {
      // The first one says why, and what to do.
      if (closed_to_us.empty()) closed_to_us = device.message();
      continue;
    }
    if (drives(*device)) return device;
    ++seen;
    ::close(device->fd);
  }
  return Status::error("gamepad: none among " + std::to_string(seen) + " input devices of " +
                       folder + "; " +
                       (closed_to_us.empty() ? "plug one in, or name it in device.gamepad.device"
                                             : "there is another: " + closed_to_us));
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

bool drives(const EvdevOpened& device) noexcept {
  return device.has_axis[ABS_X] && device.has_axis[ABS_Y] &&
         (device.has_key[BTN_GAMEPAD] || device.has_key[BTN_JOYSTICK]);
}

GamepadDevice::GamepadDevice(const GamepadOptions& options, EvdevKernel& kernel)
    : options_(options),
      kernel_(kernel),
      capabilities_(deflection_capabilities(options.motion)),
      reopener_([this] { return open_device(); }),
      rumble_(kernel, options.rumble_share),
      hand_(options.motion) {
  capabilities_.name = "gamepad";
  capabilities_.buttons = 3;
}

Result<EvdevOpened> GamepadDevice::open_device() const {
  if (options_.path.empty()) return first_gamepad(kernel_, options_.input_folder);
  Result<EvdevOpened> device = open_evdev(kernel_, options_.path, EvdevUse::kShare);
  if (!device || drives(*device)) return device;
  ::close(device->fd);
  return Status::error("input device " + options_.path + ": " + std::string(text_of(device->name)) +
                       " has no stick with two axes and buttons; expected a "
                       "gamepad or joystick");
}

Status GamepadDevice::open() {
  close();
  const Result<EvdevOpened> first = open_device();
  if (!first) return first.status();
  reopener_.start(&*first);
  rumble_.start();
  hand_.reset();
  sample_ = HapticSample();
  started_ = false;
  open_ = true;
  return Status::ok();
}

HapticSample GamepadDevice::read(Nanos now) noexcept {
  if (!open_) return {};
  if (started_ && now <= last_) return sample_;
  receive();
  const bool there = opened_.fd >= 0;
  if (!there) {
    hand_.halt();
  } else {
    // Looked at before the first step as well: it says which axes are in their
    // middle.
    const Deflection pushed = deflection();
    const bool clutched = (buttons() & 1u) != 0;
    if (started_) hand_.step(pushed, clutched, to_seconds(now - last_));
  }
  started_ = true;
  last_ = now;
  sample_.X_MH = hand_.pose();
  sample_.v_MH = hand_.velocity();
  sample_.buttons = there ? buttons() : 0;
  sample_.valid = there;
  return sample_;
}

void GamepadDevice::receive() noexcept {
  if (opened_.fd < 0) {
    if (!reopener_.take(opened_)) return;
    stream_.begin(opened_.state);
    centred_ = {};
    rumble_.use(opened_.path);
  }
  std::array<std::uint8_t, kMostPadEvents * sizeof(input_event)> bytes;
  const ssize_t n = ::read(opened_.fd, bytes.data(), bytes.size());
  if (n < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (n > 0 && stream_.take({bytes.data(), static_cast<std::size_t>(n)})) return;
  reopener_.lost(std::exchange(opened_.fd, -1));
  rumble_.use({});
}

// How far an axis is pushed, -1 to 1.
double GamepadDevice::share(int which, int axis) noexcept {
  const auto i = static_cast<std::size_t>(axis);
  if (!opened_.has_axis[i]) return 0.0;
  const EvdevRange& range = opened_.ranges[i];
  const double half = 0.5 * (static_cast<double>(range.most) - range.least);
  const double off = (static_cast<double>(stream_.state().axes[i]) - range.least) / half - 1.0;
  // A range of an even number of counts, such as 0 to 255, has its middle between two.
  const double middle =
      std::clamp(std::max({options_.dead_share, range.flat / half, 0.5 / half}), 0.0, 0.5);
  const double size = std::abs(off) - middle;
  bool& centred = centred_[static_cast<std::size_t>(which)];
  centred = centred || size <= 0.0;
  if (!centred || size <= 0.0) return 0.0;
  return std::copysign(std::min(size / (1.0 - middle), 1.0), off);
}

Deflection GamepadDevice::deflection() noexcept {
  const GamepadLayout& layout = gamepad_layout(is_gamepad(opened_));
  Deflection out;
  out.move = Vec3(share(0, layout.right), -share(2, layout.up), share(1, layout.toward));
  // To the right is clockwise from above, about the downward axis.
  out.turn.y() = -share(3, layout.turn_right);
  return out;
}

std::uint32_t GamepadDevice::buttons() const noexcept {
  const GamepadLayout& layout = gamepad_layout(is_gamepad(opened_));
  const auto down = [this](int key) {
    return stream_.state().keys[static_cast<std::size_t>(key)] ? 1u : 0u;
  };
  return down(layout.clutch) | down(layout.drop) << 1 | down(layout.enable) << 2;
}

void GamepadDevice::close() noexcept {
  rumble_.stop();
  reopener_.stop();
  if (opened_.fd >= 0) ::close(opened_.fd);
  opened_.fd = -1;
  open_ = false;
}

}  // namespace handrail
