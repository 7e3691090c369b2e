#include "devices/touch/touch_device.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "devices/omni/omni_data.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/plain_text.h"
#include "server/base/signals.h"
#include "server/base/units.h"

namespace handrail {
namespace {

constexpr unsigned long kServoRate = 1000;          // as the vendor's own examples ask for [Hz]
constexpr Nanos kFirstTick = kSecond;               // the scheduler's thread has begun long before
constexpr Nanos kTickPatience = 20 * kMillisecond;  // at 414 Hz, the slowest measured, 8 ticks
constexpr Nanos kLetGo =
    500 * kMillisecond;                     // after an error, and as long to come back; our choice
constexpr Nanos kLook = 20 * kMillisecond;  // whether it still turns
// It is asked for calibration and temperature so often; both change over seconds.
constexpr std::uint64_t kHomingTicks = 50, kHeatTicks = 100;
// The library's own estimate; at 1 the motor has to rest.
constexpr double kHot = 1.0, kCooled = 0.9;
constexpr int kMostErrors = 16;      // on the stack; a tick raises one or two
constexpr std::size_t kMotors = 16;  // room for more than any model has

bool loses_device(std::uint32_t code) {
  return code == kHdDeviceFault || code == kHdCommError || code == kHdCommConfigError ||
         code == kHdTimerError || code == kHdInvalidLicense;
}

bool takes_force(std::uint32_t code) {
  return loses_device(code) || (code >= kHdWarmMotors && code <= kHdForceError);
}

// One style of those the device knows, the least work for a person first.
HdEnum best_style(HdEnum known) {
  for (const HdEnum style : {kHdAuto, kHdInkwell, kHdEncoderReset}) {
    if (known & style) return style;
  }
  return kHdAuto;
}

// Reading takes the vendor's thread so long: 0.058 to 0.10 ms in the mean, as measured at a Touch
// on USB (logs of its owners). The place may be as old.
constexpr Nanos kReadingTakes = 100 * kMicrosecond;

// By TouchHoming.
constexpr const char* kToHome[] = {"", "it is not homed yet, and does so by itself",
                                   "it is not homed: put the stylus into the inkwell",
                                   "it is not homed: do as the vendor's manual says"};

std::string text_or_empty(const char* text) { return text == nullptr ? "" : shown(text); }

}  // namespace

TouchDevice::TouchDevice(const TouchOptions& options)
    : options_(options),
      capabilities_(omni_capabilities(false)),
      guard_(Vec3::Constant(kOmniResolution)) {
  capabilities_.name = "Touch";
  capabilities_.simulated = false;
  capabilities_.dynamics.delay = to_seconds(kReadingTakes + kAnswerPatience);
  capabilities_.dynamics.source = "data sheet of the Phantom Omni; viscous damping not published";
}

Status TouchDevice::open() {
  close();
  if (!api_) {
    const auto loaded = load_hd(options_.library);
    if (!loaded) return loaded.status();
    api_ = *loaded;
  }
  gate_.reset();
  tick_ = TouchTick();
  servo_.losses = 0;
  servo_.lost_for = DeviceTrouble();
  if (Status s = begin(false); !s) return s;
  ask_identity();
  (void)gate_.take(tick_);
  open_ = true;
  stopping_.store(false, std::memory_order_relaxed);
  const SignalsBlocked blocked;
  watcher_ = std::thread([this] { watch(); });
  return Status::ok();
}

Status TouchDevice::begin(bool again) {
  if (Status s = init(); !s) return s;
  ask_abilities();
  Status started = start(again);
  if (!started) end();
  return started;
}

// Looks are counted, not time: a program that stood still has missed none.
void TouchDevice::watch() noexcept {
  std::uint64_t seen = 0;
  Nanos bad = 0, next = -kForever;
  const Nanos look = std::min(kLook, options_.reopen_pause);
  while (!stopping_.load(std::memory_order_relaxed)) {
    sleep_until(monotonic_now() + look);
    const bool turned = std::exchange(seen, turns_.load(std::memory_order_acquire)) != seen;
    bad = turned && !failing_.load(std::memory_order_relaxed) ? 0 : bad + look;
    if (running_ && bad < options_.lost_after) continue;
    end();
    if (monotonic_now() < next) continue;
    if (begin(true)) bad = 0;
    next = monotonic_now() + options_.reopen_pause;
  }
}

Status TouchDevice::init() {
  std::vector<const char*> names = {"Default Device", "Default PHANToM", nullptr};
  if (!options_.name.empty()) names = {options_.name.c_str()};
  HdError error;
  for (const char* name : names) {
    device_ = api_->init_device(name);
    error = api_->get_error();
    for (int i = 0; i < kMostErrors && api_->get_error().code != kHdSuccess; ++i) {
    }
    if (device_ != kHdNoDevice && error.code == kHdSuccess) return Status::ok();
    if (device_ != kHdNoDevice) api_->disable_device(device_);
    device_ = kHdNoDevice;
  }
  const std::string hint = hd_hint(error.code);
  const std::string which =
      options_.name.empty() ? "the default device" : "'" + shown(options_.name) + "'";
  return Status::error("Touch: cannot open " + which + ": " + hd_error_text(*api_, error) +
                       (hint.empty() ? "" : "; " + hint));
}

void TouchDevice::ask_identity() {
  api_->make_current(device_);
  model_ = text_or_empty(api_->get_string(kHdModel));
  serial_ = text_or_empty(api_->get_string(kHdSerial));
  driver_version_ = text_or_empty(api_->get_string(kHdDriverVersion));
}

void TouchDevice::ask_abilities() {
  api_->make_current(device_);
  std::int32_t styles = 0;
  api_->get_integer(kHdCalibrationStyle, &styles);
  style_ = best_style(static_cast<HdEnum>(styles));
  double nominal = 0.0;
  api_->get_double(kHdNominalMaxForce, &nominal);
  most_force_ = nominal > 0.0 ? std::min(nominal, kOmniPeakForce) : kOmniPeakForce;
}

Status TouchDevice::start(bool again) {
  const TouchTick last = servo_;
  servo_ = TouchTick();
  servo_.losses = last.losses + (again ? 1 : 0);
  servo_.lost_for = last.lost_for;
  output_ = hot_ = leapt_ = false;
  guard_.reset();
  failed_at_ = again ? monotonic_now() : -kForever;
  const std::uint64_t turns = turns_.load(std::memory_order_acquire);
  scheduled_ = api_->schedule(
      [](void* self) {
        static_cast<TouchDevice*>(self)->servo();
        return kHdContinue;
      },
      this, kHdHighestPriority);
  api_->set_rate(kServoRate);
  api_->start_scheduler();
  running_ = true;
  const HdError error = api_->get_error();
  if (error.code != kHdSuccess) {
    const std::string hint = hd_hint(error.code);
    return Status::error("Touch: its scheduler does not start: " + hd_error_text(*api_, error) +
                         (hint.empty() ? "" : "; " + hint));
  }
  for (const Nanos until = monotonic_now() + kFirstTick; monotonic_now() < until;) {
    if (turns_.load(std::memory_order_acquire) != turns) return Status::ok();
    sleep_until(monotonic_now() + kMillisecond);
  }
  return Status::error("Touch: its scheduler does not run: no tick in a second; " +
                       std::string(hd_hint(kHdTimerError)));
}

void TouchDevice::servo() noexcept {
  servo_.at = monotonic_now();
  ++servo_.ticks;
  api_->make_current(device_);
  api_->begin_frame(device_);
  read_state(servo_);
  if (servo_.ticks % kHomingTicks == 1) home(servo_);
  note_errors(servo_);
  servo_.sample.valid = servo_.sample.valid && servo_.homing == TouchHoming::kDone &&
                        !loses_device(servo_.error.code);
  look_for_leap(servo_);
  failing_.store(leapt_ || loses_device(servo_.error.code), std::memory_order_relaxed);
  const bool pushes = may_push(servo_);
  gate_.give(servo_, monotonic_now());
  turns_.fetch_add(1, std::memory_order_release);
  Nanos written = -kForever;
  const Vec3& asked = gate_.answer(written);
  const Vec3 force = pushes ? share_of(asked, written) : Vec3::Zero().eval();
  api_->set_double(kHdCurrentForce, force.data());
  api_->end_frame(device_);
  servo_.error = HdError();
  note_errors(servo_);
}

void TouchDevice::read_state(TouchTick& out) noexcept {
  std::array<double, 16> m{};  // column by column, mm
  api_->get_double(kHdTransform, m.data());
  Vec3 velocity = Vec3::Zero();
  api_->get_double(kHdVelocity, velocity.data());
  std::int32_t buttons = 0;
  api_->get_integer(kHdButtons, &buttons);
  const Pose before = out.sample.X_MH;
  out.sample.X_MH.p = kMm * Vec3(m[12], m[13], m[14]);
  Eigen::Matrix3d turn;
  turn << m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10];
  out.sample.X_MH.q = Quat(turn).normalized();
  out.sample.v_MH = kMm * velocity;
  out.sample.buttons = static_cast<std::uint32_t>(buttons) & 3u;
  const bool same =
      before.p == out.sample.X_MH.p && before.q.coeffs() == out.sample.X_MH.q.coeffs();
  out.frozen = same ? out.frozen + 1 : 0;
  // What a device without calibration or cable gives is not always a pose.
  out.sample.valid = is_finite(out.sample.X_MH) && is_finite(out.sample.v_MH);
  if (!out.sample.valid) {
    out.sample.X_MH = Pose();
    out.sample.v_MH.setZero();
  }
  if (out.ticks % kHeatTicks != 1) return;
  std::array<double, kMotors> heat{};
  api_->get_double(kHdMotorTemperature, heat.data());
  out.temperature = *std::max_element(heat.begin(), heat.end());
}

