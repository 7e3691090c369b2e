// Raw data transfer (RDT) of ATI Net F/T sensors, and of OnRobot's, which take two more commands:
// big-endian UDP datagrams.
//
// Source: ATI 9620-05; OptoForce's UDP examples, as public drivers of OnRobot HEX cite them.
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

enum class RdtDialect : std::uint8_t { kAti, kOnRobot };

enum class RdtCommand : std::uint16_t {
  kStop = 0,
  kStream = 2,
  kBias = 0x0042,
  kFilter = 0x0081,  // OnRobot
  kPeriod = 0x0082,  // OnRobot
};

// Computer to sensor. `value`: of kStream the records wanted, 0 = without end; of OnRobot's kBias
// 255 to take the present reading as zero, of kFilter its place in kRdtFilters, of kPeriod that of
// the stream [ms].
struct RdtRequest {
  RdtCommand command = RdtCommand::kStop;
  std::uint32_t value = 0;
};

// OnRobot's low passes by their number; the first is none [Hz].
inline constexpr std::array<double, 7> kRdtFilters = {0.0, 500.0, 150.0, 50.0, 15.0, 5.0, 1.5};
inline constexpr std::uint32_t kOnRobotBias = 255;
// What OnRobot's sensors count where nothing else was set [1/N, 1/(N m)].
inline constexpr double kOnRobotCountsPerN = 1e4, kOnRobotCountsPerNm = 1e5;

// Sensor to computer.
struct RdtRecord {
  std::uint32_t rdt_sequence = 0;        // position in this stream
  std::uint32_t ft_sequence = 0;         // the sensor's internal sample number
  std::uint32_t status = 0;              // non-zero: fault
  std::array<std::int32_t, 6> counts{};  // Fx Fy Fz Tx Ty Tz
};

// Bits of ATI's status: a gage, or a force or torque made of the gages, is beyond its range.
inline constexpr std::uint32_t kRdtGageOverrange = 1u << 27, kRdtOverrange = 1u << 30;
// ... and this one stands beside every other that means an error.
inline constexpr std::uint32_t kRdtError = 1u << 31;

// Real-time safe.
constexpr bool overrange(const RdtRecord& record) noexcept {
  return (record.status & (kRdtGageOverrange | kRdtOverrange)) != 0;
}

// All real-time safe. Decoding gives nothing for a datagram of another size or header, or a
// request with another command.
std::array<std::uint8_t, kRdtRequestSize> encode_rdt(const RdtRequest& request) noexcept;
std::array<std::uint8_t, kRdtRecordSize> encode_rdt(const RdtRecord& record) noexcept;
std::optional<RdtRequest> decode_rdt_request(std::span<const std::uint8_t> bytes) noexcept;
std::optional<RdtRecord> decode_rdt_record(std::span<const std::uint8_t> bytes) noexcept;

}  // namespace handrail
