#include "devices/net_ft/rdt_packet.h"

namespace handrail {
namespace {

void put16(std::uint8_t* out, std::uint16_t v) {
  out[0] = static_cast<std::uint8_t>(v >> 8);
  out[1] = static_cast<std::uint8_t>(v);
}

void put32(std::uint8_t* out, std::uint32_t v) {
  put16(out, static_cast<std::uint16_t>(v >> 16));
  put16(out + 2, static_cast<std::uint16_t>(v));
}

std::uint16_t get16(const std::uint8_t* in) {
  return static_cast<std::uint16_t>((in[0] << 8) | in[1]);
}

std::uint32_t get32(const std::uint8_t* in) {
  return (std::uint32_t{get16(in)} << 16) | get16(in + 2);
}

}  // namespace

std::array<std::uint8_t, kRdtRequestSize> encode_rdt(const RdtRequest& request) noexcept {
  std::array<std::uint8_t, kRdtRequestSize> bytes;
  put16(bytes.data(), kRdtHeader);
  put16(bytes.data() + 2, static_cast<std::uint16_t>(request.command));
  put32(bytes.data() + 4, request.value);
  return bytes;
}

std::array<std::uint8_t, kRdtRecordSize> encode_rdt(const RdtRecord& record) noexcept {
  std::array<std::uint8_t, kRdtRecordSize> bytes;
  put32(bytes.data(), record.rdt_sequence);
  put32(bytes.data() + 4, record.ft_sequence);
  put32(bytes.data() + 8, record.status);
  for (std::size_t i = 0; i < record.counts.size(); ++i) {
    put32(bytes.data() + 12 + 4 * i, static_cast<std::uint32_t>(record.counts[i]));
  }
  return bytes;
}

std::optional<RdtRequest> decode_rdt_request(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() != kRdtRequestSize || get16(bytes.data()) != kRdtHeader) return std::nullopt;
  const RdtRequest request{RdtCommand{get16(bytes.data() + 2)}, get32(bytes.data() + 4)};
  switch (request.command) {
    case RdtCommand::kStop:
    case RdtCommand::kStream:
    case RdtCommand::kBias:
    case RdtCommand::kFilter:
    case RdtCommand::kPeriod: return request;
  }
  return std::nullopt;
}

std::optional<RdtRecord> decode_rdt_record(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() != kRdtRecordSize) return std::nullopt;
  RdtRecord record;
  record.rdt_sequence = get32(bytes.data());
  record.ft_sequence = get32(bytes.data() + 4);
  record.status = get32(bytes.data() + 8);
  for (std::size_t i = 0; i < record.counts.size(); ++i) {
    record.counts[i] = static_cast<std::int32_t>(get32(bytes.data() + 12 + 4 * i));
  }
  return record;
}

}  // namespace handrail
