#include "devices/melfa/mxt_packet.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

// Offsets of the fields [bytes]. Words at 6, 66, 110 and 154 are padding.
constexpr std::size_t kCommandAt = 0;
constexpr std::size_t kSendTypeAt = 2;
constexpr std::size_t kIoAt = 48;
constexpr std::size_t kTCountAt = 58;
constexpr std::size_t kCCountAt = 60;
constexpr std::array<std::size_t, 4> kTypeAt{4, 64, 108, 152};
constexpr std::array<std::size_t, 4> kBlockAt{8, 68, 112, 156};

constexpr auto kLastType = static_cast<std::uint16_t>(MxtType::kFeedbackCurrent);

void put16(std::span<std::uint8_t> out, std::size_t at, std::uint16_t v) {
  out[at] = static_cast<std::uint8_t>(v);
  out[at + 1] = static_cast<std::uint8_t>(v >> 8);
}

void put32(std::span<std::uint8_t> out, std::size_t at, std::uint32_t v) {
  put16(out, at, static_cast<std::uint16_t>(v));
  put16(out, at + 2, static_cast<std::uint16_t>(v >> 16));
}

std::uint16_t get16(std::span<const std::uint8_t> in, std::size_t at) {
  return static_cast<std::uint16_t>(in[at] | (in[at + 1] << 8));
}

std::uint32_t get32(std::span<const std::uint8_t> in, std::size_t at) {
  return get16(in, at) | (std::uint32_t{get16(in, at + 2)} << 16);
}

std::size_t blocks_in(std::size_t size) { return size == kMxtLong ? 4 : 1; }

bool holds_finite(MxtType type, const MxtBlock& block) {
  if (!is_joint(type) && !is_pose(type)) return true;
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (!std::isfinite(block.real(i))) return false;
  }
  return true;
}

// Every field as it stands on the wire; checks the size and the type codes.
MxtParse decode_fields(std::span<const std::uint8_t> bytes, MxtPacket& out) {
  if (bytes.size() != kMxtShort && bytes.size() != kMxtLong) return MxtParse::kWrongSize;
  out = MxtPacket{};
  const std::uint16_t send_type = get16(bytes, kSendTypeAt);
  if (send_type > kLastType) return MxtParse::kWrongType;
  out.command = MxtCommand{get16(bytes, kCommandAt)};
  out.send_type = MxtType{send_type};
  for (std::size_t b = 0; b < blocks_in(bytes.size()); ++b) {
    const std::uint16_t type = get16(bytes, kTypeAt[b]);
    if (type > kLastType) return MxtParse::kWrongType;
    out.type[b] = MxtType{type};
    for (std::size_t i = 0; i < out.block[b].words.size(); ++i) {
      out.block[b].words[i] = get32(bytes, kBlockAt[b] + 4 * i);
    }
  }
  out.io = {get16(bytes, kIoAt), get16(bytes, kIoAt + 2), get16(bytes, kIoAt + 4),
            get16(bytes, kIoAt + 6), get16(bytes, kIoAt + 8)};
  out.t_count = get16(bytes, kTCountAt);
  out.c_count = get32(bytes, kCCountAt);
  return MxtParse::kOk;
}

}  // namespace

JointVector MxtBlock::joints() const noexcept {
  JointVector q;
  for (int i = 0; i < kJoints; ++i) q[i] = real(static_cast<std::size_t>(i));
  return q;
}

void MxtBlock::set_joints(const JointVector& q) noexcept {
  for (int i = 0; i < kJoints; ++i) set_real(static_cast<std::size_t>(i), q[i]);
}

std::span<const std::uint8_t> encode_mxt(const MxtPacket& packet, std::size_t size,
                                         std::span<std::uint8_t, kMxtLong> out) noexcept {
  const std::span<std::uint8_t> bytes = out.first(size == kMxtLong ? kMxtLong : kMxtShort);
  std::ranges::fill(bytes, std::uint8_t{0});
  put16(bytes, kCommandAt, static_cast<std::uint16_t>(packet.command));
  put16(bytes, kSendTypeAt, static_cast<std::uint16_t>(packet.send_type));
  for (std::size_t b = 0; b < blocks_in(bytes.size()); ++b) {
    put16(bytes, kTypeAt[b], static_cast<std::uint16_t>(packet.type[b]));
    for (std::size_t i = 0; i < packet.block[b].words.size(); ++i) {
      put32(bytes, kBlockAt[b] + 4 * i, packet.block[b].words[i]);
    }
  }
  put16(bytes, kIoAt, packet.io.send_type);
  put16(bytes, kIoAt + 2, packet.io.recv_type);
  put16(bytes, kIoAt + 4, packet.io.bit_top);
  put16(bytes, kIoAt + 6, packet.io.bit_mask);
  put16(bytes, kIoAt + 8, packet.io.data);
  put16(bytes, kTCountAt, packet.t_count);
  put32(bytes, kCCountAt, packet.c_count);
  return bytes;
}

MxtParse decode_mxt_request(std::span<const std::uint8_t> bytes, MxtPacket& out) noexcept {
  if (const MxtParse parsed = decode_fields(bytes, out); parsed != MxtParse::kOk) return parsed;
  return holds_finite(out.send_type, out.block[0]) ? MxtParse::kOk : MxtParse::kNotFinite;
}

bool is_mxt_move(std::span<const std::uint8_t> bytes) noexcept {
  MxtPacket packet;
  return decode_mxt_request(bytes, packet) == MxtParse::kOk && packet.command == MxtCommand::kMove;
}

MxtParse decode_mxt_reply(std::span<const std::uint8_t> bytes, MxtPacket& out) noexcept {
  if (const MxtParse parsed = decode_fields(bytes, out); parsed != MxtParse::kOk) return parsed;
  if (out.type[0] == MxtType::kNull) out.type[0] = out.send_type;
  if (out.send_type == MxtType::kNull) out.send_type = out.type[0];
  if (out.send_type != out.type[0]) return MxtParse::kWrongType;
  for (std::size_t b = 0; b < out.block.size(); ++b) {
    if (!holds_finite(out.type[b], out.block[b])) return MxtParse::kNotFinite;
  }
  return MxtParse::kOk;
}

}  // namespace handrail
