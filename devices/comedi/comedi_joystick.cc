#include "devices/comedi/comedi_joystick.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/realtime.h"
#include "server/base/signals.h"

namespace handrail {
namespace {

// Above 1 kHz in the dissertation, as the loop that renders is here.
constexpr Nanos kStickPeriod = kMillisecond;
constexpr Nanos kStickPatience = 20 * kMillisecond;  // a thread that is so late stands still
constexpr Nanos kFirstTick = kSecond;
constexpr int kStickPriority = 80;  // as who renders; it does less

}  // namespace

ComediJoystick::ComediJoystick(const ComediJoystickOptions& options)
    : options_(options),
      capabilities_(joystick_capabilities()),
      homing_(options.homing, options.travel),
      force_(options.most_force) {
  capabilities_.simulated = false;
  capabilities_.max_force = std::min(options.most_force, kJoystickPeakForce);
  capabilities_.continuous_force = std::min(options.most_force, kJoystickRatedForce);
  capabilities_.dynamics.resolution =
      kJoystickResolution * 10000.0 /
      std::min(std::abs(options.counts_per_turn[0]), std::abs(options.counts_per_turn[1]));
  capabilities_.dynamics.delay = to_seconds(kAnswerPatience);
  capabilities_.buttons =
      static_cast<int>(std::min<std::size_t>(3, options.button_channels.size()));
}

Status ComediJoystick::open() {
  close();
  if (!api_) {
    const auto api = load_comedi(options_.place.library);
    if (!api) return Status::error("joystick: " + api.message());
    api_ = *api;
  }
  auto card = JoystickCard::open(*api_, options_);
  if (!card) return Status::error("joystick: " + card.message());
  card_ = std::move(*card);
  card_text_ = card_->board() + ", driven by " + card_->driver();
  begin_card();
  now_ = JoystickTick();
  now_.there = true;
  force_ = JoystickForce(options_.most_force);
  gate_.reset();
  tick_ = JoystickTick();
  stopping_.store(false, std::memory_order_relaxed);
  {
    const SignalsBlocked blocked;
    thread_ = std::thread([this] { run(); });
  }
  for (const Nanos until = monotonic_now() + kFirstTick; monotonic_now() < until;) {
    if (gate_.take(tick_)) return Status::ok();
    sleep_until(monotonic_now() + kMillisecond);
  }
  close();
  return Status::error("joystick: its thread does not run; handrail doctor");
}

void ComediJoystick::begin_card() noexcept {
  homing_ = JoystickHoming(options_.homing, options_.travel);
}

void ComediJoystick::run() {
  (void)enter_realtime(kStickPriority);
  Pacer pacer(kStickPeriod, monotonic_now());
  Nanos last = monotonic_now() - kStickPeriod;
  while (!stopping_.load(std::memory_order_relaxed)) {
    now_.at = monotonic_now();
    ++now_.ticks;
    if (card_ && !turn(now_.at - last)) lose();
    if (!card_) {
      try_again(now_.at);
      gate_.give(now_, now_.at);
    }
    last = now_.at;
    sleep_until(pacer.due());
    (void)pacer.woke(monotonic_now());
  }
  if (card_) (void)card_->push(Vec2::Zero());
  card_.reset();
}

// False: the card does not answer, or not as a stick can move; `lost_for` says why.
bool ComediJoystick::turn(Nanos dt) noexcept {
  StickReading reading;
  if (const int error = card_->read(reading); error != 0) {
    return refused("its encoders cannot be read", error);
  }
  if (!text_of(reading.leap).empty()) {
    now_.lost_for = reading.leap;
    return false;
  }
  look(reading, to_seconds(std::max<Nanos>(dt, kStickPeriod / 10)));
  if (homing_.too_far()) return went_too_far();
  gate_.give(now_, monotonic_now());
  Nanos written = -kForever;
  const Vec2 asked = gate_.answer(written).head<2>();
  const Nanos now = monotonic_now();  // the program may have stood still in the turn
  now_.force = force_.step(asked, written, now_.homed, now, dt);
  now_.hot = force_.hot();
  const int error = card_->push(now_.force);
  return error == 0 || refused("it takes no torque", error);
}

bool ComediJoystick::refused(const char* what, int error) noexcept {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), "%s: %s; sudo dmesg | grep comedi", what,
                ::strerrordesc_np(error));
  now_.lost_for = fixed_text<DeviceTrouble>(text.data());
  return false;
}

