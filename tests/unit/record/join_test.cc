// Two sides' recordings as one, and a recording as a table.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "server/base/random.h"
#include "server/lab/replay/recording_csv.h"
#include "server/lab/replay/recording_join.h"
#include "server/record/mcap/mcap_reader.h"
#include "server/record/mcap/mcap_writer.h"
#include "server/record/record_feed.h"
#include "server/record/tick_io.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

// Messages, one file.
class Table {
 public:
  template <typename Message>
  void add(RecordChannel channel, Nanos calendar, const Message& message) {
    const auto time = static_cast<std::uint64_t>(calendar);
    bytes_.push_back(message.SerializeAsString());
    chunk_.add({static_cast<std::uint16_t>(channel), ++sequence_, time, time, bytes_.back()});
  }
  std::string file() {
    McapFile out(record_layout());
    std::string bytes = out.begin();
    const McapChunk closed = chunk_.close();
    out.add(closed);
    return bytes + closed.bytes + out.end();
  }

 private:
  McapChunkBuilder chunk_;
  std::vector<std::string> bytes_;
  std::uint32_t sequence_ = 0;
};

constexpr Nanos kMasterCalendar = 1000 * kSecond, kSlaveCalendar = 2000 * kSecond;

struct Pair {
  std::string master, slave;
};

// A second of both sides. The slave's clock is `ahead` of the master's; a way takes `there` or
// `back` and up to `jitter` more.
Pair pair_of(Nanos ahead, Nanos there, Nanos back, Nanos jitter, std::uint64_t seed,
             Nanos slave_later = 0, bool master_hears = true) {
  Random random(seed);
  const auto late = [&] {
    return static_cast<Nanos>(random.uniform() * static_cast<double>(jitter));
  };
  Table master, slave;
  pb::RecordedStart start;
  start.mutable_device();
  start.set_monotonic_ns(0);
  start.set_calendar_ns(kMasterCalendar);
  master.add(RecordChannel::kStart, kMasterCalendar, start);
  pb::RecordedStart other;
  other.mutable_arm();
  other.set_monotonic_ns(0);
  other.set_calendar_ns(kSlaveCalendar);
  slave.add(RecordChannel::kStart, kSlaveCalendar, other);
  for (int i = 1; i <= 1000; ++i) {
    const Nanos now = i * kMillisecond;  // by the master's clock
    const Nanos way_there = there + late(), way_back = back + late();
    KeptTick tick;
    tick.number = static_cast<std::uint64_t>(i);
    tick.at = now;
    tick.given.dt = 1e-3;
    tick.given.in.hand.X_MH.p.x() = 1e-3 * i;
    tick.timing = {now, now - way_back + ahead, way_there + way_back};
    if (!master_hears) tick.timing = {};
    pb::RecordedTick message;
    put(tick, message);
    master.add(RecordChannel::kTick, kMasterCalendar + now, message);
    KeptCycle cycle;
    cycle.number = tick.number;
    cycle.at = now + ahead + slave_later;
    cycle.timing = {cycle.at, now + slave_later - way_there, way_there + way_back};
    pb::RecordedCycle text;
    put(cycle, text);
    slave.add(RecordChannel::kCycle, kSlaveCalendar + cycle.at, text);
  }
  return {master.file(), slave.file()};
}

Result<RecordingJoin> joined(const Pair& both, const std::string& path = "", bool turned = false) {
  std::istringstream a(turned ? both.slave : both.master), b(turned ? both.master : both.slave);
  return join_recordings(a, b, path);
}

TEST(RecordingJoin, OnASymmetricLinkTheOffsetIsRightToATenthOfTheRoundTrip) {
  for (const Nanos way : {kMillisecond / 10, 25 * kMillisecond, 250 * kMillisecond}) {
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
      for (const bool turned : {false, true}) {
        const Nanos ahead = static_cast<Nanos>(Random(seed).bits() >> 20);
        const auto result = joined(pair_of(ahead, way, way, way, seed), "", turned);
        ASSERT_TRUE(result) << result.message();
        EXPECT_LT(std::abs(result->offset - ahead), 2 * way / 10) << way << ", seed " << seed;
        EXPECT_EQ(result->measures, 2000u);
        EXPECT_NEAR(to_seconds(result->both), 1.0, 0.01);
      }
    }
  }
}

