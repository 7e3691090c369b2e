// A replay finds what is not as recorded, and says where; and shows what something else would do.
#include "server/lab/replay/replay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "server/lab/replay/recording_csv.h"
#include "server/link/codec_fields.h"
#include "server/record/mcap/mcap_reader.h"
#include "server/record/mcap/mcap_writer.h"
#include "server/record/recording_repair.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/record/driven.h"

namespace handrail {
namespace {

// A recording in memory, message by message.
class InMemory : public RecordSink {
 public:
  struct Message {
    RecordChannel channel = RecordChannel::kStart;
    Nanos at = 0;
    std::string bytes;
  };
  void message(RecordChannel channel, Nanos at, std::string_view bytes) override {
    messages.push_back({channel, at, std::string(bytes)});
  }
  void beginning() override {}
  void happened(pb::RecordedEvent::Kind, Nanos, const std::string&) override {}
  void wanted(bool) override {}
  Nanos calendar(Nanos at) const override { return at; }

  std::string file() const {
    McapFile out(record_layout());
    std::string bytes = out.begin();
    McapChunkBuilder chunk;
    std::uint32_t sequence = 0;
    for (const Message& m : messages) {
      const auto time = static_cast<std::uint64_t>(m.at);
      chunk.add({static_cast<std::uint16_t>(m.channel), ++sequence, time, time, m.bytes});
    }
    const McapChunk closed = chunk.close();
    out.add(closed);
    return bytes + closed.bytes + out.end();
  }

  std::vector<Message> messages;
};

InMemory a_recording(int ticks, std::uint64_t seed = 11,
                     const std::string& scene = "linear-movement") {
  test::DrivenMaster master(seed, scene);
  InMemory out;
  pb::RecordedStart start = master.start();
  start.set_build(record_build());
  out.message(RecordChannel::kStart, 0, start.SerializeAsString());
  out.message(RecordChannel::kScene, 0, master.scenes().front().SerializeAsString());
  const auto feed = make_feed(master.tap());
  for (int i = 0; i < ticks; ++i) {
    master.tick();
    feed->pull(out);
  }
  return out;
}

Result<ReplayResult> replay_of(const InMemory& recording, const ReplayOptions& options = {}) {
  std::istringstream in(recording.file());
  return replay(in, options);
}

template <typename Change>
void change_start(InMemory& recording, Change change) {
  pb::RecordedStart start;
  ASSERT_TRUE(start.ParseFromString(recording.messages[0].bytes));
  change(start);
  recording.messages[0].bytes = start.SerializeAsString();
}

TEST(Replay, TheSameIsTheSame) {
  for (const std::uint64_t seed : {11u, 12u, 13u, 14u}) {
    const auto result = replay_of(a_recording(3000, seed));
    ASSERT_TRUE(result) << result.message();
    EXPECT_EQ(result->replayed, 3000u);
    EXPECT_EQ(result->different, 0u) << result->first->field;
    EXPECT_TRUE(result->same_build);
    EXPECT_GT(result->was.engaged, 0.5) << "something happened in it";
    EXPECT_GT(result->was.mean_force, 0.0);
    EXPECT_GT(result->was.way, 0.0);
  }
}

TEST(Replay, OneBitIsFoundAndNamed) {
  InMemory recording = a_recording(400);
  const auto tick = std::find_if(recording.messages.begin() + 200, recording.messages.end(),
                                 [](const auto& m) { return m.channel == RecordChannel::kTick; });
  pb::RecordedTick message;
  ASSERT_TRUE(message.ParseFromString(tick->bytes));
  const double was = message.wrench(1);
  message.set_wrench(1, std::nextafter(was, 10.0));
  tick->bytes = message.SerializeAsString();
  const auto result = replay_of(recording);
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->different, 1u);
  ASSERT_TRUE(result->first);
  EXPECT_EQ(result->first->number, message.number());
  EXPECT_NE(result->first->field.find("wrench[1]"), std::string::npos) << result->first->field;
  // Another build may differ by as much.
  change_start(recording, [](pb::RecordedStart& start) { start.set_build("another"); });
  const auto other = replay_of(recording);
  ASSERT_TRUE(other) << other.message();
  EXPECT_FALSE(other->same_build);
  EXPECT_EQ(other->different, 0u);
  EXPECT_EQ(other->replayed, 400u) << "it begins where the program began";
}

TEST(Replay, AnInputThatIsNotAsItWasMakesADifference) {
  InMemory recording = a_recording(600);
  int ticks = 0;
  for (auto& m : recording.messages) {
    if (m.channel != RecordChannel::kTick || ++ticks < 300 || ticks > 340) continue;
    pb::RecordedTick message;
    ASSERT_TRUE(message.ParseFromString(m.bytes));
    message.set_hand(0, message.hand(0) + 1e-3);
    m.bytes = message.SerializeAsString();
  }
  const auto result = replay_of(recording);
  ASSERT_TRUE(result) << result.message();
  EXPECT_GT(result->different, 0u);
}

TEST(Replay, AStepThatIsOnItsWayTakesNothingFromLaterImages) {
  InMemory recording = a_recording(6000, 31);  // the second image comes after five seconds
  int images = 0;
  for (auto& m : recording.messages) {
    if (m.channel != RecordChannel::kImage || ++images == 1) continue;
    pb::RecordedImage image;
    ASSERT_TRUE(image.ParseFromString(m.bytes));
    for (std::size_t i = 0; i < 4000; ++i) (*image.mutable_part(0))[i] = 0;
    m.bytes = image.SerializeAsString();
  }
  ASSERT_EQ(images, 2);
  const auto result = replay_of(recording);
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->replayed, 6000u);
  EXPECT_EQ(result->different, 0u);
}

