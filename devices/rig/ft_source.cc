#include "devices/rig/ft_source.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace handrail {
namespace {

// The share of an axis that its range lets through; `saturated` is set when that is not all of it.
double clip(double value, double range, bool& saturated) {
  if (std::abs(value) <= range) return value;
  saturated = true;
  return std::isnan(value) ? range : std::copysign(range, value);
}

double in_steps(double value, double step) {
  return step > 0.0 ? step * std::round(value / step) : value;
}

std::int32_t to_counts(double value, double counts_per_unit) {
  using Limits = std::numeric_limits<std::int32_t>;
  const double counts = std::round(value * counts_per_unit);
  return static_cast<std::int32_t>(
      std::clamp(counts, double{Limits::min()}, double{Limits::max()}));
}

}  // namespace

FtSource::FtSource(const FtSourceOptions& options) noexcept
    : options_(options),
      random_(options.seed),
      drift_random_(options.seed + 0xd41f7),
      switch_(options.seed + 0x5e4507, options.drop_share),
      zero_(options.zero.force) {
  if (options.drift_n_per_s <= 0.0 || options.drift_n <= 0.0) return;
  const double share = options.drift_n_per_s / options.drift_n;
  const double rate = 0.5 * share * share;  // at which a zero is drawn back [1/s]
  drift_left_ = std::exp(-rate * to_seconds(options.period));
  drift_added_ = options.drift_n * std::sqrt(-std::expm1(-2.0 * rate * to_seconds(options.period)));
}

void FtSource::on_datagram(std::span<const std::uint8_t> bytes, PeerId from) noexcept {
  if (!switch_.passes()) return;
  const std::optional<RdtRequest> request = decode_rdt_request(bytes);
  if (!request) {
    ++ignored_;
    return;
  }
  switch (request->command) {
    case RdtCommand::kStream:
      listener_ = from;
      samples_left_ = request->value;
      rdt_sequence_ = 0;
      break;
    case RdtCommand::kStop: listener_.reset(); break;
    case RdtCommand::kBias:
      if (is_finite(wrench_)) {
        bias_ = {wrench_.force + zero_, wrench_.torque + options_.zero.torque};
      }
      break;
    case RdtCommand::kFilter:
    case RdtCommand::kPeriod: break;  // for sensors of another make
  }
}

void FtSource::drift() noexcept {
  if (drift_added_ <= 0.0) return;
  for (int i = 0; i < 3; ++i) {
    zero_[i] = drift_left_ * zero_[i] + drift_added_ * drift_random_.normal();
  }
}

void FtSource::tick() noexcept {
  outgoing_.reset();
  drift();
  ++ft_sequence_;
  RdtRecord record;
  bool saturated = false;
  const bool noisy = options_.noise_n > 0.0 || options_.noise_n_m > 0.0;
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    double force = wrench_.force[i] + zero_[i],
           torque = wrench_.torque[i] + options_.zero.torque[i];
    if (noisy) {
      force += options_.noise_n * random_.normal();
      torque += options_.noise_n_m * random_.normal();
    }
    record.counts[at] = to_counts(
        in_steps(clip(force, options_.range_n, saturated), options_.step_n) - bias_.force[i],
        options_.counts_per_n);
    record.counts[at + 3] = to_counts(
        in_steps(clip(torque, options_.range_n_m, saturated), options_.step_n_m) - bias_.torque[i],
        options_.counts_per_n_m);
  }
  if (!listener_) return;
  record.rdt_sequence = ++rdt_sequence_;
  record.ft_sequence = ft_sequence_;
  record.status = saturated ? kRdtOverrange | kRdtError : 0;
  const PeerId to = *listener_;
  if (samples_left_ > 0 && --samples_left_ == 0) listener_.reset();
  if (switch_.passes()) outgoing_ = Outgoing{to, encode_rdt(record)};
}

}  // namespace handrail
