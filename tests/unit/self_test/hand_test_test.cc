// A made-up device in the hands of a made-up person, who does what is asked or something else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "devices/self_test/hand_test.h"
#include "server/base/units.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

// What the device shows and was told.
struct Bench {
  HapticSample sample;
  std::vector<Vec3> forces;  // one for each turn
  bool closed = false;
};

class BenchDevice final : public HapticDevice {
 public:
  BenchDevice(Bench& bench, const HapticCapabilities& capabilities)
      : bench_(bench), capabilities_(capabilities) {}
  const HapticCapabilities& capabilities() const override { return capabilities_; }
  Status open() override { return Status::ok(); }
  HapticSample read(Nanos) noexcept override { return bench_.sample; }
  void write(const Wrench& f) noexcept override { bench_.forces.push_back(f.force); }
  void close() noexcept override { bench_.closed = true; }

 private:
  Bench& bench_;
  HapticCapabilities capabilities_;
};

class HandTestBench : public ::testing::Test {
 protected:
  HandTestBench() {
    capabilities.name = "made-up";
    capabilities.senses_rotation = true;
    capabilities.max_force = 3.0;
    capabilities.continuous_force = 1.0;
    capabilities.workspace_half = Vec3::Constant(0.08);
    capabilities.buttons = 2;
    bench.sample.valid = true;
  }
  void start(const TestWishes& wishes = {}) {
    test = std::make_unique<HandTest>(std::make_unique<BenchDevice>(bench, capabilities), wishes,
                                      "device {}");
  }
  // A millisecond in which the person goes with `v` [m/s], turns with `w` [rad/s].
  void move(const Vec3& v, const Vec3& w = Vec3::Zero()) {
    bench.sample.v_MH = v;
    bench.sample.X_MH.p += 1e-3 * v;
    bench.sample.X_MH.q = rotation_exp(1e-3 * w) * bench.sample.X_MH.q;
  }
  // What somebody who understands does.
  void obey(const std::string& asked) {
    bench.sample.buttons = 0;
    const std::map<std::string, Vec3> ways = {{"move it right", Vec3::UnitX()},
                                              {"move it up", Vec3::UnitY()},
                                              {"move it toward you", Vec3::UnitZ()}};
    const std::map<std::string, Vec3> turns = {
        {"tip its top toward you", Vec3::UnitX()},
        {"turn it counter-clockwise as seen from above", Vec3::UnitY()},
        {"tip its top to the left", Vec3::UnitZ()}};
    // Pauses between, so that the next thing can be asked.
    const bool resting = asked != asked_ || rests_ > 0;
    if (asked != asked_) rests_ = 300;
    asked_ = asked;
    if (resting) --rests_;
    Vec3 v = Vec3::Zero(), w = Vec3::Zero();
    if (!resting && ways.count(asked)) v = sign * 0.1 * ways.at(asked);
    if (!resting && turns.count(asked)) w = sign * turns.at(asked);
    if (!resting && asked.starts_with("press button 1")) bench.sample.buttons = 1;
    if (!resting && asked.starts_with("press button 2")) bench.sample.buttons = 2;
    // Gives way by 5 mm for a newton, once it was still.
    if (asked.starts_with("hold it loosely") && !bench.forces.empty()) {
      v = sign * 5e-3 * (bench.forces.back() - pushed_) / 1e-3;
      pushed_ = bench.forces.back();
    }
    move(v, w);
  }
  // Until the test ends, or for `seconds`; true: it has ended.
  template <typename Person>
  bool run(Person person, double seconds = 120.0) {
    for (; now < from_seconds(seconds); now += kMillisecond) {
      person();
      if (!test->turn(now)) return true;
    }
    return false;
  }
  bool run_obeying(double seconds = 120.0) {
    return run([this] { obey(test->asks()); }, seconds);
  }
  TestItem item(const std::string& check) const {
    for (const TestItem& one : test->items()) {
      if (one.check == check) return one;
    }
    ADD_FAILURE() << "no item " << check;
    return {};
  }
  std::vector<std::string> checks() const {
    std::vector<std::string> out;
    for (const TestItem& one : test->items()) out.push_back(one.check);
    return out;
  }

  Bench bench;
  HapticCapabilities capabilities;
  std::unique_ptr<HandTest> test;
  double sign = 1.0;
  Nanos now = 5 * kSecond;

 private:
  std::string asked_;
  int rests_ = 0;
  Vec3 pushed_ = Vec3::Zero();
};

