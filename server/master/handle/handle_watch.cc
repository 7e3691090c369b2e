#include "server/master/handle/handle_watch.h"

#include <cmath>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

bool only_begins(HandleState state) {
  return state == HandleState::kWaiting || state == HandleState::kZeroing;
}

std::string rounded(const Vec3& v, double step) {
  std::string out;
  for (const double c : v)
    out += (out.empty() ? "" : " ") + number_text(std::round(c / step) * step);
  return out;
}

}  // namespace

bool HandleWatch::step(Nanos now, bool quiet) noexcept {
  const HandleState was = reading_.state;
  if (was == HandleState::kNone) go(HandleState::kWaiting, now);
  FtSample sample;
  const bool fresh = sensor_.poll(now, sample);
  if (!fresh) {
    const bool silent = heard_at_ != -kForever && now - heard_at_ > kPatience;
    if (silent) go(HandleState::kSilent, now);
    return reading_.state != was;
  }
  heard_at_ = now;
  const HandleState found = judge(sample);
  if (found == HandleState::kSound && !zeroed_) take_zero(now, quiet, sample);
  // Only what was read one after the other is a mean.
  if (found != HandleState::kSound) count_ = 0;
  go(found == HandleState::kSound && !zeroed_ ? HandleState::kZeroing : found, now);
  reading_.f_N_H = Wrench();
  if (reading_.state == HandleState::kSound) {
    reading_.f_N_H = {sample.wrench.force - zero_.force, sample.wrench.torque - zero_.torque};
  }
  return true;
}

HandleState HandleWatch::judge(const FtSample& sample) const noexcept {
  if (sample.status != 0 || !is_finite(sample.wrench)) return HandleState::kFaulty;
  const Vec3 along = options_.q_HF.conjugate() * sample.wrench.force;
  const bool beyond = along.cwiseAbs().maxCoeff() > sensor_.capabilities().range_force;
  return beyond ? HandleState::kBeyond : HandleState::kSound;
}

void HandleWatch::take_zero(Nanos now, bool quiet, const FtSample& sample) noexcept {
  if (!options_.takes_zero) {
    zeroed_ = true;
    return;
  }
  if (!quiet) {
    count_ = 0;
    return;
  }
  if (count_ == 0) {
    sum_ = Wrench();
    quiet_since_ = now;
  }
  sum_.force += sample.wrench.force;
  sum_.torque += sample.wrench.torque;
  ++count_;
  if (now - quiet_since_ < kZeroTime || count_ < kLeastReadings) return;
  zero_ = {sum_.force / count_, sum_.torque / count_};
  zeroed_ = true;
}

void HandleWatch::go(HandleState state, Nanos now) noexcept {
  if (state == reading_.state) return;
  reading_ = {state, {}};
  since_ = now;
  if (state == HandleState::kSilent) count_ = 0;
}

std::optional<HandleWatch::Line> HandleWatch::line(Nanos now) {
  const HandleState state = reading_.state;
  if (state == said_ || state == HandleState::kNone) return std::nullopt;
  if (now - said_at_ < kLinePause || (only_begins(state) && now - since_ < kLinePause)) {
    return std::nullopt;
  }
  said_ = state;
  said_at_ = now;
  Line out{state != HandleState::kSound && state != HandleState::kZeroing,
           "force sensor on the handle, " + sensor_.capabilities().name + ": " + describe(state)};
  if (state != HandleState::kSound || !options_.takes_zero) return out;
  out.text += "; taken as zero: " + rounded(zero_.force, 0.01) + " N, " +
              rounded(zero_.torque, 0.001) + " N m";
  return out;
}

}  // namespace handrail
