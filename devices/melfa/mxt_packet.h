// The packet of MELFA real-time external control (MXT): one layout for both directions,
// little-endian, float32, in a short form of 64 bytes (controllers before software H7) and a long
// one of 196.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "server/base/in_32_bits.h"
#include "server/base/joints.h"
#include "server/base/time.h"

namespace handrail {

inline constexpr std::size_t kMxtShort = 64;               // [bytes]
inline constexpr std::size_t kMxtLong = 196;               // [bytes]
inline constexpr Nanos kMxtPeriod = 7'100 * kMicrosecond;  // control cycle of the CR1-571
inline constexpr std::uint16_t kMxtPort = 10000;

enum class MxtCommand : std::uint16_t { kNull = 0, kMove = 1, kEnd = 255 };

// What a data block holds.
enum class MxtType : std::uint16_t {
  kNull = 0,
  kPose = 1,  // commanded
  kJoint = 2,
  kPulse = 3,
  kFilteredPose = 4,  // commanded, behind the controller's filter
  kFilteredJoint = 5,
  kFilteredPulse = 6,
  kFeedbackPose = 7,  // from the encoders
  kFeedbackJoint = 8,
  kFeedbackPulse = 9,
  kCommandCurrent = 10,  // [%]
  kFeedbackCurrent = 11,
};

constexpr bool is_joint(MxtType t) {
  return t == MxtType::kJoint || t == MxtType::kFilteredJoint || t == MxtType::kFeedbackJoint;
}
constexpr bool is_pose(MxtType t) {
  return t == MxtType::kPose || t == MxtType::kFilteredPose || t == MxtType::kFeedbackPose;
}

// One data block as ten words; its type says what they are. JOINT: words 0-7 are float32 J1..J8
// [rad]. POSE: words 0-7 are float32 x, y, z [mm], A, B, C [rad], L1, L2; words 8 and 9 are the
// structure and the multi-turn flags. PULSE and currents: words 0-7 are int32.
struct MxtBlock {
  std::array<std::uint32_t, 10> words{};

  float real(std::size_t i) const noexcept { return std::bit_cast<float>(words[i]); }
  void set_real(std::size_t i, double v) noexcept {
    words[i] = std::bit_cast<std::uint32_t>(in_32_bits(v));
  }
  JointVector joints() const noexcept;
  void set_joints(const JointVector& q) noexcept;
};

// What a packet's word of digital signals is of; 0: it has none, 2: inputs.
inline constexpr std::uint16_t kMxtOutputs = 1;
inline constexpr int kMxtIoBits = 16;

// Digital input and output. Request: outputs bit_top and on, as many as bit_mask has, become those
// of `data`. Reply: `data` is what send_type says, from bit_top on.
struct MxtIo {
  std::uint16_t send_type = 0;
  std::uint16_t recv_type = 0;
  std::uint16_t bit_top = 0;
  std::uint16_t bit_mask = 0;
  std::uint16_t data = 0;
};

struct MxtPacket {
  MxtCommand command = MxtCommand::kNull;
  MxtType send_type = MxtType::kNull;  // request: type of block[0]. Reply: same as type[0]
  std::array<MxtType, 4> type{};       // request: types wanted back. Reply: types of the blocks
  std::array<MxtBlock, 4> block{};     // the short form has only the first
  MxtIo io;
  std::uint16_t t_count = 0;  // reply: control cycles without a packet from us
  std::uint32_t c_count = 0;  // the sender's packet counter
};

enum class MxtParse : std::uint8_t { kOk, kWrongSize, kWrongType, kNotFinite };

// Writes the form of `size` bytes, kMxtShort or kMxtLong, and returns the bytes written: a prefix
// of `out`. Reserved fields are zero. Real-time safe.
std::span<const std::uint8_t> encode_mxt(const MxtPacket& packet, std::size_t size,
                                         std::span<std::uint8_t, kMxtLong> out) noexcept;

// Reads what the PC sends. Not finite: one of six values of a joint or pose command is NaN or
// infinite. The command code is left for the receiver to judge. `out` is filled with kOk and
// kNotFinite. Real-time safe.
MxtParse decode_mxt_request(std::span<const std::uint8_t> bytes, MxtPacket& out) noexcept;

// Whether this is a command to move that is to be obeyed. Real-time safe.
bool is_mxt_move(std::span<const std::uint8_t> bytes) noexcept;

// Reads what the controller sends. It writes the first block's type in two places; one may be zero,
// but they must not contradict each other. Finite: the first six values of every joint or pose
// block. `out` is meaningful only with kOk. Real-time safe.
MxtParse decode_mxt_reply(std::span<const std::uint8_t> bytes, MxtPacket& out) noexcept;

}  // namespace handrail
