// What the controller's tests share: a controller on its cycle, and packets to feed it.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "devices/rig/controller.h"
#include "server/base/units.h"

namespace handrail::test {

inline constexpr PeerId kPc = 0x7f0000019c40;

struct ControllerBench {
  explicit ControllerBench(ControllerOptions options = quiet()) : controller(options) {
    controller.tick(now);
  }

  static ControllerOptions quiet() {
    ControllerOptions options;
    options.arm.repeatability = 0.0;
    return options;
  }

  void feed(const MxtPacket& packet, std::size_t size = kMxtLong, PeerId from = kPc) {
    std::array<std::uint8_t, kMxtLong> buffer;
    controller.on_datagram(encode_mxt(packet, size, buffer), from);
  }
  void feed_null(std::size_t size = kMxtLong, PeerId from = kPc) {
    MxtPacket packet;
    packet.type = {MxtType::kFeedbackJoint, MxtType::kJoint};
    feed(packet, size, from);
  }
  void feed_move(const JointVector& q, std::size_t size = kMxtLong, PeerId from = kPc) {
    feed(move(q), size, from);
  }
  static MxtPacket move(const JointVector& q) {
    MxtPacket packet;
    packet.command = MxtCommand::kMove;
    packet.send_type = MxtType::kJoint;
    packet.type = {MxtType::kFeedbackJoint, MxtType::kJoint};
    packet.block[0].set_joints(q);
    return packet;
  }
  void feed_end() {
    MxtPacket packet;
    packet.command = MxtCommand::kEnd;
    feed(packet);
  }
  // One control cycle; how many replies it sent.
  std::size_t tick() {
    now += kMxtPeriod;
    controller.tick(now);
    return controller.replies().size();
  }
  // The only reply of the last cycle.
  MxtPacket reply() {
    MxtPacket packet;
    EXPECT_EQ(controller.replies().size(), 1u);
    if (controller.replies().empty()) return packet;
    EXPECT_EQ(decode_mxt_reply(controller.replies()[0].bytes(), packet), MxtParse::kOk);
    return packet;
  }
  void open() {
    feed_null();
    ASSERT_EQ(tick(), 1u);
  }
  static JointVector start() { return ServoArmOptions::default_start(); }
  static JointVector start_with(int joint, double value) {
    JointVector q = start();
    q[joint] = value;
    return q;
  }

  Nanos now = 5 * kSecond;
  Controller controller;
};

}  // namespace handrail::test
