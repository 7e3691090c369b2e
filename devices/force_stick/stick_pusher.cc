#include "devices/force_stick/stick_pusher.h"

#include <algorithm>
#include <cmath>

#include "server/base/clock.h"

namespace handrail {
namespace {

constexpr double kFullLevel = 32767.0;  // of ff_constant_effect [counts]
// Toward which the force pulls (linux/input.h: 0 down, 0x4000 left, 0x8000 up, 0xC000 right).
constexpr std::array<std::uint16_t, 2> kDirections = {0xC000, 0x8000};
// Drivers differ in whether a change begins an effect's time anew, so it is played anew.
constexpr Nanos kPlayAgain = 40 * kMillisecond;
constexpr Nanos kRefusedPause = 100 * kMillisecond;  // our choice
constexpr int kFullGain = 0xFFFF;                    // all that the device makes (input/ff.rst)
// SCHED_FIFO, below who renders: a driver may take long; our choice.
constexpr int kPusherPriority = 70;

}  // namespace

StickLevel stick_level(int axis, double force, double full) noexcept {
  const double share = full == 0.0 || !std::isfinite(force) ? 0.0 : force / full;
  return {kDirections[static_cast<std::size_t>(axis)],
          static_cast<std::int16_t>(std::lround(kFullLevel * std::clamp(share, -1.0, 1.0)))};
}

StickPusher::StickPusher(EvdevKernel& kernel, const StickForceOptions& options)
    : kernel_(kernel), options_(options), thread_(options.period, kPusherPriority) {}

bool StickPusher::makes_force() const noexcept {
  return options_.full[0] != 0.0 && (options_.axes == 1 || options_.full[1] != 0.0);
}

void StickPusher::start() {
  stop();
  heard_ = StickPushed();
  motors_ = std::make_shared<Motors>(kernel_, options_);
  if (makes_force()) thread_.start(motors_);
}

void StickPusher::Motors::use(const FixedText<256>& path) noexcept {
  end();
  if (text_of(path).empty() || !motors_.open(path.data())) return;
  motors_.set(FF_AUTOCENTER, 0);
  motors_.set(FF_GAIN, kFullGain);
  now_.there = true;
}

void StickPusher::Motors::turn(Nanos now) noexcept {
  (void)commands.take(command_);
  const bool allowed = motors_.is_open() && now >= retry_at_ && command_.force.allFinite();
  // The force comes no faster after a turn that was long in coming.
  const Nanos dt = std::min(now - last_turn_, 2 * options_.period);
  const double share = ramp_.step(allowed, command_.at, now, dt);
  last_turn_ = now;
  const Vec2 force = share > 0.0 ? (share * command_.force).eval() : Vec2::Zero().eval();
  if (motors_.is_open() && now >= retry_at_) tell(force, now);
  said.publish(now_);
}

void StickPusher::Motors::tell(const Vec2& force, Nanos now) noexcept {
  const std::uint64_t before = now_.uploads;
  const bool taken = show(force, now);
  // A turn without an upload leaves what acts as it is, however long it took.
  const Nanos took = now_.uploads == before ? 0 : monotonic_now() - now;
  now_.longest = std::max(now_.longest, took);
  now_.force = force;
  now_.there = taken;
  const bool late = took > options_.most_upload;
  if (!taken) {
    ++now_.refused;
    retry_at_ = now + kRefusedPause;
  } else if (late) {
    ++now_.late;
  }
  // What acts later than is reckoned with begins anew.
  if (!taken || late) (void)ramp_.step(false, now, now, 0);
}

// False: the device did not take it.
bool StickPusher::Motors::show(const Vec2& force, Nanos now) noexcept {
  const bool again = now - played_at_ >= kPlayAgain;
  bool changed = false, good = true;
  for (int i = 0; i < options_.axes; ++i) {
    const auto at = static_cast<std::size_t>(i);
    Axis& axis = axes_[at];
    const StickLevel wanted = stick_level(i, force[i], options_.full[at]);
    const std::int16_t before = axis.effect.id < 0 ? std::int16_t{0} : axis.effect.u.constant.level;
    changed = changed || wanted.level != before;
    good = good && show_axis(axis, wanted, again);
  }
  if (again) played_at_ = now;
  if (changed) ++now_.uploads;
  return good;
}

bool StickPusher::Motors::show_axis(Axis& axis, const StickLevel& wanted, bool goes_on) noexcept {
  // No force is told twice: as an end, which no upload may hold up, and as a level.
  bool good = true;
  if (wanted.level == 0 && axis.on) {
    axis.on = false;
    good = motors_.play(axis.effect, false);
  }
  const bool new_one = axis.effect.id < 0;
  if (new_one ? wanted.level != 0 : axis.effect.u.constant.level != wanted.level) {
    ff_effect effect = axis.effect;
    effect.type = FF_CONSTANT;
    effect.direction = wanted.direction;
    effect.replay.length = kStickForceLasts;
    effect.u.constant.level = wanted.level;
    if (!motors_.upload(effect)) return false;
    axis.effect = effect;
  }
  if (wanted.level == 0) return good;
  // The upload may have taken so long that nobody asks for a force any more.
  (void)commands.take(command_);
  if (monotonic_now() - command_.at > kForceStands) {
    axis.on = false;
    return motors_.play(axis.effect, false);
  }
  if (!axis.on || goes_on) axis.on = motors_.play(axis.effect, true);
  return axis.on;
}

void StickPusher::Motors::end() noexcept {
  (void)show(Vec2::Zero(), last_turn_);
  for (Axis& axis : axes_) {
    motors_.erase(axis.effect);
    axis = Axis();
    axis.effect.id = -1;  // not uploaded yet
  }
  motors_.close();
  now_.there = false;
  now_.force.setZero();
}

}  // namespace handrail
