#include "devices/melfa/mxt_client.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/mxt/mxt_golden.h"
#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

using golden::Packet;

constexpr Nanos kPeriod = kMxtPeriod;

Packet copy(MxtClient::Bytes bytes) { return {bytes.begin(), bytes.end()}; }

class MxtClientTest : public ::testing::Test {
 protected:
  // With the last reply of the opening after a period.
  void open() {
    client_.start(-3 * kPeriod);
    hear_first(client_, golden::reply_long(), golden::reply_long_held());
    ASSERT_EQ(client_.on_datagram(golden::reply_long_held(), kPeriod, reply_), RobotEvent::kReply);
  }
  std::optional<RobotEvent> hear(Nanos now) {
    return client_.on_datagram(golden::reply_long(), now, reply_);
  }
  // The replies before the opening's last.
  void hear_first(MxtClient& client, const Packet& first, const Packet& second) {
    for (int i = -2; i <= 0; ++i) {
      EXPECT_EQ(client.on_datagram(i == -2 ? first : second, i * kPeriod, reply_), std::nullopt);
      EXPECT_EQ(client.poll(client.deadline(), reply_), RobotEvent::kSilence);
    }
    EXPECT_TRUE(client.opening());
  }

  MxtClient client_{MxtClientOptions{}};
  RobotReply reply_;
};

TEST_F(MxtClientTest, SpeaksTheGoldenConversation) {
  EXPECT_EQ(copy(client_.start(-3 * kPeriod)), golden::null_long());
  hear_first(client_, golden::reply_long(), golden::reply_long_held());
  EXPECT_EQ(copy(client_.packet()), golden::null_long_held(3));
  EXPECT_EQ(client_.on_datagram(golden::reply_long_held(), kPeriod, reply_), RobotEvent::kReply);
  EXPECT_EQ(reply_.q_measured, golden::kMeasured);
  EXPECT_EQ(reply_.q_commanded, golden::kTarget);
  EXPECT_EQ(reply_.missed_cycles, 3u);
  EXPECT_EQ(copy(client_.send(golden::kTarget)), golden::move_long(4));
  EXPECT_EQ(copy(client_.send(golden::kTarget)), golden::move_long(5));
  EXPECT_EQ(copy(client_.end()), golden::end_long(6));
  EXPECT_FALSE(client_.open());
}

TEST_F(MxtClientTest, SpeaksTheShortFormToOldControllers) {
  MxtClient client{MxtClientOptions{.packet_bytes = kMxtShort}};
  EXPECT_EQ(copy(client.start(-3 * kPeriod)), golden::null_short());
  hear_first(client, golden::reply_short(), golden::reply_short_held());
  EXPECT_EQ(copy(client.packet()), golden::null_short_held(3));
  EXPECT_EQ(client.on_datagram(golden::reply_short_held(), kPeriod, reply_), RobotEvent::kReply);
  EXPECT_TRUE(reply_.has_measured && reply_.has_commanded);
  EXPECT_EQ(reply_.q_measured, golden::kMeasured);
  EXPECT_EQ(reply_.q_commanded, golden::kTarget);
  EXPECT_EQ(copy(client.send(golden::kTarget)), golden::move_short(4));
  EXPECT_EQ(copy(client.end()), golden::end_short(5));
}

// A session of the short form that is open.
class ShortForm : public MxtClientTest {
 protected:
  ShortForm() {
    client_.start(-3 * kPeriod);
    hear_first(client_, golden::reply_short(), golden::reply_short_held());
    client_.on_datagram(golden::reply_short_held(), now_, reply_);
  }

