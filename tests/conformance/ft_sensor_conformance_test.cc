// What every force sensor driver must do, over the real transport against the simulated sensor.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <thread>

#include "devices/net_ft/net_ft_sensor.h"
#include "devices/rig/rig_server.h"
#include "server/base/clock.h"

namespace handrail {
namespace {

constexpr Nanos kSensorPatience = 20 * kSecond;

struct SensorCase {
  const char* name;
  std::function<std::unique_ptr<FtSensor>(std::uint16_t port)> make;
};

std::unique_ptr<FtSensor> make_net_ft(std::uint16_t port) {
  NetFtOptions options;
  options.port = port;
  return std::make_unique<NetFtSensor>(options);
}

class FtSensorConformance : public ::testing::TestWithParam<SensorCase> {
 protected:
  void SetUp() override {
    RigOptions options;
    options.sensor.noise_n = 0.0;
    options.sensor.noise_n_m = 0.0;
    server_ = std::make_unique<RigServer>(options);
    const Status opened = server_->open("127.0.0.1", 0, 0);
    ASSERT_TRUE(opened) << opened.message();
    thread_ = std::thread([this] { server_->run(); });
    sensor_ = GetParam().make(server_->sensor_port());
  }

  void TearDown() override {
    sensor_.reset();
    server_->stop();
    thread_.join();
  }

  // Polls until a new record satisfies `wanted`.
  template <typename F>
  bool take_until(F wanted) {
    const Nanos give_up = monotonic_now() + kSensorPatience;
    while (monotonic_now() < give_up) {
      if (sensor_->poll(monotonic_now(), sample_) && wanted(sample_)) return true;
      std::this_thread::yield();
    }
    return false;
  }
  bool take() {
    return take_until([](const FtSample&) { return true; });
  }
  void push(double fx, double tz) {
    server_->post([=](Rig& rig) { rig.sensor().set_wrench({{fx, 0.0, 0.0}, {0.0, 0.0, tz}}); });
  }

  std::unique_ptr<RigServer> server_;
  std::thread thread_;
  std::unique_ptr<FtSensor> sensor_;
  FtSample sample_;
};

TEST_P(FtSensorConformance, SaysWhatItCanMeasure) {
  EXPECT_FALSE(sensor_->capabilities().name.empty());
  EXPECT_GT(sensor_->capabilities().range_force, 0.0);
  EXPECT_GT(sensor_->capabilities().range_torque, 0.0);
}

TEST_P(FtSensorConformance, HasNothingBeforeTheStart) {
  EXPECT_FALSE(sensor_->poll(monotonic_now(), sample_));
  sensor_->bias();
  sensor_->stop();
}

TEST_P(FtSensorConformance, GivesEverNewerRecords) {
  ASSERT_TRUE(sensor_->start());
  std::uint32_t newest = 0;
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(take());
    EXPECT_GT(sample_.sequence, newest);
    newest = sample_.sequence;
    EXPECT_EQ(sample_.status, 0u);
  }
}

TEST_P(FtSensorConformance, MeasuresTheWrenchInSiUnits) {
  ASSERT_TRUE(sensor_->start());
  push(12.5, -0.75);
  EXPECT_TRUE(take_until([](const FtSample& s) {
    return s.wrench.force.isApprox(Vec3(12.5, 0.0, 0.0), 1e-6) &&
           s.wrench.torque.isApprox(Vec3(0.0, 0.0, -0.75), 1e-6);
  }));
}

TEST_P(FtSensorConformance, TakesThePresentReadingAsZero) {
  ASSERT_TRUE(sensor_->start());
  push(5.0, 0.0);
  ASSERT_TRUE(take_until([](const FtSample& s) { return s.wrench.force.x() > 4.9; }));
  sensor_->bias();
  EXPECT_TRUE(take_until([](const FtSample& s) { return s.wrench.force.norm() < 1e-3; }));
}

TEST_P(FtSensorConformance, PassesOnThatTheSensorIsSaturated) {
  ASSERT_TRUE(sensor_->start());
  push(sensor_->capabilities().range_force + 1.0, 0.0);
  EXPECT_TRUE(take_until([](const FtSample& s) { return s.status != 0; }));
}

TEST_P(FtSensorConformance, AsksAgainForAStreamThatFellSilent) {
  ASSERT_TRUE(sensor_->start());
  ASSERT_TRUE(take_until([](const FtSample& s) { return s.sequence >= 20; }));
  // The sensor forgets us, as after a power cut, and counts from 1 when asked again.
  server_->post([](Rig& rig) {
    rig.sensor().on_datagram(encode_rdt(RdtRequest{RdtCommand::kStop, 0}), 0);
  });
  EXPECT_TRUE(take_until([](const FtSample& s) { return s.sequence < 20; }))
      << "the stream did not begin anew";
}

TEST_P(FtSensorConformance, StopsAndStartsAgain) {
  ASSERT_TRUE(sensor_->start());
  ASSERT_TRUE(take());
  sensor_->stop();
  sensor_->stop();
  EXPECT_FALSE(sensor_->poll(monotonic_now(), sample_));
  ASSERT_TRUE(sensor_->start());
  EXPECT_TRUE(take());
}

INSTANTIATE_TEST_SUITE_P(Every, FtSensorConformance,
                         ::testing::Values(SensorCase{"NetFt", make_net_ft}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace handrail
