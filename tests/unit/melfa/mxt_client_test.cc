#include "devices/melfa/mxt_client.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/mxt/mxt_golden.h"
#include "tests/support/no_allocation.h"
#include "tests/unit/melfa/mxt_client_rig.h"

namespace handrail {
namespace {

using golden::Packet;

TEST_F(MxtClientTest, SpeaksTheGoldenConversation) {
  EXPECT_EQ(copy(client_.start(-3 * kMxtPeriod)), golden::null_long());
  hear_first(client_, golden::reply_long(), golden::reply_long_held());
  EXPECT_EQ(copy(client_.packet()), golden::null_long_held(3));
  EXPECT_EQ(client_.on_datagram(golden::reply_long_held(), kMxtPeriod, reply_), RobotEvent::kReply);
  EXPECT_EQ(reply_.q_measured, golden::kMeasured);
  EXPECT_EQ(reply_.q_commanded, golden::kTarget);
  EXPECT_EQ(reply_.missed_cycles, 3u);
  EXPECT_EQ(copy(send(golden::kTarget)), golden::move_long(4));
  EXPECT_EQ(copy(send(golden::kTarget)), golden::move_long(5));
  EXPECT_EQ(copy(client_.end()), golden::end_long(6));
  EXPECT_FALSE(client_.open());
}

TEST_F(MxtClientTest, SpeaksTheShortFormToOldControllers) {
  MxtClient client{MxtClientOptions{.packet_bytes = kMxtShort}};
  EXPECT_EQ(copy(client.start(-3 * kMxtPeriod)), golden::null_short());
  hear_first(client, golden::reply_short(), golden::reply_short_held());
  EXPECT_EQ(copy(client.packet()), golden::null_short_held(3));
  EXPECT_EQ(client.on_datagram(golden::reply_short_held(), kMxtPeriod, reply_), RobotEvent::kReply);
  EXPECT_TRUE(reply_.has_measured && reply_.has_commanded);
  EXPECT_EQ(reply_.q_measured, golden::kMeasured);
  EXPECT_EQ(reply_.q_commanded, golden::kTarget);
  EXPECT_EQ(copy(client.send(golden::kTarget, kMxtPeriod)), golden::move_short(4));
  EXPECT_EQ(copy(client.end()), golden::end_short(5));
}

// A session of the short form that is open.
class ShortForm : public MxtClientTest {
 protected:
  ShortForm() {
    client_.start(-3 * kMxtPeriod);
    hear_first(client_, golden::reply_short(), golden::reply_short_held());
    client_.on_datagram(golden::reply_short_held(), now_, reply_);
  }

  // The n-th target; what its packet asks for.
  MxtType send(int n) {
    MxtPacket packet;
    EXPECT_EQ(decode_mxt_request(client_.send(target(n), now_), packet), MxtParse::kOk);
    return packet.type[0];
  }
  // The reply comes in the next cycle.
  std::optional<RobotEvent> hear(MxtType type, const JointVector& q) {
    MxtPacket packet;
    packet.send_type = packet.type[0] = type;
    packet.block[0].set_joints(q);
    std::array<std::uint8_t, kMxtLong> buffer{};
    return client_.on_datagram(encode_mxt(packet, kMxtShort, buffer), now_ += kMxtPeriod, reply_);
  }
  static JointVector target(int n) { return JointVector::Constant(0.25 * n); }
  static JointVector measured(int n) { return JointVector::Constant(0.25 * n - 0.125); }