void TouchDevice::home(TouchTick& out) noexcept {
  const HdEnum state = api_->check_calibration();
  if (state == kHdCalibrated) {
    out.homing = TouchHoming::kDone;
  } else if (state == kHdNeedsUpdate) {
    api_->update_calibration(style_);
    out.homing = TouchHoming::kByItself;
  } else {
    out.homing = style_ == kHdInkwell ? TouchHoming::kInkwell
                 : style_ == kHdAuto  ? TouchHoming::kByItself
                                      : TouchHoming::kByHand;
  }
}

// Switches the force on where it may act.
bool TouchDevice::may_push(const TouchTick& out) noexcept {
  const bool was_hot = hot_;
  hot_ = out.temperature >= kHot || (hot_ && out.temperature >= kCooled);
  if (hot_ && !was_hot) ++servo_.force_offs;
  if (out.homing != TouchHoming::kDone || hot_ || out.at - failed_at_ < kLetGo) return false;
  if (!output_) {
    api_->enable(kHdForceOutput);
    output_ = true;
  }
  return true;
}

Vec3 TouchDevice::share_of(const Vec3& asked, Nanos written) const noexcept {
  // By the clock, not by when the turn began: the program may have stood still in between.
  if (monotonic_now() - written > kForceStands) return Vec3::Zero();
  const Nanos back = servo_.at - failed_at_ - kLetGo;
  const double share = std::clamp(to_seconds(back) / to_seconds(kLetGo), 0.0, 1.0);
  const double size = asked.norm();
  const double most = size > most_force_ ? most_force_ / size : 1.0;
  return share * most * asked;
}

