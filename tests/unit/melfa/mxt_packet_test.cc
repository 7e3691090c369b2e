#include "devices/melfa/mxt_packet.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/mxt/mxt_golden.h"

namespace handrail {
namespace {

using golden::Packet;

Packet encode(const MxtPacket& packet, std::size_t size) {
  std::array<std::uint8_t, kMxtLong> buffer;
  const auto bytes = encode_mxt(packet, size, buffer);
  return {bytes.begin(), bytes.end()};
}

MxtPacket null_packet() {
  MxtPacket packet;
  packet.type = {MxtType::kFeedbackJoint, MxtType::kJoint};
  return packet;
}

MxtPacket move_packet(std::uint32_t c_count) {
  MxtPacket packet = null_packet();
  packet.command = MxtCommand::kMove;
  packet.send_type = MxtType::kJoint;
  packet.block[0].set_joints(golden::kTarget);
  packet.c_count = c_count;
  return packet;
}

// The bytes of `packet` with some of them replaced.
Packet patched(Packet packet, std::initializer_list<golden::Field> fields) {
  for (const golden::Field& field : fields) {
    std::copy(field.bytes.begin(), field.bytes.end(),
              packet.begin() + static_cast<std::ptrdiff_t>(field.at));
  }
  return packet;
}

const Packet kNan{0x00, 0x00, 0xc0, 0x7f};
const Packet kInfinity{0x00, 0x00, 0x80, 0x7f};

TEST(MxtPacket, EncodesTheOpeningPacketAsTheFieldTableSays) {
  EXPECT_EQ(encode(null_packet(), kMxtShort), golden::null_short());
  EXPECT_EQ(encode(null_packet(), kMxtLong), golden::null_long());
}

TEST(MxtPacket, EncodesMovesAsTheFieldTableSays) {
  EXPECT_EQ(encode(move_packet(7), kMxtShort), golden::move_short(7));
  EXPECT_EQ(encode(move_packet(7), kMxtLong), golden::move_long(7));
}

TEST(MxtPacket, EncodesTheEndAsTheFieldTableSays) {
  MxtPacket packet;
  packet.command = MxtCommand::kEnd;
  packet.c_count = 9;
  EXPECT_EQ(encode(packet, kMxtShort), golden::end_short(9));
  EXPECT_EQ(encode(packet, kMxtLong), golden::end_long(9));
}

TEST(MxtPacket, EveryFieldHasItsOwnPlace) {
  MxtPacket packet;
  packet.command = MxtCommand::kMove;
  packet.send_type = MxtType::kPose;
  packet.type = {MxtType::kFilteredPose, MxtType::kFeedbackPulse, MxtType::kCommandCurrent,
                 MxtType::kFeedbackCurrent};
  for (std::size_t b = 0; b < 4; ++b) {
    packet.block[b].words[0] = 0x11000000u + static_cast<std::uint32_t>(b);
    packet.block[b].words[9] = 0x99000000u + static_cast<std::uint32_t>(b);
  }
  packet.io = {1, 2, 0x0384, 0x00ff, 0x1234};
  packet.t_count = 0x5678;
  packet.c_count = 0x9abcdef0;
  const Packet expected = golden::packet(196, {{0, {1, 0}},
                                               {2, {1, 0}},
                                               {4, {4, 0}},
                                               {8, {0, 0, 0, 0x11}},
                                               {44, {0, 0, 0, 0x99}},
                                               {48, {1, 0}},
                                               {50, {2, 0}},
                                               {52, {0x84, 3}},
                                               {54, {0xff, 0}},
                                               {56, {0x34, 0x12}},
                                               {58, {0x78, 0x56}},
                                               {60, {0xf0, 0xde, 0xbc, 0x9a}},
                                               {64, {9, 0}},
                                               {68, {1, 0, 0, 0x11}},
                                               {104, {1, 0, 0, 0x99}},
                                               {108, {10, 0}},
                                               {112, {2, 0, 0, 0x11}},
                                               {148, {2, 0, 0, 0x99}},
                                               {152, {11, 0}},
                                               {156, {3, 0, 0, 0x11}},
                                               {192, {3, 0, 0, 0x99}}});
  EXPECT_EQ(encode(packet, kMxtLong), expected);
  MxtPacket back;
  ASSERT_EQ(decode_mxt_request(expected, back), MxtParse::kOk);
  EXPECT_EQ(encode(back, kMxtLong), expected);
  EXPECT_EQ(back.io.bit_top, 900);
}

TEST(MxtPacket, DecodesRepliesOfBothSizes) {
  MxtPacket packet;
  ASSERT_EQ(decode_mxt_reply(golden::reply_short(), packet), MxtParse::kOk);
  EXPECT_EQ(packet.type[0], MxtType::kFeedbackJoint);
  EXPECT_EQ(packet.block[0].joints(), golden::kMeasured);
  EXPECT_EQ(packet.t_count, 3);
  EXPECT_EQ(packet.c_count, 42u);
  EXPECT_EQ(packet.type[1], MxtType::kNull);
  ASSERT_EQ(decode_mxt_reply(golden::reply_long(), packet), MxtParse::kOk);
  EXPECT_EQ(packet.block[0].joints(), golden::kMeasured);
  EXPECT_EQ(packet.type[1], MxtType::kJoint);
  EXPECT_EQ(packet.block[1].joints(), golden::kTarget);
}

TEST(MxtPacket, TakesTheReplysTypeFromEitherPlaceButNotFromAContradiction) {
  MxtPacket packet;
  EXPECT_EQ(decode_mxt_reply(patched(golden::reply_long(), {{2, {0}}}), packet), MxtParse::kOk);
  EXPECT_EQ(packet.type[0], MxtType::kFeedbackJoint);
  EXPECT_EQ(decode_mxt_reply(patched(golden::reply_long(), {{4, {0}}}), packet), MxtParse::kOk);
  EXPECT_EQ(packet.type[0], MxtType::kFeedbackJoint);
  EXPECT_EQ(decode_mxt_reply(patched(golden::reply_long(), {{4, {7}}}), packet),
            MxtParse::kWrongType);
}

TEST(MxtPacket, RejectsEveryOtherSize) {
  MxtPacket packet;
  for (std::size_t size = 0; size <= 400; ++size) {
    const bool right = size == 64 || size == 196;
    const MxtParse expected = right ? MxtParse::kOk : MxtParse::kWrongSize;
    EXPECT_EQ(decode_mxt_reply(Packet(size, 0), packet), expected) << size;
    EXPECT_EQ(decode_mxt_request(Packet(size, 0), packet), expected) << size;
  }
}

TEST(MxtPacket, RejectsUnknownTypesInEveryBlock) {
  MxtPacket packet;
  for (const std::size_t at : {2u, 4u, 64u, 108u, 152u}) {
    const Packet bad = patched(golden::reply_long(), {{at, {12}}});
    EXPECT_EQ(decode_mxt_reply(bad, packet), MxtParse::kWrongType) << at;
    EXPECT_EQ(decode_mxt_request(bad, packet), MxtParse::kWrongType) << at;
  }
}

TEST(MxtPacket, RejectsNonFiniteJointsInEveryJointBlock) {
  MxtPacket packet;
  for (const Packet& bad : {kNan, kInfinity}) {
    for (std::size_t joint = 0; joint < 6; ++joint) {
      EXPECT_EQ(decode_mxt_reply(patched(golden::reply_long(), {{8 + 4 * joint, bad}}), packet),
                MxtParse::kNotFinite);
      EXPECT_EQ(decode_mxt_reply(patched(golden::reply_long(), {{68 + 4 * joint, bad}}), packet),
                MxtParse::kNotFinite);
      EXPECT_EQ(decode_mxt_request(patched(golden::move_short(1), {{8 + 4 * joint, bad}}), packet),
                MxtParse::kNotFinite);
    }
  }
  // Currents are integers: any bits are fine.
  EXPECT_EQ(decode_mxt_reply(patched(golden::reply_long(), {{152, {11}}, {156, kNan}}), packet),
            MxtParse::kOk);
}

// Random packets of a right size with plausible types: pure noise would hardly ever get past the
// type codes.
rc::Gen<Packet> packets() {
  return rc::gen::apply(
      [](bool wide, std::vector<std::uint8_t> noise, std::array<std::uint8_t, 5> types) {
        Packet bytes(wide ? 196 : 64, 0);
        for (std::size_t i = 0; i < bytes.size() && i < noise.size(); ++i) bytes[i] = noise[i];
        const std::array<std::size_t, 5> at{2, 4, 64, 108, 152};
        for (std::size_t i = 0; i < at.size(); ++i) {
          if (at[i] >= bytes.size()) continue;
          bytes[at[i]] = types[i];
          bytes[at[i] + 1] = 0;
        }
        bytes[2] = bytes[4];
        return bytes;
      },
      rc::gen::arbitrary<bool>(),
      rc::gen::container<std::vector<std::uint8_t>>(196, rc::gen::arbitrary<std::uint8_t>()),
      rc::gen::container<std::array<std::uint8_t, 5>>(rc::gen::inRange<std::uint8_t>(0, 12)));
}

void expect_finite_or_refused(const Packet& bytes) {
  MxtPacket packet;
  if (decode_mxt_reply(bytes, packet) == MxtParse::kOk) {
    for (std::size_t b = 0; b < 4; ++b) {
      if (is_joint(packet.type[b])) RC_ASSERT(packet.block[b].joints().allFinite());
    }
  }
  if (decode_mxt_request(bytes, packet) == MxtParse::kOk && is_joint(packet.send_type)) {
    RC_ASSERT(packet.block[0].joints().allFinite());
  }
}

RC_GTEST_PROP(MxtPacketProperty, AnyBytesDecodeToFiniteJointsOrNothing,
              (const std::vector<std::uint8_t>& bytes)) {
  expect_finite_or_refused(bytes);
}

RC_GTEST_PROP(MxtPacketProperty, NoisyPacketsDecodeToFiniteJointsOrNothing, ()) {
  Packet bytes = *packets();
  // Make a non-finite joint likely.
  if (*rc::gen::arbitrary<bool>()) {
    const std::size_t joint = *rc::gen::inRange<std::size_t>(0, 6);
    std::copy(kNan.begin(), kNan.end(), bytes.begin() + static_cast<std::ptrdiff_t>(8 + 4 * joint));
  }
  expect_finite_or_refused(bytes);
}

}  // namespace
}  // namespace handrail
