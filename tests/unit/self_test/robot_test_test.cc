// A made-up controller, watched.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "devices/self_test/robot_test.h"
#include "server/base/units.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

struct RobotBench {
  std::function<RobotEvent(int cycle, RobotReply& reply)> answers = [](int, RobotReply&) {
    return RobotEvent::kReply;
  };
  int cycle = 0, asked = 0, sent = 0, ended = 0;
};

class BenchRobot final : public Robot {
 public:
  explicit BenchRobot(RobotBench& bench) : bench_(bench) {}
  const RobotCapabilities& capabilities() const override { return capabilities_; }
  Status connect(Nanos, RobotReply&) override { return Status::ok(); }
  RobotEvent wait(RobotReply& reply) noexcept override {
    return bench_.answers(bench_.cycle++, reply);
  }
  void send(const JointVector&) noexcept override { ++bench_.sent; }
  void ask() noexcept override { ++bench_.asked; }
  void end() noexcept override { ++bench_.ended; }

 private:
  RobotBench& bench_;
  RobotCapabilities capabilities_{"made-up", 7 * kMillisecond};
};

class RobotTestBench : public ::testing::Test {
 protected:
  void run(Nanos period = 7 * kMillisecond) {
    RobotReply first;
    first.has_measured = true;
    first.q_measured[2] = 90.0 * kDeg;
    test = std::make_unique<RobotTest>(std::make_unique<BenchRobot>(bench), first, "robot {}");
    Nanos now = kSecond;
    for (int i = 0; i < 1000 && test->turn(now); ++i) now += period;
    took = now - kSecond;
  }
  TestItem item(const std::string& check) const {
    for (const TestItem& one : test->items()) {
      if (one.check == check) return one;
    }
    ADD_FAILURE() << "no item " << check;
    return {};
  }
  RobotBench bench;
  std::unique_ptr<RobotTest> test;
  Nanos took = 0;
};

TEST_F(RobotTestBench, AnArmThatStandsAndAnswersIsAllRightAndIsToldNothing) {
  run();
  ASSERT_EQ(test->items().size(), 3u);
  for (const TestItem& one : test->items()) EXPECT_EQ(one.verdict, Verdict::kOk) << one.fact;
  EXPECT_THAT(item("joints").fact, HasSubstr("0.00, 0.00, 90.00, 0.00, 0.00, 0.00 deg"));
  EXPECT_THAT(item("cycle").fact, HasSubstr("7.0"));
  EXPECT_NEAR(to_seconds(took), 3.0, 0.02);
  EXPECT_EQ(bench.sent, 0);
  EXPECT_EQ(bench.asked, bench.cycle);
  test.reset();
  EXPECT_EQ(bench.ended, 1);
}

TEST_F(RobotTestBench, SilenceIsCountedAndAnotherCycleIsBad) {
  bench.answers = [](int cycle, RobotReply&) {
    return cycle % 20 == 7 ? RobotEvent::kSilence : RobotEvent::kReply;
  };
  run();
  EXPECT_EQ(item("answers").verdict, Verdict::kBad);
  EXPECT_THAT(item("answers").fact, HasSubstr("5.1 % of 4"));
  EXPECT_EQ(item("cycle").verdict, Verdict::kOk);
  bench.answers = RobotBench().answers;
  run(4 * kMillisecond);
  EXPECT_EQ(item("answers").verdict, Verdict::kOk);
  EXPECT_EQ(item("cycle").verdict, Verdict::kBad);
}

TEST_F(RobotTestBench, AnArmThatSomebodyElseMovesIsBad) {
  bench.answers = [](int cycle, RobotReply& reply) {
    reply.q_measured[4] = cycle * 0.001 * kDeg;
    return RobotEvent::kReply;
  };
  run();
  EXPECT_EQ(item("joints").verdict, Verdict::kBad);
  EXPECT_THAT(item("joints").next, HasSubstr("something else moves"));
}

TEST_F(RobotTestBench, AControllerThatFallsSilentEndsTheTest) {
  bench.answers = [](int cycle, RobotReply&) {
    return cycle < 10 ? RobotEvent::kReply : RobotEvent::kLost;
  };
  run();
  EXPECT_EQ(bench.cycle, 11);
  ASSERT_EQ(test->items().size(), 1u);
  EXPECT_EQ(item("answers").verdict, Verdict::kBad);
}

}  // namespace
}  // namespace handrail