  // The n-th target; what its packet asks for.
  MxtType send(int n) {
    MxtPacket packet;
    EXPECT_EQ(decode_mxt_request(client_.send(target(n)), packet), MxtParse::kOk);
    return packet.type[0];
  }
  // The reply comes in the next cycle.
  std::optional<RobotEvent> hear(MxtType type, const JointVector& q) {
    MxtPacket packet;
    packet.send_type = packet.type[0] = type;
    packet.block[0].set_joints(q);
    std::array<std::uint8_t, kMxtLong> buffer{};
    return client_.on_datagram(encode_mxt(packet, kMxtShort, buffer), now_ += kPeriod, reply_);
  }
  static JointVector target(int n) { return JointVector::Constant(0.25 * n); }
  static JointVector measured(int n) { return JointVector::Constant(0.25 * n - 0.125); }

  Nanos now_ = kPeriod;
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
  now_ += kPeriod;
  EXPECT_EQ(send(2), MxtType::kJoint) << "a reply is missing";
  EXPECT_EQ(hear(MxtType::kFeedbackJoint, measured(1)), RobotEvent::kReply);
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

TEST_F(MxtClientTest, ACycleWithoutAReplyIsToldWhileAPacketCanStillCome) {
  open();
  client_.send(golden::kTarget);
  const Nanos deadline = 3 * kPeriod - kPeriod / 8;
  EXPECT_EQ(client_.deadline(), deadline);
  EXPECT_EQ(client_.poll(deadline - 1, reply_), std::nullopt);
  EXPECT_EQ(client_.poll(deadline, reply_), RobotEvent::kSilence);
  EXPECT_FALSE(reply_.fresh);
  EXPECT_EQ(reply_.cycles, 1);
  EXPECT_EQ(client_.poll(deadline, reply_), std::nullopt) << "one event a cycle";
  EXPECT_EQ(client_.poll(deadline + kPeriod, reply_), RobotEvent::kSilence);
  EXPECT_EQ(client_.counters().silences, 2u);
}

TEST_F(MxtClientTest, AReplyThatComesAfterItsCyclesPacketIsNoOtherCycle) {
  open();
  ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  // Of the cycle that begins at 2 kPeriod, late by all but a microsecond of a period.
  EXPECT_EQ(hear(3 * kPeriod - 1000), std::nullopt);
  EXPECT_EQ(client_.counters().late, 1u);
  EXPECT_EQ(hear(3 * kPeriod + 1000), RobotEvent::kReply);
  EXPECT_EQ(reply_.cycles, 1);
}

// A computer, or the way, that stood still for a while: what comes together answers the cycles that
// were silent. Taken for the next cycle's, one would have a second packet sent before that begins,
// and none after.
TEST_F(MxtClientTest, RepliesThatComeTogetherBeginNoCycleThatHasNotBegun) {
  const auto at = [](int cycle) { return cycle * kPeriod + 50 * kMicrosecond; };
  for (const int n : {10, 100}) {  // while the phase is new, and once it is found
    open();
    for (int i = 2; i <= n; ++i) ASSERT_EQ(hear(at(i)), RobotEvent::kReply);
    for (int i = 0; i < 2; ++i) {
      ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
    }
    // Both in the last twentieth of the second cycle, for which a packet has been sent.
    for (const int early : {300, 290}) {
      EXPECT_EQ(hear(at(n + 3) - early * kMicrosecond), std::nullopt) << n;
    }
    EXPECT_EQ(hear(at(n + 3)), RobotEvent::kReply);
    EXPECT_EQ(reply_.cycles, 1);
  }
  // One that comes twice, the second time so late.
  EXPECT_EQ(hear(at(104) - 300 * kMicrosecond), std::nullopt);
  EXPECT_EQ(hear(at(104)), RobotEvent::kReply);
}

// The first may be an earlier one, late: it only tells where the cycles begin.
TEST_F(MxtClientTest, RepliesThatWereLateForHalfASecondAreHeardWhenTheyComeInTimeAgain) {
  open();
  for (int i = 2; i <= 400; ++i) {
    const Nanos now = i * kPeriod + (i > 150 && i <= 300 ? kMillisecond : 0);
    auto event = hear(now);
    if (i == 301 && !event && client_.deadline() < 302 * kPeriod) {
      event = client_.poll(client_.deadline(), reply_);
    }
    ASSERT_EQ(event, i == 301 ? RobotEvent::kSilence : RobotEvent::kReply) << i;
    ASSERT_TRUE(reply_.fresh && reply_.cycles == 1) << i;
  }
}

TEST_F(MxtClientTest, ALateReplyIsFreshInTheNextCycle) {
  open();
  ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  ASSERT_EQ(hear(3 * kPeriod - 1000), std::nullopt);
  EXPECT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  EXPECT_TRUE(reply_.fresh);
}

TEST_F(MxtClientTest, FindsThePhaseAgainWithoutLeavingOutACycle) {
  // The first reply was read late and the second is lost: the others come just before their cycles.
  const Nanos read_late = 500 * kMicrosecond;
  client_.start(-3 * kPeriod);
  hear_first(client_, golden::reply_long(), golden::reply_long_held());
  ASSERT_EQ(client_.on_datagram(golden::reply_long_held(), kPeriod + read_late, reply_),
            RobotEvent::kReply);
  ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  int in_time = 0;
  for (int i = 3; i < 100; ++i) {
    // Between two cycles of the controller one packet is sent.
    const Nanos at = i * kPeriod;
    const bool replied = hear(at) == RobotEvent::kReply;
    in_time = replied ? in_time + 1 : 0;
    if (replied) {
      ASSERT_GE(client_.deadline(), at + kPeriod) << i;
    } else {
      ASSERT_LT(client_.deadline(), at + kPeriod) << i;
      ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence) << i;
    }
    ASSERT_EQ(reply_.cycles, 1) << i;
  }
  EXPECT_GT(in_time, 30);
}

