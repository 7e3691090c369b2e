#include "devices/evdev/gamepad_device.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

bool drives(const EvdevOpened& device) {
  return device.has_axis[ABS_X] && device.has_axis[ABS_Y] &&
         (device.has_key[BTN_GAMEPAD] || device.has_key[BTN_JOYSTICK]);
}

std::string kind_of_pad(const EvdevOpened& device) {
  return is_gamepad(device) ? "a gamepad" : "a joystick";
}

}  // namespace

const PadWish& gamepad_wish() noexcept {
  static constexpr PadWish kWish = {"gamepad",
                                    "no gamepad and no joystick",
                                    "has no stick with two axes and buttons",
                                    "a gamepad or joystick",
                                    "device.gamepad.device",
                                    drives,
                                    kind_of_pad};
  return kWish;
}

GamepadDevice::GamepadDevice(const GamepadOptions& options, EvdevKernel& kernel)
    : options_(options),
      kernel_(kernel),
      capabilities_(deflection_capabilities(options.motion)),
      reader_([this] { return open_device(); }, options.reopen_pause),
      rumble_(kernel, options.rumble_share),
      hand_(options.motion) {
  capabilities_.name = "gamepad";
  capabilities_.buttons = 3;
}

Result<EvdevOpened> GamepadDevice::open_device() const {
  return open_pad(kernel_, options_.path, options_.input_folder, gamepad_wish());
}

Status GamepadDevice::open() {
  close();
  const Result<EvdevOpened> first = open_device();
  if (!first) return first.status();
  reader_.start(*first);
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
  const bool there = reader_.there();
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

DeviceTrouble GamepadDevice::trouble() const noexcept {
  return fixed_text<DeviceTrouble>(open_ ? kUnpluggedInput : "it is not open");
}

void GamepadDevice::receive() noexcept {
  const EvdevTurn turn = reader_.listen();
  if (turn != EvdevTurn::kCame && turn != EvdevTurn::kLeft) return;
  centred_ = {};
  rumble_.use(reader_.device());
}

// How far an axis is pushed, -1 to 1.
double GamepadDevice::share(int which, int axis) noexcept {
  const auto i = static_cast<std::size_t>(axis);
  if (!reader_.device().has_axis[i]) return 0.0;
  const EvdevRange& range = reader_.device().ranges[i];
  const double half = range.half();
  const double off = range.share(reader_.state().axes[i]);
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
  const GamepadLayout& layout = gamepad_layout(is_gamepad(reader_.device()));
  Deflection out;
  out.move = Vec3(share(0, layout.right), -share(2, layout.up), share(1, layout.toward));
  // To the right is clockwise from above, about the downward axis.
  out.turn.y() = -share(3, layout.turn_right);
  return out;
}

std::uint32_t GamepadDevice::buttons() const noexcept {
  return pad_buttons(reader_.device(), reader_.state());
}

void GamepadDevice::close() noexcept {
  rumble_.stop();
  reader_.stop();
  open_ = false;
}

}  // namespace handrail
