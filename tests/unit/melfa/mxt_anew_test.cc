// After a silence it may be another controller, with cycles of its own.
#include "tests/unit/melfa/mxt_client_rig.h"

namespace handrail {
namespace {

using golden::Packet;

class MxtAnew : public MxtClientTest {};

TEST_F(MxtAnew, AfterATenthOfASecondOfSilenceThePhaseIsFoundBeforeAnythingIsSaid) {
  for (const Nanos phase : {Nanos{0}, kMxtPeriod / 3, kMxtPeriod * 15 / 16}) {
    SCOPED_TRACE(to_seconds(phase));
    open();
    for (int i = 0; i < 20; ++i) {
      ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
      EXPECT_EQ(client_.opening(), i >= 14) << i;
    }
    Packet question = golden::null_long();
    question[60] = 9;
    EXPECT_EQ(copy(client_.packet()), question);
    EXPECT_TRUE(client_.send(golden::kTarget, client_.deadline() - kMxtPeriod).empty());
    EXPECT_TRUE(client_.ask().empty());
    // The third one is read 3 ms late, and counts against the two before.
    Nanos at = 22 * kMxtPeriod + phase;
    int heard = 0;
    for (;; at += kMxtPeriod) {
      ASSERT_LT(++heard, 20);
      const Nanos late = heard == 3 ? 3 * kMillisecond : heard % 3 * 100 * kMicrosecond;
      const auto event = client_.on_datagram(golden::reply_long(), at + late, reply_);
      if (event == RobotEvent::kReply) break;
      while (client_.deadline() < at + kMxtPeriod) {
        ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
        EXPECT_TRUE(reply_.anew && !reply_.fresh);
      }
    }
    EXPECT_EQ(heard, 8 + 2);
    EXPECT_TRUE(reply_.anew && reply_.has_commanded && reply_.has_measured);
    EXPECT_FALSE(client_.opening());
    EXPECT_NEAR(to_seconds(client_.deadline()), to_seconds(at + 2 * kMxtPeriod - kMxtPeriod / 8),
                2e-4);
    ASSERT_EQ(hear(at + kMxtPeriod), RobotEvent::kReply);
    EXPECT_FALSE(reply_.anew);
    EXPECT_EQ(reply_.cycles, 1);
    client_.end();
  }
}

TEST_F(MxtAnew, OneInTimeCountsMoreThanAllThatAreLate) {
  open();
  for (int i = 0; i < 16; ++i) {
    ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  }
  const auto hear_late = [&](int cycle, Nanos late) {
    return client_.on_datagram(golden::reply_long(), cycle * kMxtPeriod + late, reply_);
  };
  EXPECT_EQ(hear_late(19, 2 * kMillisecond), std::nullopt);
  ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  EXPECT_FALSE(reply_.fresh || reply_.has_measured) << "it says nothing of the arm yet";
  int cycle = 21;
  for (int i = 0; i < 6; ++i) EXPECT_EQ(hear_late(cycle++, 2 * kMillisecond), std::nullopt);
  EXPECT_EQ(hear_late(cycle++, 0), std::nullopt);
  for (int i = 0; i < 7; ++i) EXPECT_EQ(hear_late(cycle++, 2 * kMillisecond), std::nullopt);
  for (int i = 0; i < 7; ++i) EXPECT_EQ(hear_late(cycle++, 0), std::nullopt);
  EXPECT_EQ(hear_late(cycle, 0), RobotEvent::kReply);
  EXPECT_EQ(client_.deadline(), (cycle + 2) * kMxtPeriod - kMxtPeriod / 8);
}

}  // namespace
}  // namespace handrail
