#include "devices/udp/udp_table.h"

#include <gtest/gtest.h>

#include "devices/udp/udp_client.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

// As Linux 6.1 writes it on a little-endian computer: one waits for anybody, one is connected to
// 192.168.0.20:10000.
constexpr char kTable[] =
    "   sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout "
    "inode ref pointer drops\n"
    "  355: 0100007F:2710 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 "
    "4121 2 0000000000000000 0\n"
    " 1021: 0500A8C0:CF3A 1400A8C0:2710 01 00000000:00000000 00:00000000 00000000  1000        0 "
    "4122 2 0000000000000000 0\n";

TEST(UdpTable, OnlyAConnectedSocketToThatAddressAndPortCounts) {
  const TempFolder folder;
  const std::string table = folder.write("udp", kTable);
  EXPECT_TRUE(udp_speaks_with(table, "192.168.0.20", 10000));
  EXPECT_FALSE(udp_speaks_with(table, "192.168.0.20", 10001));
  EXPECT_FALSE(udp_speaks_with(table, "192.168.0.21", 10000));
  EXPECT_FALSE(udp_speaks_with(table, "127.0.0.1", 10000));    // waits there itself
  EXPECT_FALSE(udp_speaks_with(table, "192.168.0.5", 53050));  // its own end
  EXPECT_FALSE(udp_speaks_with(table, "robot", 10000));
  EXPECT_FALSE(udp_speaks_with(folder.path() + "/nothing", "192.168.0.20", 10000));
}

TEST(UdpTable, AClientOfOursStandsInTheKernelsWhileItIsOpen) {
  UdpClient client;
  EXPECT_FALSE(udp_speaks_with(kUdpTable, "127.87.65.43", 9));
  ASSERT_TRUE(client.open("127.87.65.43", 9, 4096));
  EXPECT_TRUE(udp_speaks_with(kUdpTable, "127.87.65.43", 9));
  client.close();
  EXPECT_FALSE(udp_speaks_with(kUdpTable, "127.87.65.43", 9));
}

}  // namespace
}  // namespace handrail
