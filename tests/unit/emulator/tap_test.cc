// A tap keeps every packet with its time, number and origin, in a file that pcap readers open.
#include "tests/emulator/tap.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temp_folder.h"
#include "tests/unit/emulator/packet_samples.h"

namespace handrail::emulator {
namespace {

std::string written(const TempFolder& folder) {
  std::string path = folder.path() + "/near.pcap";
  auto tap = Tap::open(path);
  EXPECT_TRUE(tap.is_ok()) << tap.message();
  tap->sent(Bytes{1, 2, 3}, 7, 5 * kSecond + 123);
  tap->delivered(Bytes(1500, 9), 0x0102030405060708, Origin::kCorrupt, 6 * kSecond);
  tap->delivered(Bytes{}, 0, Origin::kInjected, 7 * kSecond);
  EXPECT_TRUE(tap->close().is_ok());
  return path;
}

TEST(TapTest, ReadsBackWhatWasWritten) {
  const TempFolder folder;
  const auto records = read_tap(written(folder));
  ASSERT_TRUE(records.is_ok()) << records.message();
  ASSERT_EQ(records->size(), 3u);
  const TapRecord &first = (*records)[0], &second = (*records)[1], &third = (*records)[2];
  EXPECT_TRUE(first.sent);
  EXPECT_EQ(first.at, 5 * kSecond + 123);
  EXPECT_EQ(first.number, 7u);
  EXPECT_EQ(first.packet, (Bytes{1, 2, 3}));
  EXPECT_FALSE(second.sent);
  EXPECT_EQ(second.origin, Origin::kCorrupt);
  EXPECT_EQ(second.number, 0x0102030405060708u);
  EXPECT_EQ(second.packet, Bytes(1500, 9));
  EXPECT_EQ(third.origin, Origin::kInjected);
  EXPECT_TRUE(third.packet.empty());
}

// The format's own fields, so that other programs read it: magic, version, link type, lengths.
TEST(TapTest, IsAPcapFile) {
  const TempFolder folder;
  std::ifstream file(written(folder), std::ios::binary);
  const Bytes bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const Bytes start = {0x4d, 0x3c, 0xb2, 0xa1, 2,  0, 4,   0, 0,  0, 0, 0, 0,   0,
                       0,    0,    0,    0,    1,  0, 147, 0, 0,  0, 5, 0, 0,   0,
                       123,  0,    0,    0,    19, 0, 0,   0, 19, 0, 0, 0, 'S', 0};
  ASSERT_GT(bytes.size(), start.size());
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(start.size())), start);
  EXPECT_EQ(bytes.size(), 24u + 3 * 32 + 3 + 1500);
}

TEST(TapTest, KeepsTheBeginningOfPacketsWhereThatIsAskedAndHowLongTheyWere) {
  const TempFolder folder;
  const std::string path = folder.path() + "/short.pcap";
  auto tap = Tap::open(path, 10);
  ASSERT_TRUE(tap.is_ok());
  tap->sent(Bytes(600, 7), 1, 5);
  tap->sent(Bytes(4, 8), 2, 6);
  tap->flush();
  const auto running = read_tap(path);  // before it is closed
  ASSERT_TRUE(running.is_ok());
  EXPECT_EQ(running->size(), 2u);
  ASSERT_TRUE(tap->close().is_ok());
  EXPECT_EQ((*running)[0].packet, Bytes(10, 7));
  EXPECT_EQ((*running)[1].packet, Bytes(4, 8));
  std::ifstream file(path, std::ios::binary);
  file.seekg(24 + 8);
  Bytes lengths(8);
  file.read(reinterpret_cast<char*>(lengths.data()), 8);
  EXPECT_EQ(lengths, (Bytes{26, 0, 0, 0, 0x68, 2, 0, 0}));  // 16 + 10 kept of 16 + 600
}

TEST(TapTest, OneThatWasCutGivesWhatIsWhole) {
  const TempFolder folder;
  const std::string path = written(folder);
  std::filesystem::resize_file(path, 24 + 32 + 3 + 32 + 700);
  const auto records = read_tap(path);
  ASSERT_TRUE(records.is_ok());
  EXPECT_EQ(records->size(), 1u);
}

TEST(TapTest, OtherFilesAreRefusedByName) {
  const TempFolder folder;
  const std::string other = folder.write("other", std::string(100, 'x'));
  EXPECT_EQ(read_tap(other).message(), other + ": not a tap of the link emulator");
  EXPECT_EQ(read_tap("/nowhere/a").message(), "/nowhere/a: cannot read: No such file or directory");
  EXPECT_EQ(Tap::open("/nowhere/a").message(),
            "/nowhere/a: cannot write: No such file or directory");
}

TEST(TapTest, AFullDiskIsSaid) {
  auto tap = Tap::open("/dev/full");
  ASSERT_TRUE(tap.is_ok());
  tap->sent(Bytes(100, 1), 1, 0);
  EXPECT_EQ(tap->close().message(), "/dev/full: cannot write: No space left on device");
}

}  // namespace
}  // namespace handrail::emulator
