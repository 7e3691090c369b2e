// Raw data transfer (RDT) of ATI Net F/T sensors: big-endian UDP datagrams.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace handrail {

inline constexpr std::uint16_t kRdtPort = 49152;
inline constexpr std::uint16_t kRdtHeader = 0x1234;
inline constexpr std::size_t kRdtRequestSize = 8;  // [bytes]
inline constexpr std::size_t kRdtRecordSize = 36;  // [bytes]

enum class RdtCommand : std::uint16_t { kStop = 0, kStream = 2, kBias = 0x0042 };

// Computer to sensor. `samples`: records wanted, 0 = without end.
struct RdtRequest {
  RdtCommand command = RdtCommand::kStop;
  std::uint32_t samples = 0;
};

// Sensor to computer.
struct RdtRecord {
  std::uint32_t rdt_sequence = 0;        // position in this stream
  std::uint32_t ft_sequence = 0;         // the sensor's internal sample number
  std::uint32_t status = 0;              // non-zero: fault
  std::array<std::int32_t, 6> counts{};  // Fx Fy Fz Tx Ty Tz
};

// All real-time safe. Decoding gives nothing for a datagram of another size, header or command.
std::array<std::uint8_t, kRdtRequestSize> encode_rdt(const RdtRequest& request) noexcept;
std::array<std::uint8_t, kRdtRecordSize> encode_rdt(const RdtRecord& record) noexcept;
std::optional<RdtRequest> decode_rdt_request(std::span<const std::uint8_t> bytes) noexcept;
std::optional<RdtRecord> decode_rdt_record(std::span<const std::uint8_t> bytes) noexcept;

}  // namespace handrail