TEST(Replay, WithoutABeginningNothingIsDoneAgain) {
  InMemory recording = a_recording(50);
  std::erase_if(recording.messages,
                [](const auto& m) { return m.channel == RecordChannel::kImage; });
  const auto result = replay_of(recording);
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->entries, 50u);
  EXPECT_EQ(result->replayed, 0u);
}

TEST(Replay, WhatIsNoRecordingIsSaid) {
  std::istringstream nothing("hello");
  EXPECT_NE(replay(nothing, {}).message().find("byte 0"), std::string::npos);
  InMemory recording = a_recording(5);
  InMemory headless = recording;
  headless.messages.erase(headless.messages.begin());
  EXPECT_NE(replay_of(headless).message().find("no message of channel /start"), std::string::npos);
  InMemory no_scene = recording;
  no_scene.messages.erase(no_scene.messages.begin() + 1);
  EXPECT_EQ(replay_of(no_scene).message(),
            "the recording does not have scene 1, which its ticks name");
  InMemory strange = recording;
  change_start(strange, [](pb::RecordedStart& start) { start.set_configuration("nonsense: 1"); });
  EXPECT_NE(replay_of(strange).message().find("none of a master"), std::string::npos);
  InMemory path = recording;
  pb::RecordedScene scene;
  ASSERT_TRUE(scene.ParseFromString(path.messages[1].bytes));
  scene.set_name("../../evil");
  path.messages[1].bytes = scene.SerializeAsString();
  EXPECT_NE(replay_of(path).message().find("expected letters"), std::string::npos);
  InMemory spoilt = recording;
  spoilt.messages.back().bytes = "\xff\xff";
  EXPECT_NE(replay_of(spoilt).message().find("no handrail.pb.RecordedTick"), std::string::npos);
}

TEST(Replay, WhatNoTickCanBeIsRefusedByItsName) {
  const auto with = [](auto change) {
    InMemory recording = a_recording(5);
    for (auto& m : recording.messages) {
      if (m.channel != RecordChannel::kTick) continue;
      pb::RecordedTick tick;
      EXPECT_TRUE(tick.ParseFromString(m.bytes));
      change(tick);
      m.bytes = tick.SerializeAsString();
      break;
    }
    return replay_of(recording).message();
  };
  EXPECT_NE(with([](pb::RecordedTick& t) { t.set_dt(1e300); }).find("expected over 0, to 1"),
            std::string::npos);
  pb::SlaveDatagram slave;
  put(SlaveState(), slave);
  slave.set_reason(250);
  EXPECT_NE(
      with([&](pb::RecordedTick& t) { *t.mutable_slave() = slave; }).find("slave is no state"),
      std::string::npos);
  InMemory weak = a_recording(5);
  change_start(weak, [](pb::RecordedStart& start) { start.mutable_device()->set_max_force(-1.0); });
  EXPECT_NE(replay_of(weak).message().find("device.max_force is -1"), std::string::npos);
  change_start(weak, [](pb::RecordedStart& start) {
    start.mutable_device()->set_max_force(0.0);
    start.mutable_device()->set_continuous_force(0.0);
  });
  EXPECT_TRUE(replay_of(weak)) << "a device that makes no force: " << replay_of(weak).message();
  change_start(weak, [](pb::RecordedStart& start) { start.mutable_device()->set_least_mass(0.0); });
  EXPECT_NE(replay_of(weak).message().find("device.least_mass is 0"), std::string::npos);
  change_start(weak, [](pb::RecordedStart& start) {
    start.mutable_device()->set_least_mass(0.05);
    start.mutable_device()->add_turning(1e-4);
  });
  EXPECT_NE(replay_of(weak).message().find("device.turning has 1 numbers, expected none or 5"),
            std::string::npos);
}