TEST_F(HandTestBench, WhoDoesAllThatIsAskedSeesItAllRight) {
  start();
  ASSERT_TRUE(run_obeying());
  EXPECT_EQ(checks(), (std::vector<std::string>{"readings", "rate", "still", "move.right",
                                                "move.up", "move.toward", "turn.right", "turn.up",
                                                "turn.toward", "button.1", "button.2"}));
  for (const TestItem& one : test->items()) EXPECT_EQ(one.verdict, Verdict::kOk) << one.fact;
  EXPECT_EQ(test->block(), "device {}");
  for (const Vec3& f : bench.forces) ASSERT_EQ(f, Vec3::Zero());
  EXPECT_EQ(test->asks(), "");
  test.reset();
  EXPECT_TRUE(bench.closed);
}

TEST_F(HandTestBench, AnAxisTheOtherWayRoundIsBadAndSaysWhichWayItWent) {
  start();
  sign = -1.0;
  ASSERT_TRUE(run_obeying());
  for (const char* check : {"move.right", "move.up", "move.toward", "turn.up"}) {
    EXPECT_EQ(item(check).verdict, Verdict::kBad) << check;
  }
  EXPECT_THAT(item("move.right").fact, HasSubstr("asked to move it right, it went 2"));
  EXPECT_THAT(item("move.right").fact, HasSubstr("mm left"));
  EXPECT_EQ(item("button.1").verdict, Verdict::kOk);
}

TEST_F(HandTestBench, AnotherAxisIsBadAndAslantIsNotSeen) {
  start();
  ASSERT_FALSE(run([this] { move(Vec3::Zero()); }, 8.0));  // left alone, then asked to go right
  ASSERT_EQ(test->asks(), "move it right");
  (void)run([this] { move(test->asks() == "move it right" ? Vec3(0.0, 0.1, 0.0) : Vec3::Zero()); },
            9.0);
  EXPECT_EQ(item("move.right").verdict, Verdict::kBad);
  (void)run([this] { move(test->asks() == "move it up" ? Vec3(0.1, 0.1, 0.0) : Vec3::Zero()); },
            12.0);
  EXPECT_EQ(item("move.up").verdict, Verdict::kNotSeen);
  EXPECT_THAT(item("move.up").fact, HasSubstr("aslant"));
}

TEST_F(HandTestBench, NobodyIsAskedToGoBeforeItHasComeToRest) {
  start();
  ASSERT_FALSE(run([this] { move(Vec3(0.1, 0.0, 0.0)); }, 6.0));
  EXPECT_EQ(test->asks(), "hold it still");
  ASSERT_FALSE(run([this] { move(Vec3::Zero()); }, 7.0));
  EXPECT_EQ(test->asks(), "leave it alone");
}

TEST_F(HandTestBench, WhatNobodyDoesIsNotSeenAfterFifteenSeconds) {
  start();
  ASSERT_FALSE(run([this] { move(Vec3::Zero()); }, 20.0));
  EXPECT_EQ(checks(), (std::vector<std::string>{"readings", "still"}));
  ASSERT_FALSE(run([this] { move(Vec3::Zero()); }, 23.0));
  EXPECT_EQ(item("move.right").verdict, Verdict::kNotSeen);
  EXPECT_THAT(item("move.right").fact, HasSubstr("nothing came of it in 15 s"));
  EXPECT_EQ(test->asks(), "move it up");
  EXPECT_TRUE(run([this] { move(Vec3::Zero()); }, 150.0));
}

TEST_F(HandTestBench, WhatDriftsWhileLeftAloneIsBad) {
  start({.alone = true});
  ASSERT_TRUE(run([this] { move(Vec3(0.0, 4e-3, 0.0)); }));
  EXPECT_EQ(item("still").verdict, Verdict::kBad);
  EXPECT_EQ(checks(), (std::vector<std::string>{"readings", "still"}));
}

TEST_F(HandTestBench, ADeviceThatIsGoneEndsTheTest) {
  start();
  bench.sample.valid = false;
  EXPECT_FALSE(run([] {}, 9.9));
  EXPECT_TRUE(run([] {}, 10.2));
  EXPECT_EQ(item("readings").verdict, Verdict::kBad);
  EXPECT_THAT(item("readings").fact, HasSubstr("no valid reading for 5 s"));
}