TEST_F(MxtClientTest, AControllerThatStartedAnewHasCyclesOfItsOwn) {
  for (const Nanos phase : {Nanos{0}, kPeriod / 3, kPeriod * 15 / 16}) {
    open();
    for (int i = 0; i < 20; ++i) {
      ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
    }
    Nanos at = 22 * kPeriod + phase;
    (void)hear(at);
    for (int i = 0; i < 5; ++i) {
      at += kPeriod;
      ASSERT_EQ(hear(at), RobotEvent::kReply);
      EXPECT_EQ(reply_.cycles, 1);
    }
    // Read so late that by the old phase two cycles have begun.
    EXPECT_EQ(hear(at + kPeriod + kPeriod * 7 / 8), RobotEvent::kReply);
    EXPECT_EQ(reply_.cycles, 1) << phase;
    client_.end();
  }
}

TEST_F(MxtClientTest, CountsTheCyclesThatPassedWhileNobodyAsked) {
  open();
  EXPECT_EQ(hear(704 * kPeriod + 1000), RobotEvent::kReply);
  EXPECT_EQ(reply_.cycles, 703);
  EXPECT_EQ(client_.poll(client_.deadline() + 9 * kPeriod, reply_), RobotEvent::kSilence);
  EXPECT_EQ(reply_.cycles, 10);
}

TEST_F(MxtClientTest, KeepsUpWithAControllerOf711MillisecondsAndOneAsFast) {
  for (const Nanos period : {7'110 * kMicrosecond, 7'090 * kMicrosecond}) {
    open();
    for (int i = 1; i <= 2000; ++i) {
      const Nanos now = kPeriod + i * period;
      if (now >= client_.deadline()) {
        ADD_FAILURE() << "silent in cycle " << i;
      }
      ASSERT_EQ(hear(now), RobotEvent::kReply) << i;
      ASSERT_EQ(reply_.cycles, 1) << i;
    }
    client_.end();
  }
}

TEST_F(MxtClientTest, AQuestionMovesNothingAndAsksForTheTarget) {
  open();
  Packet question = golden::null_long();
  question[60] = 4;
  EXPECT_EQ(copy(client_.ask()), question);
  MxtClient old{MxtClientOptions{.packet_bytes = kMxtShort}};
  old.start(-3 * kPeriod);
  hear_first(old, golden::reply_short(), golden::reply_short_held());
  ASSERT_EQ(old.on_datagram(golden::reply_short_held(), kPeriod, reply_), RobotEvent::kReply);
  MxtPacket packet;
  ASSERT_EQ(decode_mxt_request(old.ask(), packet), MxtParse::kOk);
  EXPECT_EQ(packet.command, MxtCommand::kNull);
  EXPECT_EQ(packet.type[0], MxtType::kJoint);
}

