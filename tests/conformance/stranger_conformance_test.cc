// The drivers whose protocols prove nothing of who speaks: what others than the controller or the
// sensor send them, from another port or another address, is as if it had not been sent.
#include <gtest/gtest.h>

#include <future>
#include <vector>

#include <boost/asio.hpp>

#include "devices/melfa/melfa_robot.h"
#include "devices/net_ft/net_ft_sensor.h"
#include "server/base/clock.h"
#include "tests/support/mxt/mxt_golden.h"

namespace handrail {
namespace {

using boost::asio::ip::udp;
using Datagram = std::vector<std::uint8_t>;

// What a driver speaks to, and two others of this computer.
class Cell {
 public:
  std::uint16_t port() const { return peer_.local_endpoint().port(); }
  // Until the driver has said something.
  void listen() {
    Datagram bytes(256);
    peer_.receive_from(boost::asio::buffer(bytes), driver_);
  }
  void strangers_send(const Datagram& bytes) {
    for (udp::socket* from : {&other_port_, &other_address_}) {
      from->send_to(boost::asio::buffer(bytes), driver_);
    }
  }
  void peer_sends(const Datagram& bytes) { peer_.send_to(boost::asio::buffer(bytes), driver_); }

 private:
  static udp::endpoint at(const char* address, std::uint16_t port) {
    return {boost::asio::ip::make_address(address), port};
  }
  boost::asio::io_context io_;
  udp::socket peer_{io_, at("127.0.0.1", 0)};
  udp::socket other_port_{io_, at("127.0.0.1", 0)};
  udp::socket other_address_{io_, at("127.0.0.2", port())};
  udp::endpoint driver_;
};

Datagram record(std::uint32_t sequence, std::int32_t force) {
  RdtRecord r;
  r.rdt_sequence = sequence;
  r.counts = {force, 0, 0, 0, 0, 0};
  const auto bytes = encode_rdt(r);
  return {bytes.begin(), bytes.end()};
}

TEST(Strangers, OpenNoSessionWithTheRobotDriver) {
  for (const bool controller_too : {false, true}) {
    Cell cell;
    MelfaOptions options;
    options.port = cell.port();
    MelfaRobot robot(options);
    RobotReply reply;
    auto connected =
        std::async(std::launch::async, [&] { return robot.connect(kSecond, reply).is_ok(); });
    cell.listen();
    if (controller_too) cell.peer_sends(golden::reply_long());
    for (int i = 0; i < 8; ++i) cell.strangers_send(golden::reply_long_held());
    EXPECT_FALSE(connected.get());
    EXPECT_EQ(robot.counters().replies, controller_too ? 1u : 0u);
    EXPECT_EQ(robot.counters().rejected, 0u);
  }
}

TEST(Strangers, GiveTheSensorDriverNoForce) {
  Cell cell;
  NetFtOptions options;
  options.port = cell.port();
  NetFtSensor sensor(options);
  ASSERT_TRUE(sensor.start());
  cell.listen();
  for (std::uint32_t i = 1; i <= 20; ++i) cell.strangers_send(record(i, 500'000'000));
  cell.peer_sends(record(7, 2'000'000));
  FtSample sample;
  const Nanos give_up = monotonic_now() + 20 * kSecond;
  while (!sensor.poll(monotonic_now(), sample) && monotonic_now() < give_up) {
  }
  EXPECT_EQ(sample.sequence, 7u);
  EXPECT_EQ(sample.wrench.force.x(), 2.0);
  EXPECT_EQ(sensor.counters().records, 1u);
  EXPECT_EQ(sensor.counters().stale + sensor.counters().rejected, 0u);
}

}  // namespace
}  // namespace handrail