TEST_F(HandTestBench, AFewInvalidReadingsInAHundredAreBad) {
  start({.alone = true});
  int turns = 0;
  ASSERT_TRUE(run([&] { bench.sample.valid = ++turns % 50 != 0; }));
  EXPECT_EQ(item("readings").verdict, Verdict::kBad);
  EXPECT_THAT(item("readings").fact, HasSubstr("2.0 % of them not valid"));
}

TEST_F(HandTestBench, ReadingsThatStandStillWhileItMovesAreSeenInTheRate) {
  start();
  // The device tells of its place every 40 ms only.
  HapticSample real = bench.sample, shown = bench.sample;
  int turns = 0;
  (void)run([&] {
    bench.sample = real;
    obey(test->asks());
    real = bench.sample;
    const Pose last = shown.X_MH;
    shown = real;
    if (++turns % 40 != 0) shown.X_MH = last;
    bench.sample = shown;
  });
  EXPECT_EQ(item("rate").verdict, Verdict::kBad);
  EXPECT_THAT(item("rate").fact, HasSubstr("while it moved, 2"));
}

TEST_F(HandTestBench, AnotherButtonIsNamed) {
  start();
  (void)run([this] {
    obey(test->asks());
    if (bench.sample.buttons == 1) bench.sample.buttons = 2;
  });
  EXPECT_EQ(item("button.1").verdict, Verdict::kBad);
  EXPECT_THAT(item("button.1").fact, HasSubstr("button 2 went down instead"));
}

TEST_F(HandTestBench, AForceRisesSlowlyToWhatIsSustainedAndEndsAtNothing) {
  start({.force = 2.0});
  ASSERT_TRUE(run_obeying());
  for (const char* check : {"force.right", "force.up", "force.toward"}) {
    EXPECT_EQ(item(check).verdict, Verdict::kOk) << item(check).fact;
  }
  EXPECT_THAT(item("force.right").fact, HasSubstr("with up to 1.00 N it gave way 5.0 mm right"));
  double most = 0.0, rise = 0.0, fall = 0.0;
  Vec3 before = Vec3::Zero();
  for (const Vec3& f : bench.forces) {
    most = std::max(most, f.norm());
    rise = std::max(rise, f.norm() - before.norm());
    fall = std::max(fall, before.norm() - f.norm());
    before = f;
  }
  EXPECT_NEAR(most, 1.0, 1e-9);
  EXPECT_LT(rise, 0.0011);  // a newton in a second, in steps of a millisecond
  EXPECT_LT(fall, 0.0035);  // in 0.3 s
  EXPECT_EQ(bench.forces.back(), Vec3::Zero());
}

TEST_F(HandTestBench, AForceTheOtherWayRoundIsBad) {
  start({.force = 1.0});
  sign = -1.0;
  ASSERT_TRUE(run_obeying());
  EXPECT_EQ(item("force.up").verdict, Verdict::kBad);
  EXPECT_THAT(item("force.up").next, HasSubstr("do not use it"));
}

TEST_F(HandTestBench, AForceEndsAtOnceWhenTheDeviceFleesOrIsGone) {
  capabilities.senses_rotation = false;
  capabilities.buttons = 0;
  for (const bool flees : {true, false}) {
    bench = Bench();
    bench.sample.valid = true;
    now = 5 * kSecond;
    start({.force = 1.0});
    ASSERT_FALSE(run([&] { move(Vec3::Zero()); }, 52.9));  // three ways that nobody went
    ASSERT_GT(bench.forces.back().x(), 0.3) << flees;
    if (flees) {
      move(Vec3(0.6, 0.0, 0.0));
    } else {
      bench.sample.valid = false;
    }
    ASSERT_TRUE(test->turn(now));
    EXPECT_EQ(bench.forces.back(), Vec3::Zero());
  }
}

TEST_F(HandTestBench, WhoeverMakesNoForceIsNotAskedForAny) {
  capabilities.max_force = 0.0;
  start({.force = 1.0});
  ASSERT_TRUE(run_obeying());
  EXPECT_EQ(item("force").verdict, Verdict::kBad);
  EXPECT_THAT(item("force").fact, HasSubstr("makes no force"));
  capabilities.max_force = 3.0;
  now = 5 * kSecond;
  start({.alone = true, .force = 1.0});
  ASSERT_TRUE(run([this] { move(Vec3::Zero()); }));
  EXPECT_EQ(item("force").verdict, Verdict::kNotSeen);
  for (const Vec3& f : bench.forces) ASSERT_EQ(f, Vec3::Zero());
}

}  // namespace
}  // namespace handrail
