// The real master with a force sensor on its device's handle: one on the network, played by the
// test from what its manual says, and the simulated one.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cmath>
#include <thread>

#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

// A sensor of ATI: eight bytes ask for the stream, records of 36 come, big-endian, a million counts
// a newton (ATI 9620-05).
class MadeUpNetFt {
 public:
  MadeUpNetFt() {
    socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof own;
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&own), size), 0);
    EXPECT_EQ(::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size), 0);
    port = ntohs(own.sin_port);
    thread_ = std::thread([this] { run(); });
  }
  ~MadeUpNetFt() {
    ends_ = true;
    thread_.join();
    ::close(socket_);
  }

  int port = 0;
  std::atomic<int> x{0}, y{0};  // [mN]
  std::atomic<int> fault{0};
  std::atomic<bool> plugged{true};

 private:
  void run() {
    sockaddr_in client{};
    bool streams = false;
    for (std::uint32_t sequence = 1; !ends_;) {
      pollfd waits{socket_, POLLIN, 0};
      std::array<std::uint8_t, 64> told{};
      socklen_t size = sizeof client;
      if (::poll(&waits, 1, 1) == 1 &&
          ::recvfrom(socket_, told.data(), told.size(), 0, reinterpret_cast<sockaddr*>(&client),
                     &size) == 8) {
        streams = told[3] == 2;
      }
      if (!streams || !plugged) continue;
      std::array<std::uint32_t, 9> words{};
      words[0] = words[1] = htonl(sequence++);
      words[2] = htonl(static_cast<std::uint32_t>(fault.load()));
      words[3] = htonl(static_cast<std::uint32_t>(x.load() * 1000));
      words[4] = htonl(static_cast<std::uint32_t>(y.load() * 1000));
      (void)::sendto(socket_, words.data(), sizeof words, 0,
                     reinterpret_cast<const sockaddr*>(&client), sizeof client);
    }
  }

  int socket_ = -1;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

class HandleOfAMaster : public WholeCell {
 protected:
  void SetUp() override {
    device_kind = "kind: SIM_JOYSTICK";
    master_extra = "scene: 'gearshift' handle_sensor { ";
  }
  bool is(const std::string& state) {
    return eventually([&](const pb::Status& s) { return s.handle().state() == state; });
  }
  bool feels(double x, double y) {
    return eventually([&](const pb::Status& s) {
      const auto& force = s.handle().force().force_n();
      return force.size() == 3 && std::abs(force[0] - x) < 1e-6 && std::abs(force[1] - y) < 1e-6;
    });
  }
};

TEST_F(HandleOfAMaster, MeasuresBesideWhatIsAskedForAndSaysWhyItDoesNot) {
  MadeUpNetFt sensor;
  sensor.x = 500;  // without any force
  // Its Y is the handle's X.
  master_extra += "sensor { address: '127.0.0.1' port: " + std::to_string(sensor.port) +
                  " range_n: 50 mount { turn_deg: [0, 0, -90] } } }";
  start_master();
  ASSERT_TRUE(is("sound"));
  EXPECT_TRUE(feels(0.0, 0.0)) << "its zero";
  // The hand pushes the sensor's Y, and so the handle to the right: it is pushed to the left.
  sensor.y = 2000;
  ASSERT_TRUE(feels(-2.0, 0.0));
  const pb::Status now = status();
  EXPECT_EQ(now.handle().sensor(), "ATI Net F/T");
  EXPECT_FALSE(now.handle().simulated());
  ASSERT_EQ(now.handle().stick_torque_n_m_size(), 3);
  EXPECT_NEAR(now.handle().stick_torque_n_m(1), -0.3, 1e-9);
  EXPECT_THAT(handrail({"status"}).second, HasSubstr("felt [N]"));
  sensor.y = 51'000;
  ASSERT_TRUE(is("beyond its range"));
  sensor.y = 2000;
  sensor.fault = 1;
  ASSERT_TRUE(is("reports a fault"));
  EXPECT_FALSE(status().handle().has_force());
  sensor.fault = 0;
  sensor.plugged = false;
  ASSERT_TRUE(is("silent"));
  const pb::Status without = status();
  EXPECT_FALSE(without.handle().has_force());
  EXPECT_EQ(without.handle().stick_torque_n_m_size(), 0);
  EXPECT_EQ(without.state(), now.state()) << "nothing else changes";
  sensor.plugged = true;
  EXPECT_TRUE(feels(-2.0, 0.0)) << "the zero is kept";
}

TEST_F(HandleOfAMaster, TheSimulatedOneFeelsTheWallThatIsAskedFor) {
  master_extra += "simulated: true }";
  start_master();
  ASSERT_TRUE(is("sound"));
  EXPECT_TRUE(status().handle().simulated());
  order("hand { displacement_mm: [15, 25, 0] duration_s: 0.3 }");
  ASSERT_TRUE(eventually([](const pb::Status& s) {
    return s.device_force().magnitude_n() > 2.0 && s.handle().has_felt_share();
  }));
  const pb::Status now = status();
  // What the hand has of it: the joystick's friction keeps 0.3 N at most.
  EXPECT_NEAR(now.handle().force().magnitude_n(), now.device_force().magnitude_n(), 0.6);
  EXPECT_NEAR(now.handle().felt_share(), 1.0, 0.2);
}

}  // namespace
}  // namespace handrail
