// What the controller did, read back from the file.
#include "devices/rig/tap.h"

#include <gtest/gtest.h>
#include <sys/fsuid.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/no_allocation.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/rig/controller_bench.h"

namespace handrail {
namespace {

using Bench = test::ControllerBench;

class TapTest : public ::testing::Test {
 protected:
  void cycle(Bench& bench, bool cable_out = false) {
    bench.tick();
    tap.add(bench.controller, bench.now, bench.now - kMxtPeriod + 300 * kMicrosecond, cable_out);
  }
  std::vector<TapRecord> records() const {
    const auto file = read_tap(path);
    EXPECT_TRUE(file) << file.message();
    return file ? file->records : std::vector<TapRecord>();
  }

  TempFolder folder;
  std::string path = folder.path() + "/rig.tap";
  Tap tap;
};

TEST_F(TapTest, TellsWhatTheControllerDidInEveryCycle) {
  ASSERT_TRUE(tap.open(path, kMxtPeriod));
  Bench bench;
  cycle(bench);
  bench.feed_null();
  cycle(bench);
  const JointVector q = Bench::start_with(0, 0.01).cast<float>().cast<double>();
  bench.feed_move(q);
  cycle(bench);
  cycle(bench, true);
  bench.feed_end();
  cycle(bench);
  bench.feed_null();
  cycle(bench);
  bench.feed_move(Bench::start_with(2, 0.5));  // J3 ends at 50 deg
  cycle(bench);

  const std::vector<TapRecord> r = records();
  ASSERT_EQ(r.size(), 7u);
  const std::uint16_t did[] = {
      0,          kTapSession | kTapOpened, kTapSession | kTapAccepted, kTapSession | kTapCableOut,
      kTapClosed, kTapSession | kTapOpened, kTapClosed | kTapAlarm};
  for (std::size_t i = 0; i < r.size(); ++i) {
    EXPECT_EQ(r[i].number, i + 1);
    EXPECT_EQ(r[i].did, did[i]) << i;
    EXPECT_EQ(r[i].at, r[0].at + static_cast<Nanos>(i) * kMxtPeriod);
    EXPECT_EQ(r[i].came, 300);
  }
  EXPECT_EQ(r[1].target[0], 0.0);
  for (std::size_t i = 2; i < r.size(); ++i) EXPECT_EQ(r[i].target[0], q[0]) << "held since";
  EXPECT_EQ(r[2].measured[0], 0.0) << "moves from the next cycle on";
  EXPECT_GT(r[3].measured[0], 0.0);
  EXPECT_EQ(r[6].alarm, static_cast<std::uint8_t>(AlarmKind::kJointRange));
  EXPECT_EQ(r[6].joint, 3);
  EXPECT_EQ(read_tap(path)->period, kMxtPeriod);
}

TEST_F(TapTest, CountsCommandsThatDidNotArrive) {
  ASSERT_TRUE(tap.open(path, kMxtPeriod));
  ControllerOptions options = Bench::quiet();
  options.drop_share = 1.0;
  Bench bench(options);
  cycle(bench);
  bench.feed_null();
  for (int i = 0; i < 3; ++i) bench.feed_move(Bench::start());
  cycle(bench);
  cycle(bench);
  EXPECT_EQ(records()[0].lost, 0);
  EXPECT_EQ(records()[1].lost, 3);
  EXPECT_EQ(records()[2].lost, 0);
}

TEST_F(TapTest, KeepsTheNewestWhenItIsFull) {
  ASSERT_TRUE(tap.open(path, kMxtPeriod));
  Bench bench;
  {
    const test::NoAllocation guard("Tap::add");
    for (std::uint32_t i = 0; i < Tap::kCapacity + 10; ++i) {
      tap.add(bench.controller, static_cast<Nanos>(i), 0, false);
    }
  }
  const std::vector<TapRecord> r = records();
  ASSERT_EQ(r.size(), Tap::kCapacity);
  EXPECT_EQ(r.front().number, 11u);
  EXPECT_EQ(r.back().number, Tap::kCapacity + 10u);
}

TEST_F(TapTest, ARecordThatIsNotWholeIsLeftOut) {
  ASSERT_TRUE(tap.open(path, kMxtPeriod));
  Bench bench;
  for (int i = 0; i < 3; ++i) cycle(bench);
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(sizeof(TapHeader) + sizeof(TapRecord) + offsetof(TapRecord, again));
  const std::uint64_t none = 0;
  file.write(reinterpret_cast<const char*>(&none), sizeof(none));
  file.close();
  const std::vector<TapRecord> r = records();
  ASSERT_EQ(r.size(), 2u);
  EXPECT_EQ(r[1].number, 3u);
}

TEST_F(TapTest, TakesThePlaceOfAnOlderTapWhichItsReaderKeeps) {
  ASSERT_TRUE(tap.open(path, kMxtPeriod));
  Bench bench;
  cycle(bench);
  std::ifstream reader(path, std::ios::binary);
  Tap next;
  ASSERT_TRUE(next.open(path, kMxtPeriod));
  EXPECT_TRUE(records().empty());
  cycle(bench);  // the old one's memory is still there
  TapRecord record;
  reader.seekg(sizeof(TapHeader));
  EXPECT_TRUE(reader.read(reinterpret_cast<char*>(&record), sizeof(record)));
  EXPECT_EQ(record.number, 1u);
}

TEST_F(TapTest, SaysWhichFileCannotBeMadeOrReadAndWhy) {
  const std::string nowhere = folder.path() + "/none/rig.tap";
  EXPECT_EQ(tap.open(nowhere, kMxtPeriod).message(),
            "tap: " + nowhere + ": No such file or directory");
  const std::string mine = folder.write("thesis.tex", "years of work");
  EXPECT_EQ(tap.open(mine, kMxtPeriod).message(),
            "tap: " + mine + ": exists and is no tap; expected a new file");
  std::ostringstream kept;
  kept << std::ifstream(mine).rdbuf();
  EXPECT_EQ(kept.str(), "years of work");
  EXPECT_FALSE(tap.is_open());
  EXPECT_EQ(read_tap(mine).message(), "tap: " + mine + ": no tap of a rig");
  EXPECT_EQ(read_tap(nowhere).message(), "tap: " + nowhere + ": No such file or directory");
}

TEST_F(TapTest, SaysWhyAnOlderTapStays) {
  ASSERT_TRUE(tap.open(path, kMxtPeriod));
  const auto allow = [this](int mode) {
    std::filesystem::permissions(folder.path(), static_cast<std::filesystem::perms>(mode));
  };
  allow(0555);
  const int self = ::setfsuid(65534);  // root may write there all the same
  Tap next;
  const Status status = next.open(path, kMxtPeriod);
  ::setfsuid(static_cast<uid_t>(self));
  allow(0700);
  EXPECT_EQ(status.message(),
            "tap: " + path + ": an older tap, which cannot be removed: Permission denied");
}

}  // namespace
}  // namespace handrail