bool ComediJoystick::went_too_far() noexcept {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(),
                "it went %.0f by %.0f mm, and from stop to stop are %.0f; counts_per_turn, "
                "travel_mm, or cables of its encoders",
                1e3 * now_.seen[0], 1e3 * now_.seen[1], 1e3 * options_.travel);
  now_.lost_for = fixed_text<DeviceTrouble>(text.data());
  return false;
}

void ComediJoystick::look(const StickReading& reading, double dt) noexcept {
  const bool was_homed = homing_.homed();
  now_.homed = homing_.step(reading.way);
  now_.seen = homing_.seen();
  now_.reached = {homing_.reached(0), homing_.reached(1)};
  HapticSample& sample = now_.sample;
  sample.valid = now_.homed;
  sample.buttons = reading.buttons;
  if (!sample.valid) {
    sample.X_MH = Pose();
    sample.v_MH.setZero();
    return;
  }
  now_.lost_for = DeviceTrouble();
  const StickWays& middle = homing_.middle();
  const Vec3 p(reading.way[0] - middle[0], reading.way[1] - middle[1], 0.0);
  sample.v_MH = was_homed ? joystick_velocity(sample.v_MH, sample.X_MH.p, p, dt) : Vec3::Zero();
  sample.X_MH.p = p;
}

void ComediJoystick::lose() noexcept {
  (void)card_->push(Vec2::Zero());  // one of the two may work
  card_.reset();
  ++now_.losses;
  now_.there = now_.homed = false;
  now_.sample = HapticSample();
  now_.force.setZero();
  retry_at_ = monotonic_now() + options_.reopen_pause;
}

// Its counters may have been without power: it is homed anew.
void ComediJoystick::try_again(Nanos now) {
  (void)force_.step(Vec2::Zero(), -kForever, false, now, kStickPeriod);
  if (now < retry_at_) return;
  retry_at_ = now + options_.reopen_pause;
  auto card = JoystickCard::open(*api_, options_);
  if (!card) return;
  card_ = std::move(*card);
  begin_card();
  now_.there = true;
}

HapticSample ComediJoystick::read(Nanos) noexcept {
  if (!thread_.joinable()) return {};
  (void)gate_.take(tick_);
  HapticSample sample = tick_.sample;
  sample.force_missed = gate_.missed();
  sample.valid = sample.valid && monotonic_now() - tick_.at <= kStickPatience;
  return sample;
}

DeviceTrouble ComediJoystick::trouble() const noexcept {
  if (!thread_.joinable()) return fixed_text<DeviceTrouble>("it is not open");
  if (monotonic_now() - tick_.at > kStickPatience) {
    return fixed_text<DeviceTrouble>(
        "its thread has not come back from the card; sudo dmesg | grep comedi");
  }
  if (text_of(tick_.lost_for).empty()) {
    return fixed_text<DeviceTrouble>("it is not homed: move it to its four stops");
  }
  return and_then(tick_.lost_for, tick_.there ? "then move it to its four stops" : "");
}

void ComediJoystick::write(const Wrench& f_H_M) noexcept {
  gate_.write(is_finite(f_H_M.force) ? f_H_M.force : Vec3::Zero().eval());
}

Nanos ComediJoystick::wait(Nanos due) noexcept {
  return thread_.joinable() ? gate_.wait(due) : HapticDevice::wait(due);
}

void ComediJoystick::close() noexcept {
  if (!thread_.joinable()) return;
  stopping_.store(true, std::memory_order_relaxed);
  thread_.join();
}

}  // namespace handrail
