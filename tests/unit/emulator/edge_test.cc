// The edge translates both ways, forgets when it is told to or has nothing to do, and lets nobody
// else in.
#include "tests/emulator/edge.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/unit/emulator/packet_samples.h"

namespace handrail::emulator {
namespace {

constexpr Nanos kNow = kSecond;

// Who `packet` is from once it is outside; nothing passed: port 0.
Endpoint seen(Edge& edge, Bytes packet, Nanos now = kNow) {
  if (!edge.outward(packet, now)) return {};
  const auto layout = layout_of(packet);
  EXPECT_TRUE(layout && is_sound(packet, *layout));
  return source_of(packet, *layout);
}

// Whom a packet from `from` to `to` reaches inside; nobody: port 0.
Endpoint reached(Edge& edge, const Endpoint& from, const Endpoint& to, Nanos now = kNow) {
  Bytes packet = numbered(1, from, to);
  if (!edge.inward(packet, now)) return {};
  const auto layout = layout_of(packet);
  EXPECT_TRUE(layout && is_sound(packet, *layout));
  EXPECT_EQ(source_of(packet, *layout), from);
  return destination_of(packet, *layout);
}

class EdgeTest : public ::testing::TestWithParam<bool> {
 protected:
  Bytes out_packet() const { return numbered(1, near_end(GetParam()), far_end(GetParam())); }
  Endpoint near_ = near_end(GetParam()), far_ = far_end(GetParam());
  Edge edge_{1};
};

INSTANTIATE_TEST_SUITE_P(BothVersions, EdgeTest, ::testing::Values(false, true));

TEST_P(EdgeTest, WithoutAnythingToDoItChangesNothing) {
  Bytes packet = out_packet();
  const Bytes before = packet;
  EXPECT_TRUE(edge_.outward(packet, kNow));
  EXPECT_EQ(packet, before);
  EXPECT_EQ(reached(edge_, far_, near_), near_);
}

TEST_P(EdgeTest, RoamingShowsAnotherAddressAndTheOldOneIsNobodys) {
  edge_.roam();
  const Endpoint first = seen(edge_, out_packet());
  EXPECT_EQ(text(first.address), GetParam() ? "fd77:0:0:1::1" : "10.77.1.1");
  EXPECT_EQ(first.port, near_.port);
  EXPECT_EQ(reached(edge_, far_, first), near_);
  EXPECT_EQ(reached(edge_, far_, near_).port, 0);
  edge_.roam();
  EXPECT_FALSE(seen(edge_, out_packet()) == first);
  EXPECT_EQ(reached(edge_, far_, first).port, 0);
}

TEST_P(EdgeTest, NatShowsAnotherPortAndTranslatesTheWayBack) {
  edge_.settings.nat = true;
  const Endpoint outside = seen(edge_, out_packet());
  EXPECT_FALSE(outside.address == near_.address);
  EXPECT_GE(outside.port, 49152);
  EXPECT_EQ(seen(edge_, out_packet()), outside);
  EXPECT_EQ(reached(edge_, far_, outside), near_);
}

// RFC 4787: the same mapping for all whom it writes to.
TEST_P(EdgeTest, NatKeepsAPortForAllPeersAndOnePortForEachSocket) {
  edge_.settings.nat = true;
  Endpoint second_far = far_, second_near = near_;
  ++second_far.port;
  ++second_near.port;
  const Endpoint outside = seen(edge_, out_packet());
  EXPECT_EQ(seen(edge_, numbered(1, near_, second_far)), outside);
  const Endpoint other = seen(edge_, numbered(1, second_near, far_));
  EXPECT_NE(other.port, outside.port);
  EXPECT_EQ(reached(edge_, far_, other), second_near);
}

TEST_P(EdgeTest, NatLetsInOnlyWhomNearHasWrittenTo) {
  edge_.settings.nat = true;
  Endpoint stranger = far_, unused = near_;
  stranger.port = 1;
  const Endpoint outside = seen(edge_, out_packet());
  unused.address = outside.address;
  EXPECT_EQ(reached(edge_, stranger, outside).port, 0);
  EXPECT_EQ(reached(edge_, far_, unused).port, 0);
  EXPECT_EQ(reached(edge_, far_, near_).port, 0);
}

TEST_P(EdgeTest, RebindingChangesThePortAndKeepsTheAddress) {
  edge_.settings.nat = true;
  const Endpoint before = seen(edge_, out_packet());
  edge_.rebind();
  EXPECT_EQ(reached(edge_, far_, before).port, 0);
  const Endpoint after = seen(edge_, out_packet());
  EXPECT_EQ(after.address, before.address);
  EXPECT_NE(after.port, before.port);
  EXPECT_EQ(reached(edge_, far_, after), near_);
}

TEST_P(EdgeTest, AnIdlePortIsGivenUpAndWhatComesInDoesNotKeepIt) {
  edge_.settings = {.nat = true, .idle = 10 * kSecond};
  const Endpoint before = seen(edge_, out_packet(), kNow);
  EXPECT_EQ(seen(edge_, out_packet(), kNow + 10 * kSecond), before);
  EXPECT_EQ(reached(edge_, far_, before, kNow + 20 * kSecond), near_);
  EXPECT_EQ(reached(edge_, far_, before, kNow + 20 * kSecond + 1).port, 0);
  EXPECT_NE(seen(edge_, out_packet(), kNow + 20 * kSecond + 1).port, before.port);
}

TEST(EdgePortsTest, EveryPortIsAnothersAndThereIsAnEndToThem) {
  Edge edge(2);
  edge.settings.nat = true;
  std::set<std::uint16_t> ports;
  Endpoint from = near_end(false);
  for (std::uint16_t i = 0; i < 4096; ++i) {
    from.port = static_cast<std::uint16_t>(1 + i);
    ports.insert(seen(edge, numbered(1, from, far_end(false))).port);
  }
  EXPECT_EQ(ports.size(), 4096u);
  EXPECT_FALSE(ports.contains(0));
  from.port = 5000;
  EXPECT_EQ(seen(edge, numbered(1, from, far_end(false))).port, 0);
}

TEST(EdgePortsTest, FragmentsPassWithoutNatAlone) {
  Bytes fragment = numbered(1, near_end(false), far_end(false));
  fragment[7] = 8;  // begins at byte 64
  Edge edge(3);
  EXPECT_TRUE(edge.outward(fragment, kNow));
  edge.settings.nat = true;
  EXPECT_FALSE(edge.outward(fragment, kNow));
}

}  // namespace
}  // namespace handrail::emulator
