// What every robot driver must do, over the real transport against the simulated controller.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <future>
#include <memory>
#include <thread>

#include "devices/melfa/melfa_robot.h"
#include "devices/rig/rig_server.h"

namespace handrail {
namespace {

constexpr Nanos kPatience = 20 * kSecond;

struct RobotCase {
  const char* name;
  std::function<std::unique_ptr<Robot>(std::uint16_t port)> make;
};

std::unique_ptr<Robot> make_melfa(std::uint16_t port, std::size_t packet_bytes) {
  MelfaOptions options;
  options.port = port;
  options.client.packet_bytes = packet_bytes;
  return std::make_unique<MelfaRobot>(options);
}

class RobotConformance : public ::testing::TestWithParam<RobotCase> {
 protected:
  void TearDown() override {
    robot_.reset();
    server_->stop();
    if (thread_.joinable()) thread_.join();
  }

  void serve(const ControllerOptions& controller = {}) {
    RigOptions options;
    options.controller = controller;
    server_ = std::make_unique<RigServer>(options);
    const Status opened = server_->open("127.0.0.1", 0, 0);
    ASSERT_TRUE(opened) << opened.message();
    thread_ = std::thread([this] { server_->run(); });
    robot_ = GetParam().make(server_->robot_port());
  }

  // Connects and checks that the first joints are those the arm stands at.
  void connect() {
    const Status connected = robot_->connect(kPatience, reply_);
    ASSERT_TRUE(connected) << connected.message();
    EXPECT_LT((reply_.q_measured - ServoArmOptions::default_start()).norm(), 1e-3);
    EXPECT_LT((reply_.q_commanded - ServoArmOptions::default_start()).norm(), 1e-3);
  }

  // Waits for a reply through the silences a busy machine may add.
  RobotEvent next() {
    RobotEvent event = robot_->wait(reply_);
    while (event == RobotEvent::kSilence || event == RobotEvent::kRejected) {
      ++interruptions_;
      if (event == RobotEvent::kSilence) robot_->ask();
      event = robot_->wait(reply_);
    }
    return event;
  }

  // What `f` finds on the rig, asked in the server's own thread.
  template <typename F>
  auto ask(F f) {
    std::promise<decltype(f(std::declval<Rig&>()))> promise;
    auto answer = promise.get_future();
    server_->post([&](Rig& rig) { promise.set_value(f(rig)); });
    return answer.get();
  }
  Alarm alarm() {
    return ask([](Rig& rig) { return rig.controller().alarm(); });
  }

