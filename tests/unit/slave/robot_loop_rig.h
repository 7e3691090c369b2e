// The robot thread's work against a scripted robot, under a manual clock: what its tests share.
#pragma once

#include "server/slave/robot_loop.h"

#include <gtest/gtest.h>

#include <deque>
#include <optional>

#include "server/link/stall_watch.h"
#include "tests/support/no_allocation.h"

namespace handrail::test {

inline constexpr Nanos kPeriod = 7'100'000;

inline Nanos now_value = 0;
inline Nanos manual_now() noexcept { return now_value; }

// Answers from a script, then with a reply a period. Its arm is where it was last told to be.
class ScriptedRobot : public Robot {
 public:
  const RobotCapabilities& capabilities() const override { return capabilities_; }
  Status connect(Nanos patience, RobotReply& first) override {
    ++connects;
    if (!present) {
      now_value += patience + kPeriod;  // the last wait goes on for a cycle
      return Status::error("no answer");
    }
    open = true;
    first.q_measured = first.q_commanded = q;
    if (measured) first.q_measured = *measured;
    first.has_measured = first.has_commanded = true;
    return Status::ok();
  }
  RobotEvent wait(RobotReply& reply) noexcept override {
    EXPECT_TRUE(open);
    now_value += kPeriod;
    RobotEvent event = RobotEvent::kReply;
    if (!script.empty()) {
      event = script.front();
      script.pop_front();
    }
    if (event == RobotEvent::kLost) open = false;
    reply.fresh = reply.prompt = event == RobotEvent::kReply;
    reply.has_measured = reply.has_commanded = true;
    reply.cycles = cycles;
    reply.anew = anew;
    if (reply.fresh) reply.q_measured = reply.q_commanded = q;
    return event;
  }
  void ask() noexcept override { ++asks; }
  void send(const JointVector& q_target) noexcept override {
    EXPECT_TRUE(open);
    ++sends;
    if (deaf) return;
    largest_step = std::max(largest_step, (q_target - q).cwiseAbs().maxCoeff());
    q = q_target;
  }
  void end() noexcept override {
    ++ends;
    open = false;
  }

  RobotCapabilities capabilities_{"scripted arm", kPeriod};
  JointVector q = (JointVector() << 0, 0, 1.5707963, 0, 1.5707963, 0).finished();
  std::deque<RobotEvent> script;
  bool present = true;
  bool open = false;
  int connects = 0;
  int sends = 0;
  int asks = 0;
  int cycles = 1;                       // between two events
  bool deaf = false;                    // what is sent is lost
  bool anew = false;                    // it may be another controller
  std::optional<JointVector> measured;  // at connecting, where it is not `q`
  int ends = 0;
  double largest_step = 0.0;
};

class ScriptedCircuit final : public StopCircuit {
 public:
  bool is_open() noexcept override { return open; }
  bool open = false;
};

inline FollowSettings settings() {
  FollowSettings s;
  s.scene = scene_name("first");
  return s;
}

class RobotLoopTest : public ::testing::Test {
 protected:
  RobotLoopTest() {
    now_value = 1000 * kSecond;
    news.link.received_of_100 = news.link.peer_received_of_100 = 100;
    news.state.scene = settings().scene;
  }

  // Five turns, before each of which `reading` comes, `age` old as it is taken [ns].
  void turn_with(ForceReading reading, Nanos age) {
    for (int i = 0; i < 5; ++i) {
      reading.received_at = now_value + kPeriod - age;
      boxes.force.publish(reading);
      turn();
    }
  }
  // One turn with the master's state freshly received, and what the slave then says.
  const SlaveState& turn(bool fresh = true) {
    if (fresh) {
      news.link.received_at = news.link.echoed_sent = now_value + kPeriod;
      boxes.master.publish(news);
    }
    const Nanos next = loop.turn();
    now_value = std::max(now_value, next);
    (void)boxes.report.take(report);
    state = report.state;
    return state;
  }

  // Goes through alignment to engagement, as a master would.
  void engage() {
    news.link.peer_epoch = 1;
    turn();
    turn();
    news.state.desired = Desired::kEngaged;
    news.state.state = SessionState::kAligning;
    news.state.X_SU = state.X_ST_command;
    news.state.has_command = true;
    for (int i = 0; i < 5 && turn().state != SessionState::kEngaged; ++i) {
    }
    ASSERT_EQ(state.state, SessionState::kEngaged) << describe(state.reason);
    news.state.state = SessionState::kEngaged;
  }

  SlaveMailboxes boxes;
  ScriptedRobot robot;
  ScriptedCircuit circuit;
  RobotLoop loop{robot, settings(), boxes, manual_now, nullptr, &circuit};
  MasterNews news;
  SlaveReport report;
  SlaveState state;
};

}  // namespace handrail::test