  Nanos now_ = kMxtPeriod;
  MxtClient client_{MxtClientOptions{.packet_bytes = kMxtShort}};
};

TEST_F(ShortForm, MeasuredJointsMeanThatTheTargetOfTheirPacketWasTaken) {
  for (int n = 1; n < 5; ++n) {
    EXPECT_EQ(send(n), MxtType::kFeedbackJoint);
    EXPECT_EQ(hear(MxtType::kFeedbackJoint, measured(n)), RobotEvent::kReply);
    EXPECT_EQ(reply_.q_measured, measured(n));
    EXPECT_TRUE(reply_.has_commanded);
    EXPECT_EQ(reply_.q_commanded, target(n));
  }
}

TEST_F(ShortForm, AReplyThatComesTwiceDoesNotStandForTheNextTarget) {
  send(1);
  hear(MxtType::kFeedbackJoint, measured(1));
  send(2);
  EXPECT_EQ(hear(MxtType::kFeedbackJoint, measured(1)), RobotEvent::kReply);
  EXPECT_TRUE(reply_.has_measured);
  EXPECT_FALSE(reply_.has_commanded);
  for (int n = 3; n < 6; ++n) {
    EXPECT_EQ(send(n), MxtType::kJoint) << n;
    EXPECT_EQ(hear(MxtType::kJoint, target(n - 1)), RobotEvent::kReply);
    EXPECT_FALSE(reply_.has_measured);
    EXPECT_EQ(reply_.q_commanded, target(n - 1)) << "as the controller says";
  }
  EXPECT_EQ(send(6), MxtType::kFeedbackJoint);
}

TEST_F(ShortForm, AReplyThatIsOverdueDoesNotStandForTheNextTarget) {
  send(1);
  EXPECT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  EXPECT_FALSE(reply_.fresh);
  now_ += kMxtPeriod;
  EXPECT_EQ(send(2), MxtType::kJoint) << "a reply is missing";
  EXPECT_EQ(hear(MxtType::kFeedbackJoint, measured(1)), std::nullopt) << "it tells of no cycle";
  EXPECT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  EXPECT_TRUE(reply_.has_measured);
  EXPECT_FALSE(reply_.has_commanded);
  EXPECT_EQ(send(3), MxtType::kJoint);
}

TEST_F(ShortForm, AnArmThatStandsNeedNotMeasureDifferently) {
  for (int n = 0; n < 5; ++n) {
    EXPECT_EQ(send(1), MxtType::kFeedbackJoint);
    hear(MxtType::kFeedbackJoint, measured(1));
    EXPECT_TRUE(reply_.has_commanded);
  }
}

TEST_F(MxtClientTest, AQuestionMovesNothingAndAsksForTheTarget) {
  open();
  Packet question = golden::null_long();
  question[60] = 4;
  EXPECT_EQ(copy(client_.ask()), question);
  MxtClient old{MxtClientOptions{.packet_bytes = kMxtShort}};
  old.start(-3 * kMxtPeriod);
  hear_first(old, golden::reply_short(), golden::reply_short_held());
  ASSERT_EQ(old.on_datagram(golden::reply_short_held(), kMxtPeriod, reply_), RobotEvent::kReply);
  MxtPacket packet;
  ASSERT_EQ(decode_mxt_request(old.ask(), packet), MxtParse::kOk);
  EXPECT_EQ(packet.command, MxtCommand::kNull);
  EXPECT_EQ(packet.type[0], MxtType::kJoint);
}

TEST_F(MxtClientTest, EndsTheSessionAfterASecondAndAHalfOfSilence) {
  open();
  send(golden::kTarget);
  for (int loss = 1; loss < 211; ++loss) {
    ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence) << loss;
  }
  EXPECT_NEAR(to_seconds(client_.deadline()), 1.5, 0.02);
  EXPECT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kLost);
  EXPECT_FALSE(client_.open());
  EXPECT_TRUE(send(golden::kTarget).empty());
  EXPECT_TRUE(client_.ask().empty());
  EXPECT_EQ(hear(kForever), RobotEvent::kLost);
  EXPECT_EQ(client_.poll(kForever, reply_), RobotEvent::kLost);
  EXPECT_TRUE(client_.end().empty());
}