TEST(RecordingJoin, WhateverTheWaysAreLikeItIsRightToItsBound) {
  for (const auto& [there, back] : {std::pair(1, 100), std::pair(100, 1), std::pair(0, 40)}) {
    const Nanos ahead = -5 * kSecond;
    const auto result =
        joined(pair_of(ahead, there * kMillisecond, back * kMillisecond, kMillisecond, 9));
    ASSERT_TRUE(result) << result.message();
    EXPECT_LE(std::abs(result->offset - ahead), result->bound);
    EXPECT_LE(result->bound, (there + back + 2) * kMillisecond / 2);
  }
}

TEST(RecordingJoin, WhatTheSlaveMeasuredServesAsWell) {
  const Nanos ahead = 77 * kSecond;
  const auto result = joined(pair_of(ahead, kMillisecond, kMillisecond, 0, 7, 0, false));
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->measures, 1000u);
  EXPECT_EQ(result->offset, ahead);
}

TEST(RecordingJoin, BothStandInOneFileOnOneCalendar) {
  TempFolder folder;
  const std::string path = folder.path() + "/both.mcap";
  const Nanos ahead = 123 * kSecond;
  const auto result = joined(pair_of(ahead, kMillisecond, kMillisecond, 0, 7), path);
  ASSERT_TRUE(result) << result.message();
  EXPECT_EQ(result->messages, 2002u);
  std::ifstream in(path, std::ios::binary);
  McapReader reader(in);
  int ticks = 0, cycles = 0;
  std::uint64_t last_tick = 0;
  while (const auto message = reader.next()) {
    const std::string& topic = reader.layout().channels[message->channel - 1u].topic;
    if (topic == "/master/tick") {
      ++ticks;
      last_tick = message->log_time;
    } else if (topic == "/slave/cycle") {
      ++cycles;
      pb::RecordedCycle cycle;
      ASSERT_TRUE(
          cycle.ParseFromArray(message->data.data(), static_cast<int>(message->data.size())));
      EXPECT_EQ(message->log_time,
                static_cast<std::uint64_t>(kMasterCalendar + cycle.at_ns() - ahead));
    }
  }
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(ticks, 1000);
  EXPECT_EQ(cycles, 1000);
  EXPECT_EQ(last_tick, static_cast<std::uint64_t>(kMasterCalendar + kSecond));
  EXPECT_NE(joined(pair_of(0, 1, 1, 0, 7), path).message().find("File exists"), std::string::npos);
}

TEST(RecordingJoin, WhatDoesNotBelongTogetherIsSaid) {
  const Pair good = pair_of(0, kMillisecond, kMillisecond, 0, 7);
  EXPECT_NE(joined({good.master, good.master}).message().find("both are of a master"),
            std::string::npos);
  EXPECT_NE(joined({good.slave, good.slave}).message().find("both are of a slave"),
            std::string::npos);
  EXPECT_NE(joined({good.master, "x"}).message().find("the second file is no recording"),
            std::string::npos);
  const Pair apart = pair_of(0, kMillisecond, kMillisecond, 0, 7, 5 * kSecond);
  EXPECT_NE(joined(apart).message().find("of different times"), std::string::npos)
      << joined(apart).message();
}

TEST(RecordingCsv, HasARowATickAndAsManyASecondAsAreAskedFor) {
  const Pair both = pair_of(0, kMillisecond, kMillisecond, 0, 7);
  std::istringstream master(both.master);
  std::ostringstream table;
  const auto rows = write_recording_csv(master, table, 0.0);
  ASSERT_TRUE(rows) << rows.message();
  EXPECT_EQ(*rows, 1000u);
  std::istringstream lines(table.str());
  std::string head, first, second;
  std::getline(lines, head);
  std::getline(lines, first);
  std::getline(lines, second);
  EXPECT_TRUE(head.starts_with("t_s,state,hand_x_mm,"));
  EXPECT_TRUE(second.starts_with("0.001000,0,2,0,0,")) << second;
  EXPECT_EQ(std::count(head.begin(), head.end(), ','), std::count(first.begin(), first.end(), ','));
  std::istringstream again(both.slave);
  std::ostringstream thin;
  EXPECT_NEAR(static_cast<double>(*write_recording_csv(again, thin, 141.0)), 141.0, 1.0);
  const std::string thinned = thin.str();
  const auto end = thinned.find('\n');
  EXPECT_EQ(std::count(thinned.begin(), thinned.begin() + static_cast<std::ptrdiff_t>(end), ','),
            19);
  std::istringstream nothing("x");
  EXPECT_FALSE(write_recording_csv(nothing, thin, 0.0));
}

}  // namespace
}  // namespace handrail
