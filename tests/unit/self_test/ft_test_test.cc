// A made-up force sensor that is pressed as asked, or otherwise.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/self_test/ft_test.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

struct SensorBench {
  FtSample sample;
  bool streams = true;
  bool stopped = false;
  std::uint32_t step = 1;  // of the sensor's counter
};

class BenchSensor final : public FtSensor {
 public:
  explicit BenchSensor(SensorBench& bench) : bench_(bench) {}
  const FtCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return Status::ok(); }
  bool poll(Nanos, FtSample& sample) noexcept override {
    if (!bench_.streams) return false;
    bench_.sample.sequence += bench_.step;
    sample = bench_.sample;
    return true;
  }
  void bias() noexcept override {}
  void stop() noexcept override { bench_.stopped = true; }

 private:
  SensorBench& bench_;
  FtCapabilities capabilities_{"made-up", 100.0, 10.0};
};

class FtTestBench : public ::testing::Test {
 protected:
  void start(const TestWishes& wishes = {}) {
    test =
        std::make_unique<FtTest>(std::make_unique<BenchSensor>(bench), wishes, "force_sensor {}");
  }
  // The force that is asked for, and none for half a second before.
  Vec3 asked() {
    const std::string now_asked = test->asks();
    if (now_asked != before_) since_ = now;
    before_ = now_asked;
    if (now - since_ < kSecond / 2) return Vec3::Zero();
    if (now_asked.starts_with("press")) return {0.0, 0.5, -4.0};
    if (now_asked.find(" x ") != std::string::npos) return {4.0, 0.0, 0.5};
    if (now_asked.find(" y ") != std::string::npos) return {0.0, 4.0, 0.0};
    return Vec3::Zero();
  }
  template <typename Person>
  bool run(Person person, double seconds = 120.0, Nanos period = kMillisecond) {
    for (; now < from_seconds(seconds); now += period) {
      bench.sample.wrench.force = load + person();
      if (!test->turn(now)) return true;
    }
    return false;
  }
  TestItem item(const std::string& check) const {
    for (const TestItem& one : test->items()) {
      if (one.check == check) return one;
    }
    ADD_FAILURE() << "no item " << check;
    return {};
  }

  SensorBench bench;
  std::unique_ptr<FtTest> test;
  Vec3 load{0.0, 0.0, -5.0};  // of a tool
  Nanos now = 0;

 private:
  std::string before_;
  Nanos since_ = 0;
};

TEST_F(FtTestBench, PressedAsAskedItIsAllRightAndTheLoadIsNoPress) {
  start();
  ASSERT_TRUE(run([this] { return asked(); }));
  ASSERT_EQ(test->items().size(), 6u);
  for (const TestItem& one : test->items()) EXPECT_EQ(one.verdict, Verdict::kOk) << one.fact;
  EXPECT_THAT(item("records").fact, HasSubstr("1000 records a second by its own counter, 1000"));
  EXPECT_THAT(item("rest").fact, HasSubstr("load 0.00, 0.00, -5.00 N"));
  EXPECT_THAT(item("press.in").fact, HasSubstr("felt 0.0, 0.5, -4.0 N"));
  EXPECT_EQ(test->block(), "force_sensor {}");
  test.reset();
  EXPECT_TRUE(bench.stopped);
}

TEST_F(FtTestBench, AReversedSignAndATurnedFrameAreBad) {
  start();
  ASSERT_TRUE(run([this]() -> Vec3 { return -asked(); }));
  for (const char* check : {"press.in", "press.x", "press.y"}) {
    EXPECT_EQ(item(check).verdict, Verdict::kBad);
    EXPECT_THAT(item(check).next, HasSubstr("reversed")) << check;
  }
  now = 0;
  start();
  ASSERT_TRUE(run([this] {
    const Vec3 f = asked();
    return Vec3(f.y(), f.x(), f.z());
  }));
  EXPECT_EQ(item("press.in").verdict, Verdict::kOk);
  EXPECT_EQ(item("press.x").verdict, Verdict::kBad);
  EXPECT_THAT(item("press.x").next, HasSubstr("until its axes are the tip's"));
}

TEST_F(FtTestBench, WhatNobodyPressesIsNotSeenAndAloneNothingIsAsked) {
  start();
  ASSERT_TRUE(run([] { return Vec3::Zero().eval(); }));
  EXPECT_NEAR(to_seconds(now), 2.0 + 3 * 15.0, 0.1);
  EXPECT_EQ(item("press.in").verdict, Verdict::kNotSeen);
  now = 0;
  start({.alone = true});
  ASSERT_TRUE(run([] { return Vec3::Zero().eval(); }));
  EXPECT_EQ(test->items().size(), 3u);
}

TEST_F(FtTestBench, AFaultIsBadAndNamedByItsNumber) {
  start({.alone = true});
  bench.sample.status = 0x80010000u;
  ASSERT_TRUE(run([] { return Vec3::Zero().eval(); }));
  EXPECT_EQ(item("status").verdict, Verdict::kBad);
  EXPECT_THAT(item("status").fact, HasSubstr("0x80010000"));
}

TEST_F(FtTestBench, SlowOrSilentIsBad) {
  start({.alone = true});
  ASSERT_TRUE(run([] { return Vec3::Zero().eval(); }, 10.0, 10 * kMillisecond));
  EXPECT_EQ(item("records").verdict, Verdict::kBad);
  EXPECT_THAT(item("records").fact, HasSubstr("100 records a second"));
  // What a slow reader leaves out is none of the sensor's.
  now = 0;
  bench.step = 5;
  start({.alone = true});
  ASSERT_TRUE(run([] { return Vec3::Zero().eval(); }, 10.0, 10 * kMillisecond));
  EXPECT_EQ(item("records").verdict, Verdict::kOk);
  EXPECT_THAT(item("records").fact, HasSubstr("500 records a second by its own counter, 100"));
  now = 0;
  bench.streams = false;
  start();
  ASSERT_TRUE(run([] { return Vec3::Zero().eval(); }));
  ASSERT_EQ(test->items().size(), 1u);
  EXPECT_EQ(item("records").verdict, Verdict::kBad);
}

}  // namespace
}  // namespace handrail
