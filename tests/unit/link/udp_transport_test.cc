#include "server/link/udp_transport.h"

#include <gtest/gtest.h>

#include "server/base/clock.h"
#include "server/link/pump.h"
#include "tests/unit/link/link_samples.h"

namespace handrail {
namespace {

using ::testing::Test;

class UdpTransportTest : public Test {
 protected:
  // Runs the io_context until `done` or ten seconds have passed.
  template <typename Condition>
  bool run_until(Condition done) {
    const Nanos give_up = monotonic_now() + 10 * kSecond;
    while (!done() && monotonic_now() < give_up) io.run_one_for(std::chrono::milliseconds(10));
    return done();
  }

  boost::asio::io_context io;
  UdpTransport slave{io};
  UdpTransport master{io};
};

TEST_F(UdpTransportTest, RefusesAddressesBeyondThisComputerAndSaysWhy) {
  for (const char* address : {"0.0.0.0", "192.168.1.2", "::", "8.8.8.8"}) {
    const Status own = slave.open({.address = address});
    ASSERT_FALSE(own) << address;
    EXPECT_NE(own.message().find(address), std::string::npos);
    EXPECT_NE(own.message().find("plain"), std::string::npos);
    const Status peer = master.open({.peer_address = address, .peer_port = 9});
    ASSERT_FALSE(peer) << address;
    EXPECT_NE(peer.message().find("plain"), std::string::npos);
  }
}

TEST_F(UdpTransportTest, RefusesWhatIsNoAddress) {
  const Status status = slave.open({.address = "localhost:1"});
  ASSERT_FALSE(status);
  EXPECT_EQ(status.message(),
            "link address 'localhost:1': expected an IP address, 127.0.0.1 or ::1");
  EXPECT_FALSE(master.open({.peer_address = "127.0.0.1", .peer_port = 0}));
  EXPECT_FALSE(master.open({.peer_address = "::1", .peer_port = 9}));
}

TEST_F(UdpTransportTest, APortInUseIsNamed) {
  ASSERT_TRUE(slave.open({}));
  const Status status = master.open({.port = slave.port()});
  ASSERT_FALSE(status);
  EXPECT_EQ(
      status.message(),
      "link port " + std::to_string(slave.port()) +
          " on 127.0.0.1 is in use, likely by a program like this one that still runs: end it, "
          "or set link_port to another");
  EXPECT_EQ(master.port(), 0);
  ASSERT_TRUE(master.open({}));  // usable afterwards
}

TEST_F(UdpTransportTest, TheSlaveLearnsItsPeerFromAnAcceptedDatagramOnly) {
  ASSERT_TRUE(slave.open({}));
  ASSERT_TRUE(master.open({.peer_address = "127.0.0.1", .peer_port = slave.port()}));
  const std::vector<std::uint8_t> bytes = {1, 2, 3};
  std::array<std::uint8_t, 16> buffer{};
  EXPECT_FALSE(slave.send(bytes));
  ASSERT_TRUE(master.send(bytes));
  std::optional<Transport::Arrival> arrival;
  ASSERT_TRUE(run_until([&] { return arrival || (arrival = slave.receive(buffer)); }));
  EXPECT_EQ(arrival->size, 3u);
  EXPECT_TRUE(arrival->from_peer);
  EXPECT_FALSE(slave.send(bytes));
  slave.adopt_sender();
  EXPECT_TRUE(slave.send(bytes));
}

TEST_F(UdpTransportTest, TheMasterHearsItsConfiguredPeerOnly) {
  UdpTransport stranger(io);
  ASSERT_TRUE(slave.open({}));
  ASSERT_TRUE(master.open({.peer_address = "127.0.0.1", .peer_port = slave.port()}));
  ASSERT_TRUE(stranger.open({.peer_address = "127.0.0.1", .peer_port = master.port()}));
  ASSERT_TRUE(stranger.send(std::vector<std::uint8_t>{9}));
  std::array<std::uint8_t, 16> buffer{};
  std::optional<Transport::Arrival> arrival;
  ASSERT_TRUE(run_until([&] { return arrival || (arrival = master.receive(buffer)); }));
  EXPECT_FALSE(arrival->from_peer);
  master.adopt_sender();  // changes nothing: the peer is configured
  ASSERT_TRUE(master.send(std::vector<std::uint8_t>{1, 2}));
  arrival.reset();
  ASSERT_TRUE(run_until([&] { return arrival || (arrival = slave.receive(buffer)); }));
  EXPECT_EQ(arrival->size, 2u);
}

TEST_F(UdpTransportTest, AnAnswerGoesToTheSenderAndLeavesThePeer) {
  UdpTransport stranger(io);
  ASSERT_TRUE(slave.open({}));
  EXPECT_EQ(slave.peer_port(), 0);
  ASSERT_TRUE(master.open({.peer_address = "127.0.0.1", .peer_port = slave.port()}));
  ASSERT_TRUE(stranger.open({.peer_address = "127.0.0.1", .peer_port = slave.port()}));
  std::array<std::uint8_t, 16> buffer{};
  std::optional<Transport::Arrival> arrival;
  const auto wait_at = [&](UdpTransport& end) {
    arrival.reset();
    return run_until([&] { return arrival || (arrival = end.receive(buffer)); });
  };
  ASSERT_TRUE(master.send(std::vector<std::uint8_t>{1}));
  ASSERT_TRUE(wait_at(slave));
  slave.adopt_sender();
  ASSERT_TRUE(stranger.send(std::vector<std::uint8_t>{1}));
  ASSERT_TRUE(wait_at(slave));
  ASSERT_TRUE(slave.answer(std::vector<std::uint8_t>{1, 2}));
  ASSERT_TRUE(wait_at(stranger));
  EXPECT_EQ(arrival->size, 2u);
  EXPECT_TRUE(arrival->from_peer);
  EXPECT_EQ(slave.peer_port(), master.port());
  ASSERT_TRUE(slave.send(std::vector<std::uint8_t>{1, 2, 3}));
  ASSERT_TRUE(wait_at(master));
  EXPECT_EQ(arrival->size, 3u);
}

TEST_F(UdpTransportTest, TwoPeersTalkOverLoopback) {
  ASSERT_TRUE(slave.open({}));
  ASSERT_TRUE(master.open({.peer_address = "127.0.0.1", .peer_port = slave.port()}));
  MasterPeer at_master(random_session_id());
  SlavePeer at_slave(random_session_id());
  LinkPump<MasterState, SlaveState> master_pump(master, at_master);
  LinkPump<SlaveState, MasterState> slave_pump(slave, at_slave);
  master.on_readable([&] { (void)master_pump.receive(monotonic_now()); });
  slave.on_readable([&] {
    (void)slave_pump.receive(monotonic_now());
    slave_pump.send(monotonic_now(), sample_slave());
  });
  EXPECT_TRUE(run_until([&] {
    const Nanos now = monotonic_now();
    master_pump.send(now, sample_master());
    return at_master.snapshot().round_trip >= 0;
  }));
  EXPECT_TRUE(same(at_slave.newest(), sample_master()));
  EXPECT_TRUE(same(at_master.newest(), sample_slave()));
}

}  // namespace
}  // namespace handrail
