// The gripper's outputs in packets written by hand, and what replies say of them.
#include "devices/melfa/mxt_gripper.h"

#include <gtest/gtest.h>

#include "tests/unit/melfa/mxt_client_rig.h"

namespace handrail {
namespace {

using golden::Packet;

// Outputs are set, and all sixteen from 900 (0x384) on are to be read back.
Packet with_outputs(Packet packet, std::uint8_t mask, std::uint8_t data) {
  const Packet io{1, 0, 1, 0, 0x84, 0x03, mask, 0, data, 0};
  std::copy(io.begin(), io.end(), packet.begin() + 48);
  return packet;
}

class MxtGripperTest : public MxtClientTest {
 protected:
  MxtGripperTest() {
    MxtClientOptions options;
    options.gripper = {.close = 900, .open = 901};
    client_ = MxtClient(options);
  }
  GripperState hear_outputs(std::uint8_t of, std::uint8_t top, std::uint8_t data) {
    Packet reply = golden::reply_long();
    const Packet io{of, 0, 0, 0, top, 0x03, 0, 0, data, 0};
    std::copy(io.begin(), io.end(), reply.begin() + 48);
    now_ += kMxtPeriod;
    (void)client_.on_datagram(reply, now_, reply_);
    return reply_.gripper;
  }
  Nanos now_ = kMxtPeriod;
};

TEST_F(MxtGripperTest, APacketThatOpensASessionSaysNothingOfIt) {
  client_.grip(Grip::kClosed);
  EXPECT_EQ(copy(client_.start(-3 * kMxtPeriod)), golden::null_long());
  hear_first(client_, golden::reply_long(), golden::reply_long_held());
  EXPECT_EQ(copy(client_.packet()), golden::null_long_held(3));
}

TEST_F(MxtGripperTest, EveryOtherSaysWhatItIsToBe) {
  open();
  EXPECT_EQ(copy(send(golden::kTarget)), with_outputs(golden::move_long(4), 0, 0));
  client_.grip(Grip::kClosed);
  EXPECT_EQ(copy(send(golden::kTarget)), with_outputs(golden::move_long(5), 3, 1));
  EXPECT_EQ(copy(send(golden::kTarget)), with_outputs(golden::move_long(6), 3, 1));
  client_.grip(Grip::kOpen);
  EXPECT_EQ(copy(send(golden::kTarget)), with_outputs(golden::move_long(7), 3, 2));
  client_.grip(Grip::kAsItIs);
  EXPECT_EQ(copy(send(golden::kTarget)), with_outputs(golden::move_long(8), 0, 0));
  EXPECT_EQ(copy(client_.end()), golden::end_long(9));
}

TEST_F(MxtGripperTest, ARepliesOutputsSayHowItIs) {
  open();
  EXPECT_EQ(reply_.gripper, GripperState::kNone);
  EXPECT_EQ(hear_outputs(1, 0x84, 1), GripperState::kClosed);
  EXPECT_EQ(hear_outputs(1, 0x84, 2 + 8), GripperState::kOpen) << "others are not its own";
  EXPECT_EQ(hear_outputs(1, 0x84, 3), GripperState::kBetween);
  EXPECT_EQ(hear_outputs(1, 0x84, 1), GripperState::kClosed);
  EXPECT_EQ(hear_outputs(2, 0x84, 2), GripperState::kClosed) << "inputs say nothing";
  EXPECT_EQ(hear_outputs(1, 0x85, 2), GripperState::kClosed) << "nor do other outputs";
  EXPECT_EQ(hear_outputs(1, 0x84, 0), GripperState::kBetween);
}

TEST(MxtGripper, OneThatSpringsBackHasOneOutput) {
  const MxtGripper valve{.close = 7, .open = {}};
  EXPECT_EQ(io_of(valve, Grip::kClosed).bit_top, 7);
  EXPECT_EQ(io_of(valve, Grip::kClosed).bit_mask, 1);
  EXPECT_EQ(io_of(valve, Grip::kClosed).data, 1);
  EXPECT_EQ(io_of(valve, Grip::kOpen).bit_mask, 1);
  EXPECT_EQ(io_of(valve, Grip::kOpen).data, 0);
  EXPECT_EQ(io_of(valve, Grip::kAsItIs).bit_mask, 0);
  MxtIo io{.send_type = 1, .bit_top = 7};
  EXPECT_EQ(state_of(valve, io), GripperState::kOpen);
  io.data = 1;
  EXPECT_EQ(state_of(valve, io), GripperState::kClosed);
}

// The output that opens may have the lower number.
TEST(MxtGripper, TheWordBeginsAtTheLowerOutput) {
  const MxtGripper gripper{.close = 915, .open = 900};
  const MxtIo io = io_of(gripper, Grip::kClosed);
  EXPECT_EQ(io.bit_top, 900);
  EXPECT_EQ(io.bit_mask, 0x8001);
  EXPECT_EQ(io.data, 0x8000);
  EXPECT_EQ(io_of(gripper, Grip::kOpen).data, 1);
}

// Without one, nothing is set and nothing is read.
TEST_F(MxtClientTest, WithoutAGripperOutputsAreLeftAlone) {
  open();
  client_.grip(Grip::kClosed);
  EXPECT_EQ(copy(send(golden::kTarget)), golden::move_long(4));
  Packet reply = golden::reply_long();
  reply[48] = 1;
  (void)client_.on_datagram(reply, 2 * kMxtPeriod, reply_);
  EXPECT_EQ(reply_.gripper, GripperState::kNone);
}

}  // namespace
}  // namespace handrail