TEST_F(MxtClientTest, EndsTheSessionAfterASecondAndAHalfOfSilence) {
  open();
  client_.send(golden::kTarget);
  for (int loss = 1; loss < 211; ++loss) {
    ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence) << loss;
  }
  EXPECT_NEAR(to_seconds(client_.deadline()), 1.5, 0.02);
  EXPECT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kLost);
  EXPECT_FALSE(client_.open());
  EXPECT_TRUE(client_.send(golden::kTarget).empty());
  EXPECT_TRUE(client_.ask().empty());
  EXPECT_EQ(hear(kForever), RobotEvent::kLost);
  EXPECT_EQ(client_.poll(kForever, reply_), RobotEvent::kLost);
  EXPECT_TRUE(client_.end().empty());
}

TEST_F(MxtClientTest, AReplyStartsTheCountOfLossesAnew) {
  open();
  for (int loss = 0; loss < 210; ++loss) client_.poll(client_.deadline(), reply_);
  EXPECT_EQ(hear(client_.deadline() - 1), RobotEvent::kReply);
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
    EXPECT_EQ(client_.on_datagram(bad, kPeriod + 1, untouched), RobotEvent::kRejected);
    EXPECT_TRUE(untouched.q_measured.isZero());
  }
  EXPECT_EQ(client_.counters().rejected, 6u);
  EXPECT_EQ(client_.deadline(), deadline);
}

TEST_F(MxtClientTest, TwoRepliesInOneCycleAreOneOccasionToCommand) {
  open();
  Packet twin = golden::reply_long();
  twin[58] = 0;
  EXPECT_EQ(client_.on_datagram(twin, kPeriod + kMillisecond, reply_), std::nullopt);
  EXPECT_EQ(reply_.missed_cycles, 0u) << "the newest values are the ones to use";
  EXPECT_EQ(client_.counters().late, 1u);
  EXPECT_EQ(client_.on_datagram(twin, 2 * kPeriod, reply_), RobotEvent::kReply);
}

TEST_F(MxtClientTest, IgnoresThePacketCounterOfTheReply) {
  open();
  Nanos now = kPeriod;
  for (const std::uint8_t count : Packet{0x00, 0xff, 0x01}) {
    Packet reply = golden::reply_long();
    std::fill(reply.begin() + 60, reply.begin() + 64, count);
    EXPECT_EQ(client_.on_datagram(reply, now += kPeriod, reply_), RobotEvent::kReply);
  }
}

TEST_F(MxtClientTest, FindsTheFeedbackInWhicheverBlockCarriesIt) {
  open();
  Packet swapped = golden::reply_long();
  std::swap_ranges(swapped.begin() + 8, swapped.begin() + 48, swapped.begin() + 68);
  swapped[2] = swapped[4] = 2;
  swapped[64] = 8;
  reply_ = RobotReply();
  EXPECT_EQ(client_.on_datagram(swapped, 2 * kPeriod, reply_), RobotEvent::kReply);
  EXPECT_EQ(reply_.q_measured, golden::kMeasured);
  EXPECT_EQ(reply_.q_commanded, golden::kTarget);
}

TEST_F(MxtClientTest, StartsANewSessionAfterALostOne) {
  open();
  client_.send(golden::kTarget);
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
  client_.start(-3 * kPeriod);
  for (int i = -2; i <= 1; ++i) {
    client_.on_datagram(i == -2 ? reply : second, i * kPeriod, reply_);
    client_.poll(client_.deadline(), reply_);
  }
  client_.send(golden::kTarget);
  client_.poll(client_.deadline(), reply_);
  client_.end();
}

}  // namespace
}  // namespace handrail
