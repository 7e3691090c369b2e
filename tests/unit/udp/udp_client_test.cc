#include "devices/udp/udp_client.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <boost/asio.hpp>

#include "server/base/clock.h"

namespace handrail {
namespace {

using boost::asio::ip::udp;
using Bytes = std::vector<std::uint8_t>;

// The other end, on a free loopback port or on one given.
struct Peer {
  explicit Peer(std::uint16_t port = 0, const char* address = "127.0.0.1")
      : socket(io, udp::endpoint(boost::asio::ip::make_address(address), port)) {}

  std::uint16_t port() const { return socket.local_endpoint().port(); }
  Bytes receive() {
    Bytes bytes(100);
    bytes.resize(socket.receive_from(boost::asio::buffer(bytes), from));
    return bytes;
  }
  void reply(const Bytes& bytes) { socket.send_to(boost::asio::buffer(bytes), from); }

  boost::asio::io_context io;
  udp::socket socket;
  udp::endpoint from;
};

std::optional<Bytes> take(UdpClient& client, std::size_t room = 100) {
  Bytes bytes(room);
  const auto size = client.receive(bytes);
  if (!size) return std::nullopt;
  bytes.resize(*size);
  return bytes;
}

TEST(UdpClient, CarriesDatagramsBothWays) {
  Peer peer;
  UdpClient client;
  ASSERT_TRUE(client.open("127.0.0.1", peer.port(), 4096));
  EXPECT_EQ(take(client), std::nullopt);
  EXPECT_TRUE(client.send(Bytes{1, 2, 3}));
  EXPECT_EQ(peer.receive(), (Bytes{1, 2, 3}));
  peer.reply({4, 5});
  peer.reply({});
  peer.reply({6});
  client.wait(20 * kSecond);
  EXPECT_EQ(take(client), (Bytes{4, 5}));
  EXPECT_EQ(take(client), Bytes{});
  EXPECT_EQ(take(client), Bytes{6});
  EXPECT_EQ(take(client), std::nullopt);
}

TEST(UdpClient, CutsADatagramToTheRoomThereIs) {
  Peer peer;
  UdpClient client;
  ASSERT_TRUE(client.open("127.0.0.1", peer.port(), 4096));
  client.send(Bytes{1});
  peer.receive();
  peer.reply(Bytes(80, 7));
  client.wait(20 * kSecond);
  EXPECT_EQ(take(client, 65), Bytes(65, 7));
}

TEST(UdpClient, HearsNobodyButItsPeer) {
  Peer peer;
  Peer other_port, other_address(peer.port(), "127.0.0.2");
  UdpClient client;
  ASSERT_TRUE(client.open("127.0.0.1", peer.port(), 4096));
  client.send(Bytes{1});
  peer.receive();
  for (Peer* stranger : {&other_port, &other_address}) {
    stranger->from = peer.from;
    stranger->reply({66});
  }
  peer.reply({7});
  client.wait(20 * kSecond);
  EXPECT_EQ(take(client), Bytes{7});
  EXPECT_EQ(take(client), std::nullopt);
}

TEST(UdpClient, OutlivesAPeerThatIsNotThereYet) {
  std::uint16_t port = 0;
  { port = Peer().port(); }
  UdpClient client;
  ASSERT_TRUE(client.open("127.0.0.1", port, 4096));
  client.send(Bytes{1});
  EXPECT_EQ(take(client), std::nullopt) << "a refusal is no datagram";
  client.send(Bytes{2});
  Peer peer(port);
  // The refusal of the second datagram is still in the socket.
  EXPECT_TRUE(client.send(Bytes{3}));
  EXPECT_EQ(peer.receive(), Bytes{3});
  peer.reply({4});
  client.wait(20 * kSecond);
  EXPECT_EQ(take(client), Bytes{4});
}

TEST(UdpClient, IsQuietWhenClosed) {
  UdpClient client;
  EXPECT_FALSE(client.send(Bytes{1}));
  EXPECT_EQ(take(client), std::nullopt);
  client.wait(0);
  client.close();
}

TEST(UdpClient, NamesAnAddressThatIsNone) {
  UdpClient client;
  EXPECT_NE(client.open("here", 1, 4096).message().find("'here'"), std::string::npos);
  EXPECT_NE(client.open("127.0.0.1", 0, 4096).message().find("port 0"), std::string::npos);
}

struct Left {
  PacketWay way = PacketWay::kRobotIn;
  std::uint16_t size = 0;
  Bytes bytes;
  bool operator==(const Left&) const = default;
};

Left left_of(const KeptPacket& packet) {
  return {packet.way, packet.size, Bytes(packet.kept().begin(), packet.kept().end())};
}

TEST(UdpClient, LeavesWhatComesAndGoesInATap) {
  Peer peer;
  UdpClient client;
  const auto tap = std::make_unique<PacketTap>();
  client.keep(tap.get(), PacketWay::kSensorIn, PacketWay::kSensorOut);
  ASSERT_TRUE(client.open("127.0.0.1", peer.port(), 4096));
  const Nanos before = monotonic_now();
  ASSERT_TRUE(client.send(Bytes{1, 2, 3}));
  peer.receive();
  Bytes longest(kMostPacket + 1, 7);
  peer.reply({4, 5});
  peer.reply(longest);
  client.wait(20 * kSecond);
  EXPECT_EQ(take(client), (Bytes{4, 5}));
  EXPECT_EQ(take(client, 1000), longest);
  EXPECT_EQ(take(client), std::nullopt);
  KeptPacket packet;
  ASSERT_TRUE(tap->take(packet));
  EXPECT_EQ(left_of(packet), (Left{PacketWay::kSensorOut, 3, {1, 2, 3}}));
  EXPECT_GE(packet.at, before);
  EXPECT_LE(packet.at, monotonic_now());
  ASSERT_TRUE(tap->take(packet));
  EXPECT_EQ(left_of(packet), (Left{PacketWay::kSensorIn, 2, {4, 5}}));
  // Of a longer one what fits, and how long it was.
  ASSERT_TRUE(tap->take(packet));
  longest.pop_back();
  EXPECT_EQ(left_of(packet), (Left{PacketWay::kSensorIn, kMostPacket + 1, longest}));
  EXPECT_FALSE(tap->take(packet));
  // No more, once it is told so.
  client.keep(nullptr, PacketWay::kSensorIn, PacketWay::kSensorOut);
  ASSERT_TRUE(client.send(Bytes{8}));
  EXPECT_FALSE(tap->take(packet));
}

TEST(PacketTap, CountsWhatThereIsNoRoomFor) {
  const auto tap = std::make_unique<PacketTap>();
  for (std::size_t i = 0; i < PacketTap::kRoom + 3; ++i)
    tap->keep(PacketWay::kLinkIn, static_cast<Nanos>(i), Bytes{1});
  EXPECT_EQ(tap->lost(), 3u);
  KeptPacket packet;
  ASSERT_TRUE(tap->take(packet));
  EXPECT_EQ(packet.at, 0);
  tap->keep(PacketWay::kLinkOut, -1, Bytes{});
  EXPECT_EQ(tap->lost(), 3u);
}

}  // namespace
}  // namespace handrail
