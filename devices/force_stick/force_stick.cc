#include "devices/force_stick/force_stick.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "devices/joystick/joystick_data.h"
#include "server/base/clock.h"

namespace handrail {
namespace {

constexpr std::array<int, 2> kStickCodes = {ABS_X, ABS_Y};
// A plane, or a line, has no room across it, and half extents are > 0; our choice [m].
constexpr double kAcrossStick = 1e-3;

bool has_grip(const EvdevOpened& device) {
  return device.has_axis[ABS_X] && device.has_effect[FF_CONSTANT];
}
bool fits_stick(const EvdevOpened& device) { return has_grip(device) && device.has_axis[ABS_Y]; }

std::string kind_of_stick(const EvdevOpened& device) {
  const std::string counts = std::to_string(static_cast<int>(2.0 * device.ranges[ABS_X].half()));
  return "takes constant forces; " + counts + " counts from end to end";
}

StickForceOptions force_options(const ForceStickOptions& o) {
  return {o.axes == ForceStickAxes::kWheel ? 1 : 2, o.full, from_seconds(o.upload_period),
          from_seconds(o.most_upload)};
}

// The least of what its axes make, so that it can in every direction.
double most_stick_force(const ForceStickOptions& o) {
  const double x = std::abs(o.full[0]), y = std::abs(o.full[1]);
  if (o.axes == ForceStickAxes::kWheel) return x;
  return std::min(x, y);
}

LeapGuard stick_guard(const ForceStickOptions& o) {
  const double count = 2.0 * o.reach / o.axis_counts;
  return LeapGuard(Vec3(count, count, 0.0), from_seconds(o.delay));
}

HapticCapabilities stick_capabilities(const ForceStickOptions& o) {
  HapticCapabilities c;
  const bool wheel = o.axes == ForceStickAxes::kWheel;
  c.name = wheel ? "force-feedback wheel" : "force-feedback joystick";
  c.max_force = c.continuous_force = most_stick_force(o);
  c.workspace_half = Vec3(o.reach, wheel ? kAcrossStick : o.reach, kAcrossStick);
  c.buttons = 3;
  c.velocity_lag = 1.0 / (2.0 * std::numbers::pi * kJoystickVelocityCutoff);
  c.dynamics.source = "none: it makes no force";
  if (c.max_force <= 0.0) return c;
  c.dynamics.mass = o.mass;
  c.dynamics.damping = o.damping;
  c.dynamics.friction = o.friction;
  c.dynamics.resolution = 2.0 * o.reach / o.axis_counts;
  c.dynamics.delay = o.upload_period + o.most_upload + o.delay;
  c.dynamics.source = "as configured";
  if (o.mass > 0.0) c.least_mass += o.mass;
  return c;
}

}  // namespace

const PadWish& force_stick_wish(ForceStickAxes axes) noexcept {
  static constexpr PadWish kStickWish = {"force stick",
                                         "no force-feedback joystick",
                                         "has no two axes with a constant force",
                                         "a force-feedback joystick",
                                         "device.force_stick.device",
                                         fits_stick,
                                         kind_of_stick};
  static constexpr PadWish kWheelWish = {"force stick",
                                         "no force-feedback wheel",
                                         "has no axis X with a constant force",
                                         "a force-feedback wheel",
                                         "device.force_stick.device",
                                         has_grip,
                                         kind_of_stick};
  return axes == ForceStickAxes::kWheel ? kWheelWish : kStickWish;
}

ForceStick::ForceStick(const ForceStickOptions& options, EvdevKernel& kernel)
    : options_(options),
      kernel_(kernel),
      capabilities_(stick_capabilities(options)),
      reader_([this] { return open_device(); }, options.reopen_pause),
      pusher_(kernel, force_options(options)),
      guard_(stick_guard(options)) {}

Result<EvdevOpened> ForceStick::open_device() const {
  Result<EvdevOpened> out =
      open_pad(kernel_, options_.path, options_.input_folder, force_stick_wish(options_.axes));
  if (!out) return out;
  const int axes = options_.axes == ForceStickAxes::kWheel ? 1 : 2;
  for (int i = 0; i < axes; ++i) {
    const int code = kStickCodes[static_cast<std::size_t>(i)];
    const int counts = static_cast<int>(2.0 * out->ranges[static_cast<std::size_t>(code)].half());
    if (counts >= options_.axis_counts) continue;
    ::close(out->fd);
    return Status::error("input device " + std::string(text_of(out->path)) + ": its axis " +
                         (i == 0 ? "X" : "Y") + " has " + std::to_string(counts) + " counts, and " +
                         std::to_string(options_.axis_counts) +
                         " are reckoned with; device.force_stick.axis_counts");
  }
  return out;
}

Status ForceStick::open() {
  close();
  const Result<EvdevOpened> first = open_device();
  if (!first) return first.status();
  reader_.start(*first);
  pusher_.start();
  sample_ = HapticSample();
  guard_.reset();
  away_until_ = -kForever;
  lost_for_ = DeviceTrouble();
  started_ = false;
  open_ = true;
  return Status::ok();
}

HapticSample ForceStick::read(Nanos now) noexcept {
  if (!open_) return {};
  if (started_ && now <= last_) return sample_;
  const bool was_valid = sample_.valid;
  sample_.valid = is_somewhere();
  if (sample_.valid) {
    const Vec3 p = place();
    const double dt = to_seconds(std::max<Nanos>(now - last_, 1));
    sample_.v_MH =
        was_valid ? joystick_velocity(sample_.v_MH, sample_.X_MH.p, p, dt) : Vec3::Zero().eval();
    sample_.X_MH.p = p;
    sample_.buttons = pad_buttons(reader_.device(), reader_.state());
    lost_for_ = DeviceTrouble();
  } else {
    sample_ = HapticSample();
  }
  started_ = true;
  last_ = now;
  return sample_;
}

bool ForceStick::is_somewhere() noexcept {
  const Nanos from = monotonic_now();
  if (from < away_until_) return false;
  const EvdevTurn turn = reader_.listen();
  if (turn == EvdevTurn::kCame || turn == EvdevTurn::kLeft) {
    pusher_.use(reader_.device());
    known_ = {};
  }
  if (!reader_.there() || !moved_off(0) || !moved_off(1)) return false;
  const Nanos to = monotonic_now();
  const auto leap = guard_.next(place(), from, to);
  if (leap) lose(*leap, to);
  return !leap;
}

// It may be open again at once, and who reads would then go on as if one reading had been missed.
void ForceStick::lose(const Leap& leap, Nanos now) noexcept {
  lost_for_ = leap_text(leap.axis == 0 ? "its axis X leapt by" : "its axis Y leapt by", leap);
  away_until_ = now + options_.reopen_pause;
  guard_.reset();
  reader_.lose();
  pusher_.use(reader_.device());
}

DeviceTrouble ForceStick::trouble() const noexcept {
  const auto said = [](const char* text) { return fixed_text<DeviceTrouble>(text); };
  if (!open_) return said("it is not open");
  if (text_of(lost_for_).empty()) {
    return said(!reader_.there() ? kUnpluggedInput
                                 : "it reads as at its end, as some do until they are first moved: "
                                   "move it once");
  }
  return and_then(lost_for_, reader_.there() ? "then move it once" : "");
}

bool ForceStick::moved_off(int axis) noexcept {
  if (axis > 0 && options_.axes == ForceStickAxes::kWheel) return true;
  const auto i = static_cast<std::size_t>(axis);
  const auto code = static_cast<std::size_t>(kStickCodes[i]);
  const EvdevRange& range = reader_.device().ranges[code];
  const std::int32_t value = reader_.state().axes[code];
  known_[i] = known_[i] || (value != range.least && value != range.most);
  return known_[i];
}

// The kernel's Y is toward the user.
Vec3 ForceStick::place() const noexcept {
  const auto at = [this](std::size_t code) {
    const double share = reader_.device().ranges[code].share(reader_.state().axes[code]);
    return options_.reach * std::clamp(share, -1.0, 1.0);
  };
  return {at(ABS_X), options_.axes == ForceStickAxes::kWheel ? 0.0 : -at(ABS_Y), 0.0};
}

void ForceStick::write(const Wrench& f_H_M) noexcept {
  if (!open_) return;
  // Where nobody knows where the hand is there is no force, and it begins anew.
  const Nanos at = sample_.valid ? monotonic_now() : -kForever;
  const bool good = sample_.valid && is_finite(f_H_M.force);
  pusher_.push(at, good ? f_H_M.force.head<2>().eval() : Vec2::Zero().eval());
}

void ForceStick::close() noexcept {
  pusher_.stop();
  reader_.stop();
  open_ = false;
}

}  // namespace handrail
