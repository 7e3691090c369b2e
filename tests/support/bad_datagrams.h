// Link datagrams that each fail one check, and the ones before it not.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "proto/link.pb.h"
#include "server/link/codec.h"
#include "server/link/frame.h"

namespace handrail::test {

struct BadDatagram {
  Reject cause;  // that a receiver must give
  std::vector<std::uint8_t> bytes;
};

template <typename State>
std::vector<std::uint8_t> sound_datagram(const DatagramHeader& header, const State& state) {
  Codec codec;
  std::vector<std::uint8_t> bytes(kMaxDatagram);
  Reject cause = Reject::kNone;
  bytes.resize(codec.encode(header, state, bytes, cause));
  EXPECT_EQ(cause, Reject::kNone);
  return bytes;
}

// For every check of frame and content, of a datagram of `Message`, which carries `State`.
template <typename Message, typename State>
std::vector<BadDatagram> bad_datagrams(const DatagramHeader& header, const State& state,
                                       DatagramKind kind) {
  const std::vector<std::uint8_t> sound = sound_datagram(header, state);
  std::vector<BadDatagram> out;
  const auto bytes = [&](Reject cause,
                         const std::function<void(std::vector<std::uint8_t>&)>& spoil) {
    out.push_back({cause, sound});
    spoil(out.back().bytes);
  };
  const auto payload = [&](Reject cause, const std::string& text, DatagramKind as) {
    out.push_back({cause, std::vector<std::uint8_t>(kFrameBytes + text.size())});
    std::copy(text.begin(), text.end(), out.back().bytes.begin() + kFrameBytes);
    seal_frame(as, out.back().bytes);
  };
  const auto message = [&](Reject cause, const std::function<void(Message&)>& spoil) {
    Message m;
    EXPECT_TRUE(
        m.ParseFromArray(sound.data() + kFrameBytes, static_cast<int>(sound.size() - kFrameBytes)));
    spoil(m);
    payload(cause, m.SerializeAsString(), kind);
  };
  bytes(Reject::kSize, [](auto& b) { b.resize(kFrameBytes - 1); });
  bytes(Reject::kSize, [](auto& b) { b.resize(kMaxDatagram + 1); });
  bytes(Reject::kMagic, [](auto& b) { b[0] ^= 1; });
  bytes(Reject::kVersion, [](auto& b) { ++b[4]; });
  const auto other = kind == DatagramKind::kMaster ? DatagramKind::kSlave : DatagramKind::kMaster;
  payload(Reject::kKind, std::string(sound.begin() + kFrameBytes, sound.end()), other);
  bytes(Reject::kLength, [](auto& b) { b.pop_back(); });
  bytes(Reject::kChecksum, [](auto& b) { b.back() ^= 1; });
  payload(Reject::kProtobuf, "\xff\xff\xff\xff", kind);
  message(Reject::kUnknownField,
          [](Message& m) { m.GetReflection()->MutableUnknownFields(&m)->AddVarint(999, 1); });
  message(Reject::kMissingField, [](Message& m) { m.clear_session(); });
  message(Reject::kHeader, [](Message& m) { m.set_session(0); });
  message(Reject::kHeader, [](Message& m) { m.set_sent_ns(-1); });
  message(Reject::kNotFinite,
          [](Message& m) { m.set_command_pose(0, std::numeric_limits<double>::quiet_NaN()); });
  message(Reject::kRotation, [](Message& m) { m.set_command_pose(3, 2.0); });
  message(Reject::kRange, [](Message& m) { m.set_command_pose(0, 1e6); });
  message(Reject::kScene, [](Message& m) { m.set_scene("a/b"); });
  if constexpr (std::is_same_v<Message, pb::MasterDatagram>) {
    message(Reject::kTool, [](Message& m) { m.set_position_hash(m.position_hash() + 1); });
  } else {
    message(Reject::kEnum, [](Message& m) { m.set_reason(9999); });
    message(Reject::kSurface, [](Message& m) { m.set_surface(2, 1); });  // 1 N/m
  }
  return out;
}

// The same of what a slave says to a master whom it refuses; `session` is that master's.
inline std::vector<BadDatagram> bad_refusals(std::uint64_t session) {
  Codec codec;
  std::vector<std::uint8_t> sound(kMaxDatagram);
  sound.resize(
      codec.encode(Refusal{session, false, fixed_text<LeaderName>("process 4711"), 0}, sound));
  std::vector<BadDatagram> out;
  const auto payload = [&](Reject cause, const std::string& text) {
    out.push_back({cause, std::vector<std::uint8_t>(kFrameBytes + text.size())});
    std::copy(text.begin(), text.end(), out.back().bytes.begin() + kFrameBytes);
    seal_frame(DatagramKind::kRefusal, out.back().bytes);
  };
  const auto message = [&](Reject cause, const std::function<void(pb::RefusalDatagram&)>& spoil) {
    pb::RefusalDatagram m;
    EXPECT_TRUE(
        m.ParseFromArray(sound.data() + kFrameBytes, static_cast<int>(sound.size() - kFrameBytes)));
    spoil(m);
    payload(cause, m.SerializeAsString());
  };
  out.push_back({Reject::kChecksum, sound});
  out.back().bytes.back() ^= 1;
  out.push_back({Reject::kLength, sound});
  out.back().bytes.pop_back();
  payload(Reject::kProtobuf, "\xff\xff\xff\xff");
  message(Reject::kUnknownField,
          [](auto& m) { m.GetReflection()->MutableUnknownFields(&m)->AddVarint(999, 1); });
  message(Reject::kMissingField, [](auto& m) { m.clear_leader(); });
  message(Reject::kHeader, [](auto& m) { m.set_leader(""); });
  message(Reject::kHeader, [](auto& m) { m.set_leader(std::string(48, 'x')); });
  message(Reject::kHeader, [](auto& m) { m.set_leader("a\nb"); });
  message(Reject::kHeader, [](auto& m) { m.set_led_for_ns(-1); });
  message(Reject::kHeader, [](auto& m) { m.set_refused_session(0); });
  message(Reject::kStale, [](auto& m) { m.set_refused_session(m.refused_session() + 1); });
  return out;
}

}  // namespace handrail::test
