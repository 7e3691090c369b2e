// What becomes of the sensor on the handle: its zero, and each way to have no reading.
#include "server/master/handle/handle_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "server/base/units.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

// Gives what the test wants.
class HandleScript final : public FtSensor {
 public:
  const FtCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return Status::ok(); }
  bool poll(Nanos, FtSample& out) noexcept override {
    if (!plugged) return false;
    ++sample.sequence;
    out = sample;
    return true;
  }
  void bias() noexcept override { ++biases; }
  void stop() noexcept override {}

  FtSample sample;
  bool plugged = true;
  int biases = 0;

 private:
  FtCapabilities capabilities_{"made-up sensor", 100.0, 10.0};
};

class HandleWatchTest : public ::testing::Test {
 protected:
  // So many milliseconds.
  void pass(int n, bool quiet = true) {
    for (int i = 0; i < n; ++i) {
      now += kMillisecond;
      (void)watch.step(now, quiet);
      if (const auto line = watch.line(now)) lines.push_back(*line);
    }
  }
  HandleState state() const { return watch.reading().state; }
  Vec3 force() const { return watch.reading().f_N_H.force; }

  HandleScript sensor;
  HandleWatchOptions options;
  HandleWatch watch{sensor, options};
  Nanos now = 1000 * kSecond;
  std::vector<HandleWatch::Line> lines;
};

TEST_F(HandleWatchTest, TakesItsZeroWhileNothingIsAskedFor) {
  sensor.sample.wrench = {Vec3(0.5, -1.0, 3.0), Vec3(0.01, 0.02, 0.03)};
  pass(300, false);
  EXPECT_EQ(state(), HandleState::kZeroing);
  pass(260);
  EXPECT_EQ(state(), HandleState::kSound);
  EXPECT_TRUE(force().isZero(1e-12));
  sensor.sample.wrench.force += Vec3(2.0, 0.0, 0.0);
  sensor.sample.wrench.torque += Vec3(0.0, 0.1, 0.0);
  pass(1, false);
  EXPECT_TRUE(force().isApprox(Vec3(2.0, 0.0, 0.0)));
  EXPECT_TRUE(watch.reading().f_N_H.torque.isApprox(Vec3(0.0, 0.1, 0.0), 1e-9));
  // Once: what it feels later is no zero.
  pass(1000);
  EXPECT_TRUE(force().isApprox(Vec3(2.0, 0.0, 0.0)));
  EXPECT_EQ(sensor.biases, 0) << "its own zero is left to it";
}

TEST_F(HandleWatchTest, BeginsItsZeroAnewWhenForceIsAskedForMeanwhile) {
  sensor.sample.wrench.force.x() = 8.0;
  pass(200);
  pass(1, false);
  sensor.sample.wrench.force.x() = 1.0;
  pass(240);
  EXPECT_EQ(state(), HandleState::kZeroing);
  pass(20);
  ASSERT_EQ(state(), HandleState::kSound);
  EXPECT_NEAR(force().x(), 0.0, 1e-12);
}

TEST_F(HandleWatchTest, NoReadingIsNoneOfAnotherTime) {
  pass(260);
  sensor.sample.wrench.force.x() = 2.0;
  pass(1);
  sensor.plugged = false;
  pass(90);
  EXPECT_EQ(state(), HandleState::kSound);
  pass(20);
  EXPECT_EQ(state(), HandleState::kSilent);
  EXPECT_EQ(force(), Vec3::Zero());
  sensor.plugged = true;
  sensor.sample.status = 1;
  pass(1);
  EXPECT_EQ(state(), HandleState::kFaulty);
  EXPECT_EQ(force(), Vec3::Zero());
  sensor.sample.status = 0;
  sensor.sample.wrench.force.x() = std::numeric_limits<double>::quiet_NaN();
  pass(1);
  EXPECT_EQ(state(), HandleState::kFaulty);
  sensor.sample.wrench.force.x() = 100.1;
  pass(1);
  EXPECT_EQ(state(), HandleState::kBeyond);
  EXPECT_EQ(force(), Vec3::Zero());
  sensor.sample.wrench.force.x() = 99.9;
  pass(1);
  EXPECT_EQ(state(), HandleState::kSound);
}

TEST_F(HandleWatchTest, KeepsItsZeroOverAHundredTimesUnplugged) {
  sensor.sample.wrench.force.x() = 1.0;
  pass(260);
  sensor.sample.wrench.force.x() = 3.0;
  for (int i = 0; i < 100; ++i) {
    sensor.plugged = false;
    pass(110);
    ASSERT_EQ(state(), HandleState::kSilent) << i;
    sensor.plugged = true;
    pass(5);
    ASSERT_EQ(state(), HandleState::kSound) << i;
    ASSERT_NEAR(force().x(), 2.0, 1e-12) << i;
  }
  // 11.8 s: at most a line a second.
  EXPECT_LE(lines.size(), 12u);
}

TEST_F(HandleWatchTest, EachStateIsSaidOnceAndWhatOnlyBeginsIsNot) {
  sensor.sample.wrench.force.z() = 3.0;
  pass(5000);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_FALSE(lines[0].bad);
  EXPECT_THAT(lines[0].text, HasSubstr("made-up sensor: sound; taken as zero: 0 0 3 N"));
  sensor.plugged = false;
  pass(5000);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_TRUE(lines[1].bad);
  EXPECT_THAT(lines[1].text, HasSubstr("silent"));
}

TEST_F(HandleWatchTest, OneThatNeverSendsIsSaidOnce) {
  sensor.plugged = false;
  pass(900);
  EXPECT_EQ(state(), HandleState::kWaiting);
  EXPECT_TRUE(lines.empty());
  pass(5000);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].bad);
  EXPECT_THAT(lines[0].text, HasSubstr("waits for its first record"));
}

TEST(HandleWatchTurned, ItsRangeIsAlongItsOwnAxes) {
  HandleScript sensor;
  HandleWatchOptions options;
  options.q_HF = rotation_exp(Vec3(0.0, 0.0, 45.0 * kDeg));
  options.takes_zero = false;
  HandleWatch watch(sensor, options);
  // 110 N along the sensor's X are 78 N along two axes of the handle.
  sensor.sample.wrench.force = options.q_HF * Vec3(110.0, 0.0, 0.0);
  (void)watch.step(kSecond, true);
  EXPECT_EQ(watch.reading().state, HandleState::kBeyond);
  sensor.sample.wrench.force = Vec3(110.0, 0.0, 0.0);  // 78 N along two of its own
  (void)watch.step(2 * kSecond, true);
  EXPECT_EQ(watch.reading().state, HandleState::kSound);
}

}  // namespace
}  // namespace handrail
