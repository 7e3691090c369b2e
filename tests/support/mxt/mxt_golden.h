// Packets of real-time external control written by hand from the protocol's field table, not by the
// project's own encoder: all fields zero but those listed, each at its offset, little-endian.
//
//   0 Command  2 SendType  4 RecvType  8 dat  48..57 I/O  58 TCount  60 CCount
//   64 RecvType1  68 dat1  108 RecvType2  112 dat2  152 RecvType3  156 dat3
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "server/base/joints.h"

namespace handrail::golden {

using Packet = std::vector<std::uint8_t>;

struct Field {
  std::size_t at;
  Packet bytes;
};

inline Packet packet(std::size_t size, std::initializer_list<Field> fields) {
  Packet out(size, 0);
  for (const Field& field : fields) {
    std::size_t at = field.at;
    for (const std::uint8_t byte : field.bytes) out.at(at++) = byte;
  }
  return out;
}

// J1..J6 = 0.25, -0.5, 1.5, 2, -1, 0.125 rad as float32.
inline const JointVector kTarget{{0.25, -0.5, 1.5, 2.0, -1.0, 0.125}};
inline const Packet kTargetBytes{0x00, 0x00, 0x80, 0x3e, 0x00, 0x00, 0x00, 0xbf,
                                 0x00, 0x00, 0xc0, 0x3f, 0x00, 0x00, 0x00, 0x40,
                                 0x00, 0x00, 0x80, 0xbf, 0x00, 0x00, 0x00, 0x3e};
// J1..J6 = 0.5, -0.25, 1, 1.5, -2, 0.75 rad.
inline const JointVector kMeasured{{0.5, -0.25, 1.0, 1.5, -2.0, 0.75}};
inline const Packet kMeasuredBytes{0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0xbe,
                                   0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0xc0, 0x3f,
                                   0x00, 0x00, 0x00, 0xc0, 0x00, 0x00, 0x40, 0x3f};

// The opening packet: NULL, joint feedback wanted; the long form wants the joint command in dat1.
inline Packet null_short() { return packet(64, {{4, {8, 0}}}); }
inline Packet null_long() { return packet(196, {{4, {8, 0}}, {64, {2, 0}}}); }

// The further packets that open a session: NULL, the joint command wanted; the long form wants the
// joint feedback in dat1.
inline Packet null_short_held(std::uint8_t c_count) {
  return packet(64, {{4, {2, 0}}, {60, {c_count, 0, 0, 0}}});
}
inline Packet null_long_held(std::uint8_t c_count) {
  return packet(196, {{4, {2, 0}}, {60, {c_count, 0, 0, 0}}, {64, {8, 0}}});
}

// MOVE to kTarget.
inline Packet move_short(std::uint8_t c_count) {
  return packet(
      64, {{0, {1, 0}}, {2, {2, 0}}, {4, {8, 0}}, {8, kTargetBytes}, {60, {c_count, 0, 0, 0}}});
}
inline Packet move_long(std::uint8_t c_count) {
  return packet(196, {{0, {1, 0}},
                      {2, {2, 0}},
                      {4, {8, 0}},
                      {8, kTargetBytes},
                      {60, {c_count, 0, 0, 0}},
                      {64, {2, 0}}});
}

inline Packet end_short(std::uint8_t c_count) {
  return packet(64, {{0, {0xff, 0}}, {60, {c_count, 0, 0, 0}}});
}
inline Packet end_long(std::uint8_t c_count) {
  return packet(196, {{0, {0xff, 0}}, {60, {c_count, 0, 0, 0}}});
}

// Feedback kMeasured, three cycles waited; the long form adds the command kTarget in dat1.
inline Packet reply_short() {
  return packet(
      64, {{2, {8, 0}}, {4, {8, 0}}, {8, kMeasuredBytes}, {58, {3, 0}}, {60, {0x2a, 0, 0, 0}}});
}
inline Packet reply_short_held() {
  return packet(64, {{2, {2, 0}}, {4, {2, 0}}, {8, kTargetBytes}, {60, {0x2b, 0, 0, 0}}});
}
inline Packet reply_long() {
  return packet(196, {{2, {8, 0}},
                      {4, {8, 0}},
                      {8, kMeasuredBytes},
                      {58, {3, 0}},
                      {60, {0x2a, 0, 0, 0}},
                      {64, {2, 0}},
                      {68, kTargetBytes}});
}

// The same in the other order.
inline Packet reply_long_held() {
  return packet(196, {{2, {2, 0}},
                      {4, {2, 0}},
                      {8, kTargetBytes},
                      {58, {3, 0}},
                      {60, {0x2b, 0, 0, 0}},
                      {64, {8, 0}},
                      {68, kMeasuredBytes}});
}

}  // namespace handrail::golden
