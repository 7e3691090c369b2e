// What every force sensor driver must do: over the real transport against the simulated sensor, or
// over a stand-in for libcomedi.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <thread>

#include "devices/comedi/comedi_ft_sensor.h"
#include "devices/net_ft/net_ft_sensor.h"
#include "devices/rig/rig_server.h"
#include "server/base/clock.h"
#include "tests/support/comedi/comedi_stand_in.h"

namespace handrail {
namespace {

constexpr Nanos kSensorPatience = 20 * kSecond;

// A sensor and who pushes at it.
class SensorPlace {
 public:
  virtual ~SensorPlace() = default;
  virtual std::unique_ptr<FtSensor> make() = 0;
  virtual void push(double fx, double tz) = 0;
  // The sensor forgets who reads it, as after a power cut, and counts from 1 when asked again.
  // False: this one does not count.
  virtual bool forget() = 0;
};

class NetFtPlace final : public SensorPlace {
 public:
  NetFtPlace() {
    RigOptions options;
    options.sensor.noise_n = 0.0;
    options.sensor.noise_n_m = 0.0;
    server_ = std::make_unique<RigServer>(options);
    const Status opened = server_->open("127.0.0.1", 0, 0);
    EXPECT_TRUE(opened) << opened.message();
    thread_ = std::thread([this] { server_->run(); });
  }
  ~NetFtPlace() override {
    server_->stop();
    thread_.join();
  }
  std::unique_ptr<FtSensor> make() override { return make(FtMount()); }
  std::unique_ptr<FtSensor> make(const FtMount& mount) const {
    NetFtOptions options;
    options.port = server_->sensor_port();
    options.mount = mount;
    return std::make_unique<NetFtSensor>(options);
  }
  void push(double fx, double tz) override {
    server_->post([=](Rig& rig) { rig.sensor().set_wrench({{fx, 0.0, 0.0}, {0.0, 0.0, tz}}); });
  }
  bool forget() override {
    server_->post([](Rig& rig) {
      rig.sensor().on_datagram(encode_rdt(RdtRequest{RdtCommand::kStop, 0}), 0);
    });
    return true;
  }

 private:
  std::unique_ptr<RigServer> server_;
  std::thread thread_;
};

// A JR3 of 1000 N and 100 N m, or six voltages of 100 N/V and 10 N m/V.
class ComediPlaceOf final : public SensorPlace {
 public:
  explicit ComediPlaceOf(ComediFtKind kind) : kind_(kind) {
    void* const library = ::dlopen(HANDRAIL_COMEDI_STAND_IN, RTLD_NOW | RTLD_LOCAL);
    test::ComediStandInOf of = nullptr;
    void* const found = library == nullptr ? nullptr : ::dlsym(library, "comedi_stand_in");
    std::memcpy(&of, &found, sizeof of);
    card_ = of();
    card_->reset();
    const std::lock_guard lock(card_->mutex);
    test::StandInSubdevice in;
    in.type = 1;
    in.values.assign(58, 16384);
    if (kind == ComediFtKind::kJr3) {
      in.max_data = 0x7fff;
      for (unsigned int i = 0; i < 56; ++i) in.channel_max[i] = i % 8 < 3 ? 1.0 : 0.1;
    } else {
      in.max_data = 0xffffff;
      in.values.assign(6, 0x800000);
    }
    card_->subdevices = {in};
  }
  std::unique_ptr<FtSensor> make() override {
    ComediFtOptions options;
    options.kind = kind_;
    options.place.library = HANDRAIL_COMEDI_STAND_IN;
    options.filter = 0;
    for (int i = 0; i < 6; ++i) options.matrix(i, i) = i < 3 ? 100.0 : 10.0;
    return std::make_unique<ComediFtSensor>(options);
  }
  void push(double fx, double tz) override {
    set(0, fx / 1000.0);
    set(5, tz / 100.0);
  }
  bool forget() override { return false; }

 private:
  void set(std::size_t axis, double share) {
    const std::lock_guard lock(card_->mutex);
    test::StandInSubdevice& in = card_->subdevices[0];
    const bool jr3 = kind_ == ComediFtKind::kJr3;
    const double middle = jr3 ? 16384.0 : 0.5 * in.max_data, full = jr3 ? 16384.0 : middle;
    in.values[axis] =
        static_cast<unsigned int>(std::clamp(std::round(middle + share * full), 0.0, 1e9));
    in.values[axis] = std::min(in.values[axis], in.max_data);
  }

