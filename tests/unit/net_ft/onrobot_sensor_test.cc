// A made-up HEX of OnRobot at a UDP socket, which keeps what it is told, and the sensor driver.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <vector>

#include "devices/net_ft/net_ft_sensor.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"

namespace handrail {
namespace {

using Datagram = std::vector<std::uint8_t>;

class MadeUpHex : public ::testing::Test {
 protected:
  void SetUp() override {
    socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    ASSERT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), size), 0);
    ASSERT_EQ(::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    options.port = ntohs(address.sin_port);
    options.client.dialect = RdtDialect::kOnRobot;
    options.client.counts_per_n = 1e4;
    options.client.counts_per_n_m = 1e5;
  }
  void TearDown() override { ::close(socket_); }

  // The next thing it is told; empty: nothing in 5 s.
  Datagram told() {
    pollfd waits{socket_, POLLIN, 0};
    if (::poll(&waits, 1, 5000) != 1) return {};
    Datagram bytes(64);
    socklen_t size = sizeof client_;
    const ssize_t n = ::recvfrom(socket_, bytes.data(), bytes.size(), 0,
                                 reinterpret_cast<sockaddr*>(&client_), &size);
    bytes.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return bytes;
  }
  // -2.5 N along x and 0.25 N m about z, as the field table of its manual has them.
  void send_record(std::uint32_t sequence) {
    RdtRecord record;
    record.rdt_sequence = sequence;
    record.counts = {-25'000, 0, 0, 0, 0, 25'000};
    const auto bytes = encode_rdt(record);
    ASSERT_EQ(::sendto(socket_, bytes.data(), bytes.size(), 0,
                       reinterpret_cast<const sockaddr*>(&client_), sizeof client_),
              static_cast<ssize_t>(bytes.size()));
  }

  int socket_ = -1;
  sockaddr_in client_{};
  NetFtOptions options;
};

const Datagram kTwoMs{0x12, 0x34, 0x00, 0x82, 0, 0, 0, 2};
const Datagram kFifteenHz{0x12, 0x34, 0x00, 0x81, 0, 0, 0, 4};
const Datagram kBegin{0x12, 0x34, 0x00, 0x02, 0, 0, 0, 0};
const Datagram kZero{0x12, 0x34, 0x00, 0x42, 0, 0, 0, 0xff};
const Datagram kEnough{0x12, 0x34, 0x00, 0x00, 0, 0, 0, 0};

TEST_F(MadeUpHex, IsToldPeriodAndFilterAndThenToStreamAndIsReadInItsScale) {
  options.client.period_ms = 2;
  options.client.filter = 4;
  NetFtSensor sensor(options);
  EXPECT_EQ(sensor.capabilities().name, "OnRobot HEX");
  ASSERT_TRUE(sensor.start());
  EXPECT_EQ(told(), kTwoMs);
  EXPECT_EQ(told(), kFifteenHz);
  EXPECT_EQ(told(), kBegin);
  send_record(7);
  FtSample sample;
  const Nanos until = monotonic_now() + 10 * kSecond;
  while (!sensor.poll(monotonic_now(), sample)) {
    ASSERT_LT(monotonic_now(), until);
    sleep_until(monotonic_now() + kMillisecond / 2);
  }
  EXPECT_NEAR(sample.wrench.force.x(), -2.5, 1e-12);
  EXPECT_NEAR(sample.wrench.torque.z(), 0.25, 1e-12);
  sensor.bias();
  sensor.stop();
  // Where this computer stood still it was asked for the stream again in between.
  Datagram last = told();
  while (last == kTwoMs || last == kFifteenHz || last == kBegin) last = told();
  EXPECT_EQ(last, kZero);
  EXPECT_EQ(told(), kEnough);
}

// No descriptor is to be had, as without a network there is no way to its address.
TEST_F(MadeUpHex, AnAddressThatCannotBeOpenedIsTriedAgainWhereItIsWaitedFor) {
  rlimit all{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &all), 0);
  const rlimit none{0, all.rlim_max};
  for (const bool waits : {false, true}) {
    options.waits = waits;
    options.reopen_pause = 20 * kMillisecond;
    NetFtSensor sensor(options);
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
    const Status started = sensor.start();
    const Nanos now = monotonic_now();
    FtSample sample;
    EXPECT_FALSE(sensor.poll(now + 25 * kMillisecond, sample));
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &all), 0);
    EXPECT_NE(started.message().find("Too many open files"), std::string::npos);
    EXPECT_FALSE(sensor.poll(now + 30 * kMillisecond, sample));
    pollfd told_now{socket_, POLLIN, 0};
    EXPECT_EQ(::poll(&told_now, 1, 0), 0) << "not before its pause is over";
    EXPECT_FALSE(sensor.poll(now + 50 * kMillisecond, sample));
    ASSERT_EQ(::poll(&told_now, 1, waits ? 5000 : 100), waits ? 1 : 0);
    if (!waits) continue;
    EXPECT_EQ(told(), kBegin);
    send_record(7);
    const Nanos until = monotonic_now() + 10 * kSecond;
    while (!sensor.poll(monotonic_now() + 50 * kMillisecond, sample)) {
      ASSERT_LT(monotonic_now(), until);
      sleep_until(monotonic_now() + kMillisecond / 2);
    }
    EXPECT_NEAR(sample.wrench.force.x(), -2.5, 1e-12);
    sensor.stop();
    EXPECT_FALSE(sensor.poll(monotonic_now() + kSecond, sample));
    EXPECT_EQ(told(), kEnough);
    EXPECT_EQ(::poll(&told_now, 1, 100), 0) << "stopped, it is not wanted any more";
  }
}

TEST_F(MadeUpHex, AfterASilenceItIsToldAllAgain) {
  options.client.period_ms = 2;
  NetFtSensor sensor(options);
  ASSERT_TRUE(sensor.start());
  EXPECT_EQ(told(), kTwoMs);
  EXPECT_EQ(told(), kBegin);
  FtSample sample;
  EXPECT_FALSE(sensor.poll(monotonic_now() + 200 * kMillisecond, sample));
  EXPECT_EQ(told(), kTwoMs);
  EXPECT_EQ(told(), kBegin);
}

}  // namespace
}  // namespace handrail