TEST_F(MxtClientTest, AReplyStartsTheCountOfLossesAnew) {
  open();
  for (int loss = 0; loss < 210; ++loss) client_.poll(client_.deadline(), reply_);
  EXPECT_EQ(hear(client_.deadline() - 1), std::nullopt) << "where its cycles begin is not known";
  for (int loss = 1; loss < 211; ++loss) {
    ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence) << loss;
  }
  EXPECT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kLost);
}

TEST_F(MxtClientTest, DropsWrongPacketsWithoutTouchingTheReplyOrTheDeadline) {
  open();
  const Nanos deadline = client_.deadline();
  Packet pose = golden::reply_long();
  pose[2] = pose[4] = 7;
  Packet nan = golden::reply_long();
  nan[10] = 0xc0;
  nan[11] = 0x7f;
  const Packet garbage{1, 2, 3};
  for (const Packet& bad :
       {golden::reply_short(), pose, nan, garbage, Packet{}, Packet(196, 0xff)}) {
    RobotReply untouched;
    EXPECT_EQ(client_.on_datagram(bad, kMxtPeriod + 1, untouched), RobotEvent::kRejected);
    EXPECT_TRUE(untouched.q_measured.isZero());
  }
  EXPECT_EQ(client_.counters().rejected, 6u);
  EXPECT_EQ(client_.deadline(), deadline);
}

TEST_F(MxtClientTest, TwoRepliesInOneCycleAreOneOccasionToCommand) {
  open();
  Packet twin = golden::reply_long();
  twin[58] = 0;
  EXPECT_EQ(client_.on_datagram(twin, kMxtPeriod + kMillisecond, reply_), std::nullopt);
  EXPECT_EQ(reply_.missed_cycles, 0u) << "the newest values are the ones to use";
  EXPECT_EQ(client_.counters().late, 1u);
  EXPECT_EQ(client_.on_datagram(twin, 2 * kMxtPeriod, reply_), RobotEvent::kReply);
}

TEST_F(MxtClientTest, IgnoresThePacketCounterOfTheReply) {
  open();
  Nanos now = kMxtPeriod;
  for (const std::uint8_t count : Packet{0x00, 0xff, 0x01}) {
    Packet reply = golden::reply_long();
    std::fill(reply.begin() + 60, reply.begin() + 64, count);
    EXPECT_EQ(client_.on_datagram(reply, now += kMxtPeriod, reply_), RobotEvent::kReply);
  }
}

TEST_F(MxtClientTest, FindsTheFeedbackInWhicheverBlockCarriesIt) {
  open();
  Packet swapped = golden::reply_long();
  std::swap_ranges(swapped.begin() + 8, swapped.begin() + 48, swapped.begin() + 68);
  swapped[2] = swapped[4] = 2;
  swapped[64] = 8;
  reply_ = RobotReply();
  EXPECT_EQ(client_.on_datagram(swapped, 2 * kMxtPeriod, reply_), RobotEvent::kReply);
  EXPECT_EQ(reply_.q_measured, golden::kMeasured);
  EXPECT_EQ(reply_.q_commanded, golden::kTarget);
}

TEST_F(MxtClientTest, StartsANewSessionAfterALostOne) {
  open();
  send(golden::kTarget);
  while (client_.poll(client_.deadline(), reply_) != RobotEvent::kLost) {
  }
  EXPECT_EQ(copy(client_.start(3 * kSecond)), golden::null_long());
  EXPECT_TRUE(client_.opening());
  client_.end();
  open();
  EXPECT_FALSE(client_.opening());
}

TEST_F(MxtClientTest, DoesNotAllocate) {
  const Packet reply = golden::reply_long(), second = golden::reply_long_held();
  test::NoAllocation guard("an MXT cycle");
  client_.start(-3 * kMxtPeriod);
  for (int i = -2; i <= 1; ++i) {
    client_.on_datagram(i == -2 ? reply : second, i * kMxtPeriod, reply_);
    client_.poll(client_.deadline(), reply_);
  }
  send(golden::kTarget);
  client_.poll(client_.deadline(), reply_);
  client_.end();
}

}  // namespace
}  // namespace handrail