  std::unique_ptr<RigServer> server_;
  std::thread thread_;
  std::unique_ptr<Robot> robot_;
  RobotReply reply_;
  std::uint64_t interruptions_ = 0;
};

TEST_P(RobotConformance, SaysWhatItCanDo) {
  serve();
  EXPECT_FALSE(robot_->capabilities().name.empty());
  EXPECT_GT(robot_->capabilities().period, 0);
}

TEST_P(RobotConformance, ConnectsWithoutMovingTheArm) {
  serve();
  connect();
  for (int i = 0; i < 5; ++i) robot_->wait(reply_);
  EXPECT_EQ(ask([](Rig& rig) { return rig.controller().arm().target(); }),
            ServoArmOptions::default_start());
}

TEST_P(RobotConformance, MovesTheArmAlongAbsoluteTargetsAtTheControllersPace) {
  serve();
  connect();
  JointVector q = reply_.q_commanded;
  const std::uint64_t before = ask([](Rig& rig) { return rig.controller().counters().cycles; });
  for (int i = 0; i < 100; ++i) {
    q[0] += 0.002;
    robot_->send(q);
    ASSERT_EQ(next(), RobotEvent::kReply);
  }
  const std::uint64_t cycles =
      ask([](Rig& rig) { return rig.controller().counters().cycles; }) - before;
  EXPECT_GE(cycles + interruptions_, 99u) << "a reply came before its cycle";
  for (int i = 0; i < 100; ++i) {
    robot_->send(q);
    ASSERT_EQ(next(), RobotEvent::kReply);
  }
  EXPECT_LT((reply_.q_measured - q).norm(), 1e-3);
  EXPECT_EQ(alarm().kind, AlarmKind::kNone);
}

TEST_P(RobotConformance, GoesOnThroughASwitchThatDrops) {
  ControllerOptions controller;
  controller.drop_share = 0.1;
  serve(controller);
  connect();
  JointVector q = reply_.q_commanded;
  int silences = 0;
  for (int i = 0; i < 150; ++i) {
    q[0] += 0.002;
    robot_->send(q);
    RobotEvent event;
    while ((event = robot_->wait(reply_)) != RobotEvent::kReply) {
      ASSERT_EQ(event, RobotEvent::kSilence);
      ++silences;
      robot_->send(q);
    }
  }
  EXPECT_GT(silences, 0);
  // A reply answers the newest target or one before it: nothing is lost for good.
  for (int i = 0; i < 60; ++i) {
    robot_->send(q);
    ASSERT_EQ(next(), RobotEvent::kReply);
  }
  EXPECT_LT((reply_.q_measured - q).norm(), 2e-3);
  EXPECT_EQ(alarm().kind, AlarmKind::kNone);
}

TEST_P(RobotConformance, LosesTheSessionWhenAnAlarmSilencesTheController) {
  serve();
  connect();
  JointVector q = reply_.q_commanded;
  q[0] += 1.0;
  robot_->send(q);
  int silences = 0;
  RobotEvent event;
  while ((event = robot_->wait(reply_)) == RobotEvent::kSilence) ++silences;
  EXPECT_EQ(event, RobotEvent::kLost);
  EXPECT_EQ(silences, 210);
  EXPECT_EQ(alarm().kind, AlarmKind::kOverSpeed);
  EXPECT_EQ(robot_->wait(reply_), RobotEvent::kLost);
  // After the operator's reset the same driver connects again.
  ask([](Rig& rig) {
    rig.controller().reset_alarm();
    return true;
  });
  connect();
}

TEST_P(RobotConformance, ReportsTheCyclesTheControllerWaited) {
  serve();
  connect();
  robot_->send(reply_.q_commanded);
  ASSERT_EQ(next(), RobotEvent::kReply);
  const std::uint64_t cycle = ask([](Rig& rig) { return rig.controller().counters().cycles; });
  while (ask([](Rig& rig) { return rig.controller().counters().cycles; }) < cycle + 6) {
    std::this_thread::yield();
  }
  robot_->send(reply_.q_commanded);
  // On a busy machine an earlier answer may come first, and this one with a silence.
  for (int i = 0; i < 10 && reply_.missed_cycles < 5; ++i) {
    if (robot_->wait(reply_) == RobotEvent::kSilence) robot_->ask();
  }
  EXPECT_GE(reply_.missed_cycles, 5u);
}

TEST_P(RobotConformance, EndsTheSessionAndSafelyTwice) {
  serve();
  connect();
  robot_->end();
  robot_->end();
  while (ask([](Rig& rig) { return rig.controller().session().has_value(); })) {
    std::this_thread::yield();
  }
  EXPECT_EQ(robot_->wait(reply_), RobotEvent::kLost);
  robot_->send(reply_.q_measured);
  connect();
}

TEST_P(RobotConformance, SaysWhoDidNotAnswer) {
  serve();
  const std::uint16_t port = server_->robot_port();
  server_->stop();
  thread_.join();
  const Status connected = robot_->connect(20 * kMillisecond, reply_);
  ASSERT_FALSE(connected);
  EXPECT_NE(connected.message().find("127.0.0.1:" + std::to_string(port)), std::string::npos)
      << connected.message();
}

INSTANTIATE_TEST_SUITE_P(
    Every, RobotConformance,
    ::testing::Values(
        RobotCase{"MelfaLong", [](std::uint16_t p) { return make_melfa(p, kMxtLong); }},
        RobotCase{"MelfaShort", [](std::uint16_t p) { return make_melfa(p, kMxtShort); }}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace handrail
