// A client whose session is open, and replies for it.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <optional>

#include "devices/melfa/mxt_client.h"
#include "tests/support/mxt/mxt_golden.h"

namespace handrail {

inline golden::Packet copy(MxtClient::Bytes bytes) { return {bytes.begin(), bytes.end()}; }

class MxtClientTest : public ::testing::Test {
 protected:
  // With the last reply of the opening after a period.
  void open() {
    client_.start(-3 * kMxtPeriod);
    hear_first(client_, golden::reply_long(), golden::reply_long_held());
    ASSERT_EQ(client_.on_datagram(golden::reply_long_held(), kMxtPeriod, reply_),
              RobotEvent::kReply);
  }
  // In good time for its cycle.
  MxtClient::Bytes send(const JointVector& q) {
    return client_.send(q, client_.deadline() - kMxtPeriod);
  }
  std::optional<RobotEvent> hear(Nanos now) {
    return client_.on_datagram(golden::reply_long(), now, reply_);
  }
  // The n-th target, which the wire rounds, and a reply that says the controller holds it.
  static JointVector target(int n) { return JointVector::Constant(n / 1000.0); }
  std::optional<RobotEvent> hear_held(int n, Nanos now) {
    MxtPacket packet;
    packet.type = {MxtType::kFeedbackJoint, MxtType::kJoint};
    packet.send_type = packet.type[0];
    packet.block[1].set_joints(target(n));
    std::array<std::uint8_t, kMxtLong> buffer{};
    return client_.on_datagram(encode_mxt(packet, kMxtLong, buffer), now, reply_);
  }
  // The replies before the opening's last, which is to come at kMxtPeriod + `late`.
  void hear_first(MxtClient& client, const golden::Packet& first, const golden::Packet& second,
                  Nanos late = 0) {
    for (int i = -2; i <= 0; ++i) {
      const Nanos at = i * kMxtPeriod + late;
      EXPECT_EQ(client.on_datagram(i == -2 ? first : second, at, reply_), std::nullopt);
      EXPECT_EQ(client.poll(client.deadline(), reply_), RobotEvent::kSilence);
    }
    EXPECT_TRUE(client.opening());
  }

  MxtClient client_{MxtClientOptions{}};
  RobotReply reply_;
};

}  // namespace handrail
