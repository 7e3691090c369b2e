// Packets are read as they are, and changed so that their checksums stay as they were.
#include "tests/emulator/ip_packet.h"

#include <gtest/gtest.h>

#include "server/base/random.h"
#include "tests/unit/emulator/packet_samples.h"

namespace handrail::emulator {
namespace {

// RFC 1071's example: the words 0001 f203 f4f5 f6f7 add up to ddf2. As a UDP payload between
// 0.0.0.0-like ends it is checked by hand: see below.
TEST(IpPacketTest, MakesTheChecksumsThatAreKnown) {
  // IPv4 header checksum by hand: 4500 0024 0000 4000 4011 + 0a4d 0001 0a4d 0002, inverted.
  const Bytes packet = make_udp(at("10.77.0.1:1"), at("10.77.0.2:2"),
                                Bytes{0x00, 0x01, 0xf2, 0x03, 0xf4, 0xf5, 0xf6, 0xf7});
  ASSERT_EQ(packet.size(), 36u);
  EXPECT_EQ(packet[10] << 8 | packet[11], 0x262d);
  // Payload ddf2, header 0001 + 0002 + 0010, pseudo header 0a4d + 0001 + 0a4d + 0002 + 0011 + 0010.
  EXPECT_EQ(packet[26] << 8 | packet[27], 0x0d3c);
}

TEST(IpPacketTest, FindsEndsAndPayloadOfBothVersions) {
  for (const bool is_6 : {false, true}) {
    const Bytes packet = make_udp(near_end(is_6), far_end(is_6), Bytes(100, 7));
    const auto layout = layout_of(packet);
    ASSERT_TRUE(layout.has_value());
    EXPECT_EQ(source_of(packet, *layout), near_end(is_6));
    EXPECT_EQ(destination_of(packet, *layout), far_end(is_6));
    EXPECT_EQ(packet.size() - layout->body, 100u);
    EXPECT_FALSE(layout->fragment);
    EXPECT_TRUE(is_sound(packet, *layout));
  }
}

TEST(IpPacketTest, RefusesWhatIsNoWholePacket) {
  Bytes packet = make_udp(near_end(false), far_end(false), Bytes(10, 7));
  EXPECT_FALSE(layout_of({}).has_value());
  for (std::size_t size = 1; size < packet.size(); ++size) {
    EXPECT_FALSE(layout_of(std::span(packet).first(size)).has_value()) << size;
  }
  packet.push_back(0);
  EXPECT_FALSE(layout_of(packet).has_value());
  packet.pop_back();
  packet[0] = 0x55;
  EXPECT_FALSE(layout_of(packet).has_value());
}

// Programs may send what they like; the sanitizers look on.
TEST(IpPacketTest, AnyBytesAreRefusedOrReadWithinTheirEnds) {
  Random random(1);
  int read = 0;
  for (int i = 0; i < 200'000; ++i) {
    Bytes packet(random.bits() % 80);
    for (std::uint8_t& byte : packet) byte = static_cast<std::uint8_t>(random.bits());
    // Such as may pass for a packet: version, length, protocol.
    if (packet.size() >= 40) {
      const bool is_6 = i % 2 == 0;
      packet[0] = static_cast<std::uint8_t>(is_6 ? 0x60 : 0x40 + random.bits() % 16);
      packet[2] = packet[4] = 0;
      packet[3] = static_cast<std::uint8_t>(packet.size());
      packet[5] = static_cast<std::uint8_t>(packet.size() - 40);
      constexpr std::uint8_t kProtocols[] = {kIcmp, kTcp, kUdp, kIcmp6, 44};
      packet[is_6 ? 6 : 9] = kProtocols[random.bits() % 5];
    }
    const auto layout = layout_of(packet);
    if (!layout) continue;
    ++read;
    ASSERT_LE(layout->body, packet.size());
    (void)is_sound(packet, *layout);
    Endpoint from = source_of(packet, *layout), to = destination_of(packet, *layout);
    set_source(packet, *layout, to);
    set_destination(packet, *layout, from);
    ASSERT_EQ(source_of(packet, *layout), to);
    repair(packet, *layout);
  }
  EXPECT_GT(read, 50'000);
}

TEST(IpPacketTest, AnyBitThatIsTurnedMakesItUnsoundUntilItIsRepaired) {
  for (const bool is_6 : {false, true}) {
    for (const std::size_t size : {1u, 2u, 33u, 548u}) {
      Bytes packet = make_udp(near_end(is_6), far_end(is_6), Bytes(size, 0xa5));
      const auto layout = layout_of(packet);
      ASSERT_TRUE(layout.has_value());
      Random random(size);
      for (int i = 0; i < 50; ++i) {
        packet[layout->body + random.bits() % size] ^= static_cast<std::uint8_t>(1u << i % 8);
        EXPECT_FALSE(is_sound(packet, *layout));
        repair(packet, *layout);
        EXPECT_TRUE(is_sound(packet, *layout));
      }
    }
  }
}

TEST(IpPacketTest, OtherEndsKeepRightChecksumsRightAndWrongOnesWrong) {
  for (const bool is_6 : {false, true}) {
    Random random(3);
    for (int i = 0; i < 2000; ++i) {
      Bytes packet = make_udp(near_end(is_6), far_end(is_6), Bytes(random.bits() % 64, 0xff));
      const auto layout = layout_of(packet);
      ASSERT_TRUE(layout.has_value());
      Endpoint other = far_end(is_6);
      for (std::size_t k = 0; k < other.address.size; ++k) {
        other.address.bytes[k] = static_cast<std::uint8_t>(random.bits());
      }
      other.port = static_cast<std::uint16_t>(random.bits());
      set_source(packet, *layout, other);
      EXPECT_EQ(source_of(packet, *layout), other);
      ASSERT_TRUE(is_sound(packet, *layout)) << i;
      packet[layout->transport + 7] ^= 1;
      set_destination(packet, *layout, other);
      EXPECT_EQ(destination_of(packet, *layout), other);
      ASSERT_FALSE(is_sound(packet, *layout)) << i;
    }
  }
}

TEST(IpPacketTest, AUdpPacketWithoutAChecksumKeepsNone) {
  Bytes packet = make_udp(near_end(false), far_end(false), Bytes(10, 7));
  const auto layout = layout_of(packet);
  ASSERT_TRUE(layout.has_value());
  packet[layout->transport + 6] = packet[layout->transport + 7] = 0;
  EXPECT_TRUE(is_sound(packet, *layout));
  set_source(packet, *layout, far_end(false));
  repair(packet, *layout);
  EXPECT_EQ(packet[layout->transport + 6] << 8 | packet[layout->transport + 7], 0);
}

// 0 would say that there is none.
TEST(IpPacketTest, AChecksumThatComesOutAsZeroIsSentAsAllOnes) {
  const auto payload = [](int i) {
    return Bytes{static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i)};
  };
  int all_ones = 0;
  for (int i = 0; i <= 0xffff; ++i) {
    const Bytes packet = make_udp(near_end(false), far_end(false), payload(i));
    ASSERT_NE(packet[26] << 8 | packet[27], 0);
    all_ones += (packet[26] << 8 | packet[27]) == 0xffff;
  }
  EXPECT_GE(all_ones, 1);
}

TEST(IpPacketTest, ATcpSegmentIsRepairedToo) {
  Bytes packet = tcp_segment(40);
  const auto layout = layout_of(packet);
  ASSERT_TRUE(layout.has_value());
  EXPECT_EQ(packet.size() - layout->body, 40u);
  EXPECT_TRUE(is_sound(packet, *layout));
  packet.back() ^= 0x10;
  EXPECT_FALSE(is_sound(packet, *layout));
  repair(packet, *layout);
  EXPECT_TRUE(is_sound(packet, *layout));
}

TEST(IpPacketTest, FragmentsHaveNoPayloadToChange) {
  Bytes first = make_udp(near_end(false), far_end(false), Bytes(64, 7));
  first[6] = 0x20;  // more follow
  auto layout = layout_of(first);
  ASSERT_TRUE(layout.has_value());
  EXPECT_TRUE(layout->fragment);
  EXPECT_TRUE(layout->has_ports());
  EXPECT_EQ(layout->body, first.size());
  first[7] = 8;  // and it begins at byte 64
  layout = layout_of(first);
  ASSERT_TRUE(layout.has_value());
  EXPECT_FALSE(layout->has_ports());
  EXPECT_EQ(source_of(first, *layout).port, 0);
}

TEST(IpPacketTest, ReadsAndWritesAddressesAsPeopleDo) {
  EXPECT_EQ(text(at("10.77.0.1:5000").address), "10.77.0.1");
  EXPECT_EQ(text(at("[fd77::2]:5000").address), "fd77::2");
  EXPECT_EQ(at("[fd77::2]:65535").port, 65535);
  for (const char* wrong : {"", "10.77.0.1", "10.77.0.1:", "10.77.0:1", "fd77::2:5000",
                            "[10.77.0.1]:5000", "10.77.0.1:65536", "10.77.0.1:1x", "[]:1"}) {
    const auto read = read_endpoint(wrong);
    EXPECT_FALSE(read.is_ok()) << wrong;
    EXPECT_NE(read.message().find("expected address and port"), std::string::npos);
  }
}

TEST(IpPacketTest, KnowsWhatNoRouterPassesOn) {
  for (const char* local :
       {"0.0.0.0", "224.0.0.22", "255.255.255.255", "169.254.1.1", "::", "ff02::16", "fe80::1"}) {
    EXPECT_TRUE(is_local(*read_address(local))) << local;
  }
  for (const char* routed : {"10.77.0.1", "192.0.2.1", "223.255.255.255", "fd77::1", "2001:db8::1"})
    EXPECT_FALSE(is_local(*read_address(routed))) << routed;
}

}  // namespace
}  // namespace handrail::emulator
