// A recording that is looked into anywhere: what is sought is what is played, whole files are found
// by their index, and what is cut, spoilt or none at all says so.
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "server/base/random.h"
#include "server/lab/replay/recording_join.h"
#include "server/record/mcap/mcap_reader.h"
#include "server/record/mcap/mcap_writer.h"
#include "server/record/record_feed.h"
#include "server/record/recording_reader.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

std::string golden(const std::string& side) {
  return std::string(HANDRAIL_SOURCE_DIR) + "/tests/loopback/recording/golden/" + side + ".mcap";
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

std::string text_of(const RecordingMoment& moment) {
  return std::to_string(moment.calendar) + moment.tick.SerializeAsString() + "|" +
         moment.cycle.SerializeAsString();
}

// What a reader that takes the file in its order says of each entry: the truth, made another way.
std::vector<std::pair<Nanos, std::string>> in_order(const std::string& bytes) {
  std::istringstream in(bytes);
  McapReader reader(in);
  std::vector<std::pair<Nanos, std::string>> out;
  RecordingMoment now;
  std::optional<pb::SlaveDatagram> slave;
  std::optional<pb::MasterDatagram> master;
  std::uint64_t last = 0;
  while (const auto message = reader.next()) {
    const std::string topic = reader.layout().channels[message->channel - 1u].topic;
    const auto size = static_cast<int>(message->data.size());
    if (topic == "/image") {
      slave.reset();
      master.reset();
    }
    now.calendar = static_cast<Nanos>(message->log_time);
    if (topic == "/tick") {
      EXPECT_TRUE(now.tick.ParseFromArray(message->data.data(), size));
      if (now.tick.number() != last + 1) slave.reset();
      last = now.tick.number();
      if (now.tick.has_slave()) slave = now.tick.slave();
      if (!now.tick.slave_known()) slave.reset();
      if (slave) *now.tick.mutable_slave() = *slave;
    } else if (topic == "/cycle") {
      EXPECT_TRUE(now.cycle.ParseFromArray(message->data.data(), size));
      if (now.cycle.number() != last + 1) master.reset();
      last = now.cycle.number();
      if (now.cycle.has_master()) master = now.cycle.master();
      if (!now.cycle.master_known()) master.reset();
      if (master) *now.cycle.mutable_master() = *master;
    } else {
      continue;
    }
    out.emplace_back(now.calendar, text_of(now));
  }
  return out;
}

std::string at(RecordingReader& reader, Nanos time) {
  const auto moment = reader.at(time);
  return moment ? text_of(**moment) : moment.message();
}

std::unique_ptr<RecordingReader> opened(const std::string& path) {
  auto reader = RecordingReader::open(path);
  EXPECT_TRUE(reader) << reader.message();
  return reader ? std::move(*reader) : nullptr;
}

// Ticks of a master, `every` a chunk. The slave's state changes with every `changes`th tick, a
// number is left out before every `gap`th, and an image stands before every `image`th.
struct MadeFile {
  std::size_t ticks = 600, every = 7, changes = 50, gap = 0, image = 5000;
  std::string bytes(bool whole = true) const {
    McapFile file(record_layout());
    std::string out = file.begin();
    McapChunkBuilder chunk;
    std::uint32_t sequence = 0;
    const auto add = [&](RecordChannel channel, std::uint64_t time, const std::string& data) {
      chunk.add({static_cast<std::uint16_t>(channel), ++sequence, time, time, data});
    };
    const auto close = [&] {
      const McapChunk closed = chunk.close();
      file.add(closed);
      out += closed.bytes;
    };
    pb::RecordedStart start;
    start.set_program("handrail-master");
    add(RecordChannel::kStart, kBegin, start.SerializeAsString());
    close();
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < ticks; ++i) {
      const std::uint64_t time = kBegin + i * kMillisecond;
      if (i % image == 0) add(RecordChannel::kImage, time, "");
      number += gap != 0 && i % gap == gap - 1 ? 2 : 1;
      pb::RecordedTick tick;
      tick.set_number(number);
      tick.set_at_ns(static_cast<Nanos>(time));
      tick.set_slave_known(true);
      if (i % changes == 0) tick.mutable_slave()->set_sequence(i + 1);
      add(RecordChannel::kTick, time, tick.SerializeAsString());
      if (i % every == every - 1) close();
    }
    if (!chunk.empty()) close();
    return whole ? out + file.end() : out;
  }
  static constexpr std::uint64_t kBegin = 1'700'000'000'000'000'000;
};

