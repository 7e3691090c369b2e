// The haptic loop between a scripted device and a slave that the test plays, on a manual clock.
#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "server/master/haptic_loop.h"
#include "tests/unit/master/scripted_device.h"

namespace handrail {

class LoopBench : public ::testing::Test {
 protected:
  LoopBench() {
    settings.mapping.scale = 2.0;
    settings.scene = scene_name("first");
    news.state.scene = settings.scene;
    news.state.X_ST.p = Vec3(0.35, 0.05, 0.43);
    news.state.X_ST_command = news.state.X_ST;
    news.state.has_pose = true;
    news.link.peer_epoch = 1;
    news.link.received_of_100 = news.link.peer_received_of_100 = 100;
    loop.emplace(device, LoopScene{settings}, boxes, now);
  }

  // One tick `step` after the last one, with the slave's fresh answer to what the last one said.
  const HapticReport& tick(Nanos step = kMillisecond) {
    now += step;
    if (slave_talks) {
      news.link.received_at = news.link.echoed_sent = now;
      boxes.slave.publish(news);
    }
    loop->tick(now);
    (void)boxes.report.take(report);
    play_slave();
    return report;
  }
  void ticks(int n) {
    for (int i = 0; i < n; ++i) tick();
  }

  void push(std::uint64_t id, OrderKind kind) {
    OrderTicket ticket;
    ticket.id = id;
    ticket.order.kind = kind;
    ASSERT_TRUE(boxes.orders.push(ticket));
  }
  // Result of order `id` if that is the next answer.
  std::optional<Reason> answer(std::uint64_t id) {
    OrderAnswer next;
    if (!boxes.answers.pop(next) || next.id != id) return std::nullopt;
    return next.result;
  }
  void engage() {
    ticks(2);
    push(1, OrderKind::kEngage);
    ticks(6);
    ASSERT_EQ(answer(1), Reason::kNone);
    ASSERT_EQ(report.out.link.state, SessionState::kEngaged);
  }
  // Engages, calls a line along S's X and takes the hand off it until there is force.
  void pull_off_a_line() {
    engage();
    OrderTicket line;
    line.id = 2;
    line.order.kind = OrderKind::kTool;
    line.order.tool.kind = ToolKind::kLine;
    line.order.tool.direction_S = Vec3::UnitX();
    ASSERT_TRUE(boxes.orders.push(line));
    tick();
    ASSERT_EQ(answer(2), Reason::kNone);
    for (int i = 0; i < 100; ++i) {
      device.sample.X_MH.p.x() += 2e-5;  // the device's right is the base's -Y
      tick();
    }
    ticks(20);
    ASSERT_GT(report.out.f_H_M.force.norm(), 0.5);
  }

  MasterMailboxes boxes;
  ScriptedDevice device;
  HapticSettings settings;
  SlaveNews news;
  bool slave_talks = true;
  Nanos now = 1000 * kSecond;
  HapticReport report;
  std::optional<HapticLoop> loop;

 private:
  void play_slave() {
    const MasterState& master = report.out.link;
    SlaveState& slave = news.state;
    slave.engagement_epoch = master.engagement_epoch;
    if (slave.state == SessionState::kFault) return;
    if (master.desired == Desired::kOff) {
      slave.state = SessionState::kOff;
    } else if (master.state == SessionState::kAligning && master.has_command) {
      slave.state = SessionState::kEngaged;
    } else if (master.state == SessionState::kEngaged) {
      slave.X_ST = slave.X_ST_command = master.X_SU;
    }
  }
};

}  // namespace handrail
