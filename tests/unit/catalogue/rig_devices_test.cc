// Robot and sensor drivers at the simulated rig, over real sockets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "devices/catalogue/catalogue.h"
#include "devices/rig/rig_server.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/scene/config_io.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class RigDevices : public ::testing::Test {
 protected:
  void SetUp() override {
    server_ = std::make_unique<RigServer>(RigOptions());
    const Status opened = server_->open("127.0.0.1", 0, 0);
    ASSERT_TRUE(opened) << opened.message();
    thread_ = std::thread([this] { server_->run(); });
    settings.robot.port = server_->robot_port();
    settings.sensor.port = server_->sensor_port();
  }
  void TearDown() override {
    server_->stop();
    thread_.join();
  }
  template <typename F>
  auto ask(F f) {
    std::promise<decltype(f(std::declval<Rig&>()))> promise;
    auto answer = promise.get_future();
    server_->post([&](Rig& rig) { promise.set_value(f(rig)); });
    return answer.get();
  }
  // In real time, to its end.
  static void run(SelfTest& test) {
    while (test.turn(monotonic_now())) {
      if (test.period() > 0) sleep_until(monotonic_now() + test.period());
    }
  }
  static TestItem item(const SelfTest& test, const std::string& check) {
    for (const TestItem& one : test.items()) {
      if (one.check == check) return one;
    }
    ADD_FAILURE() << "no item " << check;
    return {};
  }

  DeviceSettings settings;
  std::unique_ptr<RigServer> server_;
  std::thread thread_;
};

TEST_F(RigDevices, TheArmIsFoundAndAskedWithoutAMotionAndWithoutAnEnd) {
  const auto driver = find_driver("melfa")->make(settings);
  const Sighting seen = driver->probe().at(0);
  EXPECT_EQ(seen.readiness, Readiness::kReady) << seen.fact;
  EXPECT_THAT(seen.fact, HasSubstr("answers with 196 bytes"));
  EXPECT_EQ(seen.place, "127.0.0.1:" + std::to_string(server_->robot_port()));
  // An END would have closed the session, and on a real controller gone on in its program.
  EXPECT_TRUE(ask([](Rig& rig) { return rig.controller().session().has_value(); }));
  EXPECT_EQ(ask([](Rig& rig) { return rig.controller().arm().target(); }),
            ServoArmOptions::default_start());
  auto calibrated = driver->calibrate();
  ASSERT_TRUE(calibrated) << calibrated.message();
  EXPECT_THAT((*calibrated)->block(), HasSubstr("packet_bytes: 196"));
}

TEST_F(RigDevices, TheArmIsWatchedAndNotMoved) {
  const auto driver = find_driver("melfa")->make(settings);
  auto test = driver->test({});
  ASSERT_TRUE(test) << test.message();
  run(**test);
  EXPECT_THAT(item(**test, "joints").fact, HasSubstr("90.0"));
  EXPECT_EQ(item(**test, "joints").verdict, Verdict::kOk) << item(**test, "joints").fact;
  EXPECT_EQ(ask([](Rig& rig) { return rig.controller().arm().target(); }),
            ServoArmOptions::default_start());
  test->reset();
  // Its END comes with the next cycle.
  const Nanos give_up = monotonic_now() + 10 * kSecond;
  while (ask([](Rig& rig) { return rig.controller().session().has_value(); })) {
    ASSERT_LT(monotonic_now(), give_up);
    sleep_until(monotonic_now() + kMillisecond);
  }
}

TEST_F(RigDevices, TheSensorStreamsAndItsRecordsAreCounted) {
  const auto driver = find_driver("net-ft")->make(settings);
  EXPECT_EQ(driver->probe().at(0).readiness, Readiness::kReady) << driver->probe().at(0).fact;
  auto test = driver->test({.alone = true});
  ASSERT_TRUE(test) << test.message();
  run(**test);
  EXPECT_THAT(item(**test, "records").fact, HasSubstr("records a second by its own counter"));
  EXPECT_EQ(item(**test, "status").verdict, Verdict::kOk);
  EXPECT_THAT((*test)->block(), HasSubstr("counts_per_n: 1000000"));
}

TEST_F(RigDevices, OnTheHandleItsBlockIsTheMasters) {
  settings.handle = settings.sensor;
  settings.has_handle = true;
  const auto driver = find_driver("handle-ft")->make(settings);
  EXPECT_EQ(driver->daemon(), "handrail-master");
  EXPECT_EQ(driver->probe().at(0).readiness, Readiness::kReady) << driver->probe().at(0).fact;
  auto test = driver->test({.alone = true});
  ASSERT_TRUE(test) << test.message();
  const TempFolder folder;
  const auto config = load_master_config(folder.write("block.conf", (*test)->block()), "", "");
  ASSERT_TRUE(config) << config.message();
  EXPECT_EQ(config->handle_sensor().sensor().port(), settings.sensor.port);
}

}  // namespace
}  // namespace handrail