TEST(RecordingReading, WhatIsSoughtIsWhatIsPlayedAndWhatStandsThere) {
  TempFolder folder;
  const std::vector<std::string> files = {
      golden("master"),
      golden("slave"),
      folder.write("even.mcap", MadeFile{}.bytes()),
      folder.write("rare.mcap", MadeFile{2000, 11, 700}.bytes()),
      folder.write("gaps.mcap", MadeFile{900, 13, 200, 90}.bytes()),
      folder.write("images.mcap", MadeFile{900, 13, 200, 0, 130}.bytes()),
      folder.write("steps.mcap", MadeFile{600, 5, 200, 11}.bytes()),
      folder.write("slave-cut.mcap", bytes_of(golden("slave")).substr(0, 150'000)),
      folder.write("none.mcap", MadeFile{900, 13, 100'000, 0}.bytes()),
      folder.write("cut.mcap", MadeFile{900, 13, 40}.bytes(false))};
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    const auto truth = in_order(bytes_of(file));
    ASSERT_GT(truth.size(), 200u);
    const auto played = opened(file), sought = opened(file);
    EXPECT_EQ(played->begins(), truth.front().first);
    EXPECT_EQ(played->ends(), truth.back().first);
    for (const auto& [time, text] : truth) ASSERT_EQ(at(*played, time), text) << time;
    Random random(7);
    for (int i = 0; i < 400; ++i) {
      const auto& [time, text] = truth[random.bits() % truth.size()];
      // Half a tick later it is still this one.
      ASSERT_EQ(at(*sought, time), text) << time;
      ASSERT_EQ(at(*sought, time + kMillisecond / 2), text) << time;
      ASSERT_EQ(at(*played, time), text) << time;
    }
    EXPECT_EQ(at(*sought, 0), truth.front().second);
    EXPECT_EQ(at(*sought, kForever), truth.back().second);
  }
}

TEST(RecordingReading, TheOtherSideIsNotKnownBeyondAGapNorForEver) {
  TempFolder folder;
  const auto slave_at = [](RecordingReader& reader, std::uint64_t tick) -> std::uint64_t {
    const auto moment = reader.at(static_cast<Nanos>(MadeFile::kBegin + tick * kMillisecond));
    return moment ? (*moment)->tick.slave().sequence() : 99999;
  };
  const auto gaps = opened(folder.write("g.mcap", MadeFile{400, 7, 100, 150}.bytes()));
  EXPECT_EQ(slave_at(*gaps, 148), 101u);
  EXPECT_EQ(slave_at(*gaps, 149), 0u) << "a number is missing before it";
  EXPECT_EQ(slave_at(*gaps, 199), 0u);
  EXPECT_EQ(slave_at(*gaps, 200), 201u);
  const auto rare =
      opened(folder.write("r.mcap", MadeFile{10'400, 100, 1'000'000, 0, 1'000'000}.bytes()));
  EXPECT_EQ(slave_at(*rare, 10'000), 1u);
  EXPECT_EQ(slave_at(*rare, 10'001), 0u);
  EXPECT_EQ(slave_at(*rare, 10'300), 0u);
  EXPECT_EQ(slave_at(*rare, 10'000), 1u) << "and not for having been asked for more";
}

TEST(RecordingReading, CutAnywhereItOpensUpToTheLastWholeChunk) {
  TempFolder folder;
  const std::string bytes = MadeFile{120, 6, 30}.bytes();
  std::size_t opens = 0;
  Random random(3);
  // Before that there is what the messages are like.
  constexpr std::size_t kData = 48'000;
  for (std::size_t cut = 0; cut < bytes.size();
       cut += cut < kData ? 4999 : 1 + random.bits() % 61) {
    SCOPED_TRACE(cut);
    const std::string path = folder.write("cut.mcap", bytes.substr(0, cut));
    const auto truth = in_order(bytes.substr(0, cut));
    const auto reader = RecordingReader::open(path);
    ASSERT_EQ(reader.is_ok(), !truth.empty()) << reader.message();
    if (!reader) {
      EXPECT_THAT(reader.message(), HasSubstr(path + ": "));
      continue;
    }
    ++opens;
    EXPECT_EQ((*reader)->ends(), truth.back().first);
    EXPECT_EQ(at(**reader, kForever), truth.back().second);
    EXPECT_THAT((*reader)->damage(), HasSubstr("byte "));
  }
  EXPECT_GT(opens, 100u);
}

TEST(RecordingReading, OfAByteThatHasChangedTheOthersAreFound) {
  TempFolder folder;
  const std::string whole = bytes_of(golden("master"));
  const auto truth = in_order(whole);
  std::size_t told = 0;
  Random random(5);
  const std::size_t index = whole.size() - whole.size() / 20;
  for (int i = 0; i < 120; ++i) {
    std::string bytes = whole;
    // Half of them in the index at the end.
    const std::size_t where =
        i % 2 == 0 ? random.bits() % bytes.size() : index + random.bits() % (bytes.size() - index);
    bytes[where] = static_cast<char>(bytes[where] ^ (1 << random.bits() % 8));
    SCOPED_TRACE(where);
    const std::string path = folder.write("flipped.mcap", bytes);
    const auto reader = RecordingReader::open(path);
    if (!reader) {
      EXPECT_THAT(reader.message(), HasSubstr(path + ": "));
      ++told;
      continue;
    }
    bool spoilt = !(*reader)->damage().empty();
    std::size_t right = 0;
    for (std::size_t k = 0; k < truth.size(); k += 20) {
      const auto moment = (*reader)->at(truth[k].first);
      if (!moment) {
        EXPECT_THAT(moment.message(), HasSubstr("byte "));
        spoilt = true;
      } else if (text_of(**moment) == truth[k].second) {
        ++right;
      } else {
        // Only the other side's state may be missing: never is it another moment. A file without
        // its end may end before.
        spoilt = true;
        const Nanos time = std::min(truth[k].first, (*reader)->ends());
        EXPECT_EQ((*moment)->calendar, time);
        EXPECT_TRUE(time != truth[k].first || !(*moment)->tick.has_slave());
      }
    }
    told += spoilt;
    if ((*reader)->damage().empty()) {
      EXPECT_GT(right, truth.size() / 20 / 2) << "of all others";
    }
  }
  EXPECT_GT(told, 80u) << "the rest stands in what nobody needs: an index of a channel, a name";
}

TEST(RecordingReading, WhatIsNoRecordingSaysWhatItIs) {
  TempFolder folder;
  McapFile other({"somebody", {{"a.B", "protobuf", ""}}, {{1, "/pose", "protobuf"}}});
  McapChunkBuilder chunk;
  chunk.add({1, 1, 5, 5, "x"});
  std::string foreign = other.begin();
  const McapChunk closed = chunk.close();
  other.add(closed);
  foreign += closed.bytes + other.end();
  std::string version = MadeFile{}.bytes();
  version[5] = '7';
  MadeFile empty;
  empty.ticks = 0;
  std::filesystem::create_directory(folder.path() + "/folder");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {folder.path() + "/none.mcap", "none.mcap: cannot be read: No such file"},
      {folder.path() + "/folder", "is no regular file"},
      {folder.write("empty", ""), "is empty, expected a recording"},
      {folder.write("text", "scene {}\n"),
       "byte 0: begins with 73 63 65 6e 65 20 7b 7d, expected 89"},
      {folder.write("short", "\x89M"), "byte 0: begins with 89 4d, expected 89 4d 43"},
      {folder.write("version", version), "byte 5: is MCAP of version '7', expected '0'"},
      {folder.write("foreign", foreign), "is an MCAP file of somebody else"},
      {folder.write("idle", empty.bytes()), "holds neither a tick nor a cycle"}};
  for (const auto& [path, said] : cases) {
    const auto reader = RecordingReader::open(path);
    ASSERT_FALSE(reader) << path;
    EXPECT_THAT(reader.message(), HasSubstr(path));
    EXPECT_THAT(reader.message(), HasSubstr(said));
  }
}

TEST(RecordingReading, AFileThatGoesMeanwhileIsReadOnAndOneThatIsCutSaysWhere) {
  TempFolder folder;
  const std::string path = folder.write("goes.mcap", MadeFile{}.bytes());
  const auto reader = opened(path);
  const auto truth = in_order(bytes_of(path));
  std::filesystem::rename(path, path + ".moved");
  EXPECT_EQ(at(*reader, truth[300].first), truth[300].second);
  // Its chunks lie in the midst, between two times the schemas.
  const auto half = static_cast<off_t>(std::filesystem::file_size(path + ".moved") / 2);
  ASSERT_EQ(::truncate((path + ".moved").c_str(), half), 0);
  EXPECT_THAT(at(*reader, truth[500].first), HasSubstr("the file ends here, and had "));
  std::filesystem::remove(path + ".moved");
  EXPECT_EQ(at(*reader, truth[2].first), truth[2].second) << "before the cut";
}

// Ten minutes of ten chunks a second: whole, what is read is the index and few chunks.
TEST(RecordingReading, OfALongFileLittleIsRead) {
  TempFolder folder;
  const std::string bytes = MadeFile{60'000, 10, 30}.bytes();
  const auto reader = opened(folder.write("long.mcap", bytes));
  EXPECT_EQ(reader->ends() - reader->begins(), 59'999 * kMillisecond);
  // A summary of 6000 chunks is a third of this file, whose ticks hold next to nothing.
  EXPECT_LT(reader->bytes_read(), bytes.size() / 2);
  const std::uint64_t before = reader->bytes_read();
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(
        reader->at(reader->begins() + static_cast<Nanos>(random.bits() % 59'999) * kMillisecond));
  }
  // Three chunks at most back to the slave's state, of under 600 bytes each.
  EXPECT_LT(reader->bytes_read() - before, 50u * 5 * 600);
}

TEST(RecordingReading, AFileOfBothSidesIsReadAsItsMasters) {
  TempFolder folder;
  const std::string both = folder.path() + "/both.mcap";
  std::ifstream slave(golden("slave"), std::ios::binary),
      master(golden("master"), std::ios::binary);
  ASSERT_TRUE(join_recordings(slave, master, both));
  const auto joined = opened(both), alone = opened(golden("master"));
  EXPECT_TRUE(joined->of_master());
  EXPECT_EQ(joined->begins(), alone->begins());
  EXPECT_EQ(joined->ends(), alone->ends());
  EXPECT_EQ(joined->events().size(), alone->events().size()) << "the slave's stop is the same one";
  for (Nanos t = alone->begins(); t < alone->ends(); t += 17 * kMillisecond) {
    ASSERT_EQ(at(*joined, t), at(*alone, t)) << t;
  }
}

TEST(RecordingReading, MarksStopsAndScenesAreKnownAtOnce) {
  const auto reader = opened(golden("master"));
  EXPECT_TRUE(reader->of_master());
  EXPECT_EQ(reader->start().program(), "handrail-master");
  const auto first = reader->at(0);
  ASSERT_TRUE(first);
  const auto scene = reader->scene((*first)->tick.scene());
  ASSERT_TRUE(scene) << scene.message();
  EXPECT_FALSE(scene->text().empty());
  const auto missing = reader->scene(4711);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.message(), HasSubstr("scene 4711"));
  EXPECT_EQ(reader->events_left_out(), 0u);
  EXPECT_TRUE(std::is_sorted(reader->events().begin(), reader->events().end(),
                             [](const auto& a, const auto& b) { return a.calendar < b.calendar; }));
  EXPECT_FALSE(opened(golden("slave"))->of_master());
}

}  // namespace
}  // namespace handrail
