#include "devices/net_ft/rdt_client.h"

namespace handrail {
namespace {

constexpr std::int32_t kRestartedBehind = 1000;  // [records], a second of the usual stream

}  // namespace

RdtClient::Bytes RdtClient::setting(int i) noexcept {
  if (options_.dialect != RdtDialect::kOnRobot) return {};
  if (options_.period_ms && i-- == 0) return write(RdtCommand::kPeriod, *options_.period_ms);
  if (options_.filter && i == 0) return write(RdtCommand::kFilter, *options_.filter);
  return {};
}

RdtClient::Bytes RdtClient::bias() noexcept {
  return write(RdtCommand::kBias, options_.dialect == RdtDialect::kOnRobot ? kOnRobotBias : 0);
}

RdtClient::Bytes RdtClient::start(Nanos now) noexcept {
  streaming_ = true;
  has_newest_ = false;
  quiet_since_ = now;
  ++counters_.requests;
  return write(RdtCommand::kStream);
}

bool RdtClient::on_datagram(Bytes bytes, Nanos now, FtSample& sample) noexcept {
  const std::optional<RdtRecord> record = decode_rdt_record(bytes);
  if (!record) {
    ++counters_.rejected;
    return false;
  }
  const auto ahead = static_cast<std::int32_t>(record->rdt_sequence - newest_);
  if (has_newest_ && ahead <= 0 && ahead > -kRestartedBehind) {
    ++counters_.stale;
    return false;
  }
  has_newest_ = true;
  newest_ = record->rdt_sequence;
  quiet_since_ = now;
  ++counters_.records;
  for (int i = 0; i < 3; ++i) {
    const auto force = static_cast<std::size_t>(i);
    sample.wrench.force[i] = record->counts[force] / options_.counts_per_n;
    sample.wrench.torque[i] = record->counts[force + 3] / options_.counts_per_n_m;
  }
  sample.sequence = record->rdt_sequence;
  sample.status = record->status;
  sample.overrange = options_.dialect == RdtDialect::kAti && overrange(*record);
  return true;
}

RdtClient::Bytes RdtClient::poll(Nanos now) noexcept {
  if (!streaming_ || now - quiet_since_ < options_.patience) return {};
  return start(now);
}

RdtClient::Bytes RdtClient::stop() noexcept {
  streaming_ = false;
  return write(RdtCommand::kStop);
}

RdtClient::Bytes RdtClient::write(RdtCommand command, std::uint32_t value) noexcept {
  buffer_ = encode_rdt(RdtRequest{command, value});
  return buffer_;
}

}  // namespace handrail