void TouchDevice::note_errors(TouchTick& out) noexcept {
  for (int i = 0; i < kMostErrors; ++i) {
    const HdError error = api_->get_error();
    if (error.code == kHdSuccess) return;
    if (out.error.code == kHdSuccess || loses_device(error.code)) out.error = error;
    if (!takes_force(error.code)) continue;
    // The library has switched the force off, or is about to.
    if (output_) ++out.force_offs;
    output_ = false;
    failed_at_ = out.at;
  }
}

// Until it is opened anew: what it is homed to may have leapt as well.
void TouchDevice::look_for_leap(TouchTick& out) noexcept {
  if (out.sample.valid && !leapt_) {
    const auto leap = guard_.next(out.sample.X_MH.p, out.at, monotonic_now());
    if (leap) {
      static constexpr const char* kWhat[] = {"its X leapt by", "its Y leapt by", "its Z leapt by"};
      out.lost_for = leap_text(kWhat[leap->axis], *leap);
      leapt_ = true;
      ++out.force_offs;
    } else {
      out.lost_for = DeviceTrouble();
    }
  }
  if (!leapt_) return;
  out.sample.valid = false;
  failed_at_ = out.at;
}

HapticSample TouchDevice::read(Nanos) noexcept {
  if (!open_) return {};
  (void)gate_.take(tick_);
  HapticSample sample = tick_.sample;
  sample.force_missed = gate_.missed();
  sample.valid = sample.valid && monotonic_now() - tick_.at <= kTickPatience;
  return sample;
}

DeviceTrouble TouchDevice::trouble() const noexcept {
  const auto said = [](const char* text) { return fixed_text<DeviceTrouble>(text); };
  if (!open_) return said("it is not open");
  if (loses_device(tick_.error.code)) {
    DeviceTrouble out{};
    std::snprintf(out.data(), out.size(), "error 0x%x of its library; %s", tick_.error.code,
                  hd_hint(tick_.error.code));
    return out;
  }
  const char* const homing = kToHome[static_cast<std::size_t>(tick_.homing)];
  if (!text_of(tick_.lost_for).empty()) return and_then(tick_.lost_for, homing);
  if (monotonic_now() - tick_.at > kTickPatience) {
    return said("its library gives no readings; look at cable and power");
  }
  if (*homing != '\0') return said(homing);
  return said("its library gives no pose; look at its cable, and the vendor's diagnostic");
}

void TouchDevice::write(const Wrench& f_H_M) noexcept {
  gate_.write(is_finite(f_H_M.force) ? f_H_M.force : Vec3::Zero().eval());
}

Nanos TouchDevice::wait(Nanos due) noexcept {
  return open_ ? gate_.wait(due) : HapticDevice::wait(due);
}

void TouchDevice::close() noexcept {
  stopping_.store(true, std::memory_order_relaxed);
  if (watcher_.joinable()) watcher_.join();
  open_ = false;
  end();
}

void TouchDevice::end() noexcept {
  if (running_) {
    // After this no callback runs.
    api_->stop_scheduler();
    api_->unschedule(scheduled_);
  }
  running_ = false;
  if (device_ == kHdNoDevice) return;
  api_->make_current(device_);
  api_->disable(kHdForceOutput);
  api_->disable_device(device_);
  device_ = kHdNoDevice;
}

}  // namespace handrail
