#include "server/link/codec.h"

#include <gtest/gtest.h>

#include <boost/crc.hpp>
#include <initializer_list>
#include <limits>

#include "proto/link.pb.h"
#include "server/link/frame.h"
#include "tests/support/no_allocation.h"
#include "tests/unit/link/link_samples.h"

namespace handrail {
namespace {

std::vector<std::uint8_t> framed(const std::string& payload,
                                 DatagramKind kind = DatagramKind::kMaster) {
  std::vector<std::uint8_t> bytes(kFrameBytes + payload.size());
  std::copy(payload.begin(), payload.end(), bytes.begin() + kFrameBytes);
  seal_frame(kind, bytes);
  return bytes;
}

pb::MasterDatagram sample_message() {
  const auto bytes = datagram(sample_header(), sample_master());
  pb::MasterDatagram message;
  EXPECT_TRUE(message.ParseFromArray(bytes.data() + kFrameBytes,
                                     static_cast<int>(bytes.size() - kFrameBytes)));
  return message;
}

Reject decode(const std::vector<std::uint8_t>& bytes) {
  Codec codec;
  DatagramHeader header;
  MasterState state;
  return codec.decode(bytes, header, state);
}

Reject decode(const pb::MasterDatagram& message) {
  return decode(framed(message.SerializeAsString()));
}

template <typename State>
Reject encode_cause(const DatagramHeader& header, const State& state) {
  Codec codec;
  std::array<std::uint8_t, kMaxDatagram> out;
  Reject cause = Reject::kNone;
  const std::size_t size = codec.encode(header, state, out, cause);
  EXPECT_EQ(size == 0, cause != Reject::kNone);
  return cause;
}

TEST(Codec, TheLargestDatagramFits) {
  MasterState master = sample_master();
  SlaveState slave = sample_slave();
  master.scene = slave.scene = scene_name("a-scene-name-of-forty-seven-characters-exactly_");
  slave.reason = slave.fault = static_cast<Reason>(static_cast<int>(Reason::kCount) - 1);
  DatagramHeader header = sample_header(UINT64_MAX, UINT64_MAX);
  header.sent = INT64_MAX;
  const auto largest = std::max(datagram(header, master).size(), datagram(header, slave).size());
  EXPECT_EQ(largest, 578u);
  EXPECT_LE(largest, kMaxDatagram);
}

TEST(Codec, SizeDependsOnTheSceneNameAlone) {
  MasterState empty;
  MasterState full = sample_master();
  full.scene = empty.scene;
  EXPECT_EQ(datagram(sample_header(), empty).size(),
            datagram(sample_header(UINT64_MAX, UINT64_MAX), full).size());
}

TEST(Codec, ASurfaceTakesAsMuchRoomAsNone) {
  SlaveState with = sample_slave(), without = sample_slave();
  with.surface = Surface{-Vec3::UnitX(), -kFarthestSurface, kStiffestSurface};
  without.surface.reset();
  without.log_lost = false;
  without.program = {};
  EXPECT_EQ(datagram(sample_header(), with).size(), datagram(sample_header(), without).size());
}

TEST(Codec, ATooSmallBufferIsRefused) {
  Codec codec;
  std::array<std::uint8_t, 100> out{};
  Reject cause = Reject::kNone;
  EXPECT_EQ(codec.encode(sample_header(), sample_master(), out, cause), 0u);
  EXPECT_EQ(cause, Reject::kSize);
}

TEST(Codec, DoesNotAllocate) {
  Codec codec;
  std::array<std::uint8_t, kMaxDatagram> out;
  MasterState master = sample_master();
  SlaveState slave = sample_slave();
  master.scene = slave.scene = scene_name("a-scene-name-of-forty-seven-characters-exactly_");
  DatagramHeader header = sample_header();
  Reject cause = Reject::kNone;
  bool sound = true;
  {
    test::NoAllocation guard("the codec");
    for (int i = 0; i < 3; ++i) {
      std::size_t size = codec.encode(header, master, out, cause);
      sound = sound && codec.decode(std::span(out).first(size), header, master) == Reject::kNone;
      size = codec.encode(header, slave, out, cause);
      sound = sound && codec.decode(std::span(out).first(size), header, slave) == Reject::kNone;
    }
  }
  EXPECT_TRUE(sound);
}

TEST(Codec, AChecksumOverOtherBytesIsRefused) {
  auto bytes = datagram(sample_header(), sample_master());
  bytes[8] ^= 0x55;
  EXPECT_EQ(decode(bytes), Reject::kChecksum);
}

TEST(Codec, GarbageInASoundFrameIsRefused) {
  EXPECT_EQ(decode(framed("\xff\xff\xff\xff")), Reject::kProtobuf);
  EXPECT_EQ(decode(framed("")), Reject::kMissingField);
}

TEST(Codec, EveryFieldMustBePresent) {
  const pb::MasterDatagram whole = sample_message();
  const auto* reflection = whole.GetReflection();
  const auto* descriptor = whole.GetDescriptor();
  EXPECT_EQ(decode(whole), Reject::kNone);
  for (int i = 0; i < descriptor->field_count(); ++i) {
    pb::MasterDatagram cut = whole;
    reflection->ClearField(&cut, descriptor->field(i));
    EXPECT_EQ(decode(cut), Reject::kMissingField) << descriptor->field(i)->name();
  }
}

TEST(Codec, EverySlaveFieldMustBePresent) {
  const auto bytes = datagram(sample_header(), sample_slave());
  pb::SlaveDatagram whole;
  ASSERT_TRUE(whole.ParseFromArray(bytes.data() + kFrameBytes,
                                   static_cast<int>(bytes.size() - kFrameBytes)));
  Codec codec;
  DatagramHeader header;
  SlaveState state;
  for (int i = 0; i < whole.GetDescriptor()->field_count(); ++i) {
    pb::SlaveDatagram cut = whole;
    cut.GetReflection()->ClearField(&cut, whole.GetDescriptor()->field(i));
    EXPECT_EQ(codec.decode(framed(cut.SerializeAsString(), DatagramKind::kSlave), header, state),
              Reject::kMissingField)
        << whole.GetDescriptor()->field(i)->name();
  }
}

TEST(Codec, AnExtraElementIsRefused) {
  pb::MasterDatagram message = sample_message();
  message.add_command_pose(0.0);
  EXPECT_EQ(decode(message), Reject::kMissingField);
}

TEST(Codec, AToolThatIsNotTheOneItsHashNamesIsRefused) {
  pb::MasterDatagram message = sample_message();
  EXPECT_EQ(decode(message), Reject::kNone);
  message.set_position_hash(message.position_hash() ^ 1);
  EXPECT_EQ(decode(message), Reject::kTool);
  message = sample_message();
  message.set_orientation_hash(message.orientation_hash() ^ 1);
  EXPECT_EQ(decode(message), Reject::kTool);
}

TEST(Codec, UnknownFieldsAndEnumValuesAreRefused) {
  pb::MasterDatagram message = sample_message();
  message.mutable_unknown_fields()->AddVarint(900, 1);
  EXPECT_EQ(decode(message), Reject::kUnknownField);
  std::string payload = sample_message().SerializeAsString();
  payload += std::string("\x40\x09", 2);  // field 8, desired = 9
  EXPECT_EQ(decode(framed(payload)), Reject::kUnknownField);
}

TEST(Codec, OtherFieldOrderAndUnpackedNumbersAreTaken) {
  const pb::MasterDatagram whole = sample_message();
  // The pose again, number by number, ahead of the rest: key 0x51 = field 10, 64-bit.
  std::string payload;
  for (const double v : whole.command_pose()) {
    const auto bits = std::bit_cast<std::uint64_t>(v);
    payload += '\x51';
    for (int i = 0; i < 8; ++i) payload += static_cast<char>(bits >> (8 * i));
  }
  pb::MasterDatagram rest = whole;
  rest.clear_command_pose();
  payload += rest.SerializeAsString();
  Codec codec;
  DatagramHeader header;
  MasterState state;
  ASSERT_EQ(codec.decode(framed(payload), header, state), Reject::kNone);
  EXPECT_TRUE(same(state, sample_master()));
}

TEST(Codec, ReasonCodesOutOfRangeAreRefused) {
  const auto bytes = datagram(sample_header(), sample_slave());
  pb::SlaveDatagram message;
  ASSERT_TRUE(message.ParseFromArray(bytes.data() + kFrameBytes,
                                     static_cast<int>(bytes.size() - kFrameBytes)));
  Codec codec;
  DatagramHeader header;
  SlaveState state;
  for (const std::uint32_t code : {static_cast<std::uint32_t>(Reason::kCount), 256u, UINT32_MAX}) {
    message.set_reason(code);
    EXPECT_EQ(
        codec.decode(framed(message.SerializeAsString(), DatagramKind::kSlave), header, state),
        Reject::kEnum);
  }
}

TEST(Codec, StageReasonsJointsAndReasonBitsThatAreNoCodesAreRefused) {
  const auto bytes = datagram(sample_header(), sample_slave());
  pb::SlaveDatagram whole;
  ASSERT_TRUE(whole.ParseFromArray(bytes.data() + kFrameBytes,
                                   static_cast<int>(bytes.size() - kFrameBytes)));
  Codec codec;
  DatagramHeader header;
  SlaveState state;
  const auto cause = [&](const pb::SlaveDatagram& message) {
    return codec.decode(framed(message.SerializeAsString(), DatagramKind::kSlave), header, state);
  };
  ASSERT_EQ(cause(whole), Reject::kNone);
  for (int stage = 0; stage < FollowLedger::kStages; ++stage) {
    pb::SlaveDatagram message = whole;
    message.set_stage_reasons(static_cast<std::uint32_t>(Reason::kCount) << 8 * stage);
    EXPECT_EQ(cause(message), Reject::kEnum) << stage;
  }
  for (const std::uint32_t joint : {7u, 256u, UINT32_MAX}) {
    pb::SlaveDatagram message = whole;
    message.set_limiting_joint(joint);
    EXPECT_EQ(cause(message), Reject::kRange) << joint;
  }
  whole.set_stage_offsets(5, std::numeric_limits<float>::infinity());
  EXPECT_EQ(cause(whole), Reject::kNotFinite);
}

TEST(Codec, SurfacesAndMarksThatAreNoneAreRefused) {
  const auto bytes = datagram(sample_header(), sample_slave());
  pb::SlaveDatagram whole;
  ASSERT_TRUE(whole.ParseFromArray(bytes.data() + kFrameBytes,
                                   static_cast<int>(bytes.size() - kFrameBytes)));
  Codec codec;
  DatagramHeader header;
  SlaveState state;
  const auto cause = [&](std::initializer_list<std::uint32_t> surface) {
    pb::SlaveDatagram message = whole;
    message.clear_surface();
    for (const std::uint32_t word : surface) message.add_surface(word);
    return codec.decode(framed(message.SerializeAsString(), DatagramKind::kSlave), header, state);
  };
  EXPECT_EQ(cause({0x40004000, 250'000, 1000}), Reject::kNone);
  EXPECT_NEAR(state.surface.value().d, 0.25, 1e-15);
  EXPECT_EQ(cause({0x80008000, 250'000, 1000}), Reject::kNone);
  EXPECT_NEAR(state.surface.value().n_S.norm(), 1.0, 1e-15);
  EXPECT_EQ(cause({0, 0, 0}), Reject::kNone);
  EXPECT_FALSE(state.surface);
  EXPECT_EQ(cause({1, 0, 0}), Reject::kSurface);
  EXPECT_EQ(cause({0, 1, 0}), Reject::kSurface);
  EXPECT_EQ(cause({0, 9'990'000, 100}), Reject::kNone);
  EXPECT_EQ(cause({0, 9'990'001, 100}), Reject::kSurface);
  EXPECT_EQ(cause({0, static_cast<std::uint32_t>(-9'990'001), 100}), Reject::kSurface);
  EXPECT_EQ(cause({0, 0x80000000, 100}), Reject::kSurface);
  EXPECT_EQ(cause({0, 0, 99}), Reject::kSurface);
  EXPECT_EQ(cause({0, 0, 10'000'001}), Reject::kSurface);
  EXPECT_EQ(cause({0, 0, UINT32_MAX}), Reject::kSurface);
  EXPECT_EQ(cause({0, 0}), Reject::kMissingField);
  EXPECT_EQ(cause({0, 0, 1000, 0}), Reject::kMissingField);
  whole.set_marks(16);
  EXPECT_EQ(cause({0, 0, 0}), Reject::kRange);
}

TEST(Codec, MoreThanAHundredOfAHundredAreRefused) {
  DatagramHeader header = sample_header();
  header.received_of_100 = 1;  // of a sender nothing came from
  EXPECT_EQ(encode_cause(header, sample_master()), Reject::kHeader);
  header.echo_session = header.echo_sequence = 1;
  header.received_of_100 = 100;
  EXPECT_EQ(encode_cause(header, sample_master()), Reject::kNone);
  header.received_of_100 = 101;
  EXPECT_EQ(encode_cause(header, sample_master()), Reject::kHeader);
}

TEST(Codec, HeadersThatCannotBeTrueAreRefusedBothWays) {
  const MasterState state = sample_master();
  DatagramHeader header = sample_header(0, 1);
  EXPECT_EQ(encode_cause(header, state), Reject::kHeader);
  header = sample_header(1, 0);
  EXPECT_EQ(encode_cause(header, state), Reject::kHeader);
  header = sample_header();
  header.sent = -1;
  EXPECT_EQ(encode_cause(header, state), Reject::kHeader);
  header = sample_header();
  header.echo_sequence = 1;
  EXPECT_EQ(encode_cause(header, state), Reject::kHeader);

  pb::MasterDatagram message = sample_message();
  message.set_session(0);
  EXPECT_EQ(decode(message), Reject::kHeader);
  message = sample_message();
  message.set_sequence(0);
  EXPECT_EQ(decode(message), Reject::kHeader);
  message = sample_message();
  message.set_echo_held_ns(-1);
  EXPECT_EQ(decode(message), Reject::kHeader);
}

TEST(Codec, ANonFiniteNumberIsRefused) {
  for (int i = 0; i < 7; ++i) {
    pb::MasterDatagram message = sample_message();
    message.set_command_pose(i, std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(decode(message), Reject::kNotFinite) << i;
  }
}

TEST(Codec, ASlightlyOffQuaternionIsNormalisedAndAnotherRefused) {
  Codec codec;
  DatagramHeader header;
  MasterState state;
  pb::MasterDatagram message = sample_message();
  message.set_command_pose(3, 0.5 + 2e-7);
  ASSERT_EQ(codec.decode(framed(message.SerializeAsString()), header, state), Reject::kNone);
  EXPECT_NEAR(state.X_SU.q.squaredNorm(), 1.0, 1e-15);
  message.set_command_pose(3, 0.5 + 2e-6);
  EXPECT_EQ(decode(message), Reject::kRotation);
}

TEST(Codec, SceneNamesThatDoNotFitAreRefused) {
  pb::MasterDatagram message = sample_message();
  message.set_scene(std::string(47, 'x'));
  EXPECT_EQ(decode(message), Reject::kNone);
  message.set_scene(std::string(48, 'x'));
  EXPECT_EQ(decode(message), Reject::kScene);
  message.set_scene(std::string("a\0b", 3));
  EXPECT_EQ(decode(message), Reject::kScene);
}

}  // namespace
}  // namespace handrail
