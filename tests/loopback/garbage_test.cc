// Strangers' bytes on every socket and port of the three programs, some of which pass all checks
// but one.
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cmath>
#include <map>
#include <random>
#include <utility>
// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "devices/melfa/mxt_packet.h"
#include "server/base/length_prefix.h"
#include "tests/loopback/whole_cell.h"
#include "tests/support/bad_datagrams.h"

namespace handrail {
namespace {

namespace asio = boost::asio;
using Bytes = std::vector<std::uint8_t>;

class Sender {
 public:
  // From `port`; 0: any free one.
  explicit Sender(int port = 0)
      : socket_(io_, {asio::ip::make_address("127.0.0.1"), static_cast<unsigned short>(port)}) {}
  void send(int port, const Bytes& bytes) {
    socket_.send_to(asio::buffer(bytes),
                    {asio::ip::make_address("127.0.0.1"), static_cast<unsigned short>(port)});
    sleep_until(monotonic_now() + 200 * kMicrosecond);
  }

 private:
  asio::io_context io_;
  asio::ip::udp::socket socket_;
};

class GarbageTest : public WholeCell {
 protected:
  GarbageTest() {
    header.session = 0x5eed;
    header.sequence = 1;
    header.sent = kSecond;
    to_slave =
        test::bad_datagrams<pb::MasterDatagram>(header, MasterState(), DatagramKind::kMaster);
    to_master = test::bad_datagrams<pb::SlaveDatagram>(header, SlaveState(), DatagramKind::kSlave);
  }

  Bytes noise() {
    Bytes out(dice() % 2000);
    for (auto& byte : out) byte = static_cast<std::uint8_t>(dice());
    return out;
  }

  DatagramHeader header;
  std::vector<test::BadDatagram> to_slave, to_master;
  std::mt19937_64 dice{7};
};

TEST_F(GarbageTest, EachDatagramFailsItsOwnCheckAndNoneIsLeftOut) {
  std::map<Reject, int> seen;
  Codec codec;
  DatagramHeader h;
  MasterState master_state;
  SlaveState slave_state;
  for (const auto& bad : to_slave) {
    EXPECT_EQ(codec.decode(bad.bytes, h, master_state), bad.cause) << describe(bad.cause);
    ++seen[bad.cause];
  }
  for (const auto& bad : to_master) {
    EXPECT_EQ(codec.decode(bad.bytes, h, slave_state), bad.cause) << describe(bad.cause);
    ++seen[bad.cause];
  }
  for (int i = 1; i <= static_cast<int>(Reject::kScene); ++i) {
    const auto cause = static_cast<Reject>(i);
    EXPECT_GT(seen[cause], 0) << describe(cause);
  }
}

TEST_F(GarbageTest, OnTheLinkItIsCountedAndChangesNothing) {
  order("engage: true");
  const pb::Status before = at_rest();
  Sender stranger;
  std::uint64_t sent = 0;
  for (int i = 0; i < 20; ++i) {
    for (const auto& bad : to_master) stranger.send(master_port, bad.bytes);
    for (const auto& bad : to_slave) stranger.send(slave_port, bad.bytes);
    stranger.send(master_port, noise());
    stranger.send(slave_port, noise());
    sent += to_master.size() + 1;
  }
  EXPECT_TRUE(eventually([&](const pb::Status& s) {
    return s.datagrams_rejected() >= before.datagrams_rejected() + sent;
  }));
  EXPECT_TRUE(reaches("engaged"));
  EXPECT_LT((mm(at_rest().slave_command()) - mm(before.slave_command())).norm(), 0.01);
  order("disengage: true");
  slave->send(SIGTERM);
  EXPECT_EQ(slave->finish(), 0);
  EXPECT_GE(slave->number_after("datagrams accepted, "), static_cast<int>(20 * to_slave.size()));
  // The master hears its slave's port alone: who has that gets to the other checks.
  const std::uint64_t rejected = status().datagrams_rejected();
  Sender slaves(slave_port);
  for (const auto& bad : to_master) slaves.send(master_port, bad.bytes);
  EXPECT_TRUE(eventually(
      [&](const pb::Status& s) { return s.datagrams_rejected() >= rejected + to_master.size(); }));
  EXPECT_EQ(ask("status: true").status().slave_state(), "off") << "as it said last";
  EXPECT_TRUE(master->running());
}

// A stranger who speaks the controller's and the sensor's protocol without a fault is served as a
// PC is. Anything else changes nothing.
TEST_F(GarbageTest, AtTheRigItStopsNeitherArmNorSensor) {
  order("engage: true");
  Sender stranger;
  for (int i = 0; i < 20; ++i) {
    for (const std::size_t size : {kMxtShort, kMxtLong}) {
      MxtPacket packet;
      packet.command = MxtCommand::kMove;
      packet.send_type = packet.type[0] = MxtType::kJoint;
      packet.block[0].set_real(0, std::nan(""));
      std::array<std::uint8_t, kMxtLong> buffer{};
      const auto move = encode_mxt(packet, size, buffer);
      stranger.send(robot_port, Bytes(move.begin(), move.end()));
      packet.command = static_cast<MxtCommand>(77);
      const auto other = encode_mxt(packet, size, buffer);
      stranger.send(robot_port, Bytes(other.begin(), other.end()));
      stranger.send(robot_port, Bytes(other.begin(), other.end() - 1));
    }
    stranger.send(robot_port, noise());
    stranger.send(sensor_port, noise());
    stranger.send(sensor_port, {0x12, 0x34, 0xff, 0xff, 0, 0, 0, 0});  // no command of RDT
    stranger.send(sensor_port, {0x12, 0x35, 0, 0, 0, 0, 0, 0});        // stop, with another header
  }
  const pb::Status after = at_rest();
  EXPECT_EQ(after.state(), "engaged");
  EXPECT_TRUE(after.has_contact_force());
  EXPECT_EQ(move_hand("0, 5, 0").state(), "engaged");
  EXPECT_TRUE(rig->running());
}

TEST_F(GarbageTest, OnTheOperatorsSocketItCostsItsSenderTheConnection) {
  const auto garbage = [&](const std::string& bytes) {
    const int end = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket().copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(::connect(end, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    (void)!::send(end, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    ::shutdown(end, SHUT_WR);
    char answer[256];
    while (::read(end, answer, sizeof answer) > 0) {
    }
    ::close(end);
  };
  order("engage: true");
  for (int i = 0; i < 50; ++i) {
    const Bytes bytes = noise();
    const std::string text(bytes.begin(), bytes.end());
    garbage(text);
    garbage(framed(text));                         // no protobuf message
    garbage(framed("\xa2\x01\x01\xff"));           // as: no UTF-8 name
    garbage(framed(text).substr(0, text.size()));  // not to its end
    garbage(std::string(4, '\xff'));               // longer than a frame may be
  }
  EXPECT_EQ(status().state(), "engaged");
  EXPECT_TRUE(master->running());
}

}  // namespace
}  // namespace handrail