  ComediFtKind kind_;
  test::ComediStandIn* card_ = nullptr;
};

struct SensorCase {
  const char* name;
  std::function<std::unique_ptr<SensorPlace>()> make;
  double step_n, step_n_m;  // of its converter
};

class FtSensorConformance : public ::testing::TestWithParam<SensorCase> {
 protected:
  void SetUp() override {
    place_ = GetParam().make();
    sensor_ = place_->make();
  }
  void TearDown() override {
    sensor_.reset();
    place_.reset();
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
  void push(double fx, double tz) { place_->push(fx, tz); }
  // Good readings alone: some settle first.
  bool take_good_until(const std::function<bool(const FtSample&)>& wanted) {
    return take_until([&](const FtSample& s) { return s.status == 0 && wanted(s); });
  }

  std::unique_ptr<SensorPlace> place_;
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
    ASSERT_TRUE(i == 0 ? take_good_until([](const FtSample&) { return true; }) : take());
    EXPECT_GT(sample_.sequence, newest);
    newest = sample_.sequence;
    EXPECT_EQ(sample_.status, 0u);
  }
}

TEST_P(FtSensorConformance, MeasuresTheWrenchInSiUnits) {
  ASSERT_TRUE(sensor_->start());
  push(12.5, -0.75);
  EXPECT_TRUE(take_good_until([](const FtSample& s) {
    return (s.wrench.force - Vec3(12.5, 0.0, 0.0)).norm() < GetParam().step_n &&
           (s.wrench.torque - Vec3(0.0, 0.0, -0.75)).norm() < GetParam().step_n_m;
  }));
}

TEST_P(FtSensorConformance, TakesThePresentReadingAsZero) {
  ASSERT_TRUE(sensor_->start());
  push(5.0, 0.0);
  ASSERT_TRUE(take_good_until([](const FtSample& s) { return s.wrench.force.x() > 4.9; }));
  sensor_->bias();
  EXPECT_TRUE(take_good_until([](const FtSample& s) { return s.wrench.force.norm() < 1e-3; }));
}

TEST_P(FtSensorConformance, PassesOnThatTheSensorIsSaturated) {
  ASSERT_TRUE(sensor_->start());
  ASSERT_TRUE(take_good_until([](const FtSample&) { return true; }));
  push(sensor_->capabilities().range_force + 1.0, 0.0);
  EXPECT_TRUE(take_until([](const FtSample& s) { return s.status != 0; }));
}

TEST_P(FtSensorConformance, AsksAgainForAStreamThatFellSilent) {
  ASSERT_TRUE(sensor_->start());
  ASSERT_TRUE(take_until([](const FtSample& s) { return s.sequence >= 20; }));
  if (!place_->forget()) return;  // there is no stream to ask for
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

// 30 mm behind the tip and aside of it, turned so that x is the flange's y, y its z, z its x.
TEST(NetFtMount, WhatItFeelsIsTurnedAndMovedToTheTip) {
  NetFtPlace place;
  const auto sensor = place.make({{Vec3(0.01, 0.02, -0.03), Quat(0.5, 0.5, 0.5, 0.5)}});
  ASSERT_TRUE(sensor->start());
  place.push(10.0, 0.5);
  FtSample sample;
  const Nanos give_up = monotonic_now() + kSensorPatience;
  while (monotonic_now() < give_up && !(sample.wrench.force.norm() > 9.0)) {
    sensor->poll(monotonic_now(), sample);
    std::this_thread::yield();
  }
  const auto expect_felt = [&sample] {
    EXPECT_TRUE(sample.wrench.force.isApprox(Vec3(0.0, 10.0, 0.0), 1e-6));
    // (0.01, 0.02, -0.03) x (0, 10, 0) = (0.3, 0, 0.1); its own is turned to (0.5, 0, 0).
    EXPECT_TRUE(sample.wrench.torque.isApprox(Vec3(0.8, 0.0, 0.1), 1e-6));
  };
  expect_felt();
  // Once each: where nothing new came it is as it was.
  for (int without = 0; without < 10 && monotonic_now() < give_up;) {
    without += sensor->poll(monotonic_now(), sample) ? 0 : 1;
    expect_felt();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Every, FtSensorConformance,
    ::testing::Values(
        SensorCase{"NetFt", [] { return std::make_unique<NetFtPlace>(); }, 1e-5, 1e-6},
        SensorCase{"Jr3", [] { return std::make_unique<ComediPlaceOf>(ComediFtKind::kJr3); }, 0.07,
                   0.007},
        SensorCase{"Analog", [] { return std::make_unique<ComediPlaceOf>(ComediFtKind::kAnalog); },
                   2e-4, 2e-5}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace handrail