TEST(RecordedDevice, ComesBackWithWhatItDeclares) {
  for (const bool torque : {false, true}) {
    const HapticCapabilities device = omni_capabilities(torque);
    pb::RecordedDevice message;
    put(device, message);
    HapticCapabilities out;
    ASSERT_TRUE(take(message, out));
    EXPECT_EQ(out.dynamics.mass, device.dynamics.mass);
    EXPECT_EQ(out.dynamics.friction, device.dynamics.friction);
    EXPECT_EQ(out.turning.mass, device.turning.mass);
    EXPECT_EQ(out.turning.damping, device.turning.damping);
    EXPECT_EQ(out.turning.resolution, device.turning.resolution);
    EXPECT_EQ(out.turning.mass > 0.0, torque);
  }
}

TEST(Replay, AnotherGainShowsBothSideBySide) {
  const InMemory recording = a_recording(4000, 21);
  ReplayOptions options;
  options.overrides = {{"guidance.spring_n_mm", "0.01"}};
  const auto result = replay_of(recording, options);
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->replayed, 4000u);
  ASSERT_GT(result->was.most_force, 0.0);
  EXPECT_LT(result->is.mean_force, result->was.mean_force);
  options.overrides = {{"guidance.no_such_thing", "1"}};
  EXPECT_FALSE(replay_of(recording, options));
}

TEST(Replay, ARepairedFileHasAllThatWasSound) {
  TempFolder folder;
  const InMemory recording = a_recording(100);
  const std::string whole = recording.file();
  std::istringstream cut(whole.substr(0, whole.size() - 30));
  const std::string path = folder.path() + "/repaired.mcap";
  const auto repaired = repair_recording(cut, path);
  ASSERT_TRUE(repaired) << repaired.message();
  EXPECT_EQ(repaired->messages, recording.messages.size());
  const auto result = test::replay_file(path);
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->damage, "");
  EXPECT_EQ(result->replayed, 100u);
  std::istringstream again(whole);
  EXPECT_NE(repair_recording(again, path).message().find("File exists"), std::string::npos);
  std::istringstream nothing("x");
  EXPECT_FALSE(repair_recording(nothing, folder.path() + "/none.mcap"));
}

TEST(RecordFeed, WritesDatagramsDownBesideTheTicksAndTellsOfThoseThatWereLost) {
  test::DrivenMaster master(11, "linear-movement");
  InMemory out = a_recording(0);
  const auto packets = std::make_unique<PacketTap>();
  const auto feed = make_feed(master.tap(), {packets.get()});
  const std::array<std::uint8_t, 3> bytes{1, 0, 255};
  for (int i = 0; i < 100; ++i) {
    master.tick();
    packets->keep(PacketWay::kLinkOut, 5, bytes);
    feed->pull(out);
  }
  for (std::size_t i = 0; i < PacketTap::kRoom + 2; ++i)
    packets->keep(PacketWay::kRobotIn, 6, std::vector<std::uint8_t>(kMostPacket + 9));
  feed->pull(out);
  EXPECT_EQ(feed->lost(), 2u);
  int sent = 0, heard = 0;
  std::vector<std::string> lost;
  for (const InMemory::Message& m : out.messages) {
    pb::RecordedPacket packet;
    pb::RecordedEvent event;
    if (m.channel == RecordChannel::kPacket) {
      ASSERT_TRUE(packet.ParseFromString(m.bytes));
      const bool is_sent = packet.way() == pb::RecordedPacket::LINK_OUT;
      (is_sent ? sent : heard) += 1;
      EXPECT_EQ(m.at, is_sent ? 5 : 6);
      EXPECT_EQ(packet.at_ns(), m.at);
      EXPECT_EQ(packet.packet(),
                is_sent ? std::string("\1\0\377", 3) : std::string(kMostPacket, '\0'));
      EXPECT_EQ(packet.whole_bytes(), is_sent ? 0u : kMostPacket + 9);
    } else if (m.channel == RecordChannel::kEvent && event.ParseFromString(m.bytes)) {
      lost.push_back(event.text() + " " + std::to_string(event.count()));
    }
  }
  EXPECT_EQ(sent, 100);
  EXPECT_EQ(heard, static_cast<int>(PacketTap::kRoom));
  EXPECT_EQ(lost, std::vector<std::string>{"the recorder was behind: packets 2"});
  std::istringstream in(out.file());
  std::ostringstream table;
  const auto rows = write_packets_csv(in, table);
  ASSERT_TRUE(rows) << rows.message();
  EXPECT_EQ(*rows, 100 + PacketTap::kRoom);
  EXPECT_EQ(table.str().rfind("t_s,way,bytes,packet\n0.000000,link out,3,0100ff\n", 0), 0u);
  EXPECT_NE(table.str().find("\n0.000000,robot in,587,0000"), std::string::npos);
  std::istringstream without(a_recording(3).file());
  EXPECT_EQ(write_packets_csv(without, table).message(), "it holds no datagrams");
  // A replay does without them.
  const auto result = replay_of(out);
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->entries, 100u);
  EXPECT_EQ(result->different, 0u);
}

}  // namespace
}  // namespace handrail
