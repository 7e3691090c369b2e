// Where the controller's cycles begin, as far as its replies tell.
#include "tests/unit/melfa/mxt_client_rig.h"

namespace handrail {
namespace {

class MxtPhase : public MxtClientTest {};

TEST_F(MxtPhase, ACycleWithoutAReplyIsToldWhileAPacketCanStillCome) {
  open();
  send(golden::kTarget);
  const Nanos deadline = 3 * kMxtPeriod - kMxtPeriod / 8;
  EXPECT_EQ(client_.deadline(), deadline);
  EXPECT_EQ(client_.poll(deadline - 1, reply_), std::nullopt);
  EXPECT_EQ(client_.poll(deadline, reply_), RobotEvent::kSilence);
  EXPECT_FALSE(reply_.fresh);
  EXPECT_EQ(reply_.cycles, 1);
  EXPECT_EQ(client_.poll(deadline, reply_), std::nullopt) << "one event a cycle";
  EXPECT_EQ(client_.poll(deadline + kMxtPeriod, reply_), RobotEvent::kSilence);
  EXPECT_EQ(client_.counters().silences, 2u);
}

TEST_F(MxtPhase, AReplyThatComesAfterItsCyclesPacketIsNoOtherCycle) {
  open();
  ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  // Of the cycle that begins at 2 kMxtPeriod, late by all but a microsecond of a period.
  EXPECT_EQ(hear(3 * kMxtPeriod - 1000), std::nullopt);
  EXPECT_EQ(client_.counters().late, 1u);
  EXPECT_EQ(hear(3 * kMxtPeriod + 1000), RobotEvent::kReply);
  EXPECT_EQ(reply_.cycles, 1);
}

// A computer, or the way, that stood still for a while: what comes together answers the cycles that
// were silent. Taken for the next cycle's, one would have a second packet sent before that begins,
// and none after.
TEST_F(MxtPhase, RepliesThatComeTogetherBeginNoCycleThatHasNotBegun) {
  const auto at = [](int cycle) { return cycle * kMxtPeriod + 50 * kMicrosecond; };
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

TEST_F(MxtPhase, RepliesThatWereLateForHalfASecondAreHeardWhenTheyComeInTimeAgain) {
  open();
  for (int i = 2; i <= 400; ++i) {
    send(target(i));
    const Nanos now = i * kMxtPeriod + (i > 150 && i <= 300 ? kMillisecond : 0);
    ASSERT_EQ(hear_held(i, now), RobotEvent::kReply) << i;
    ASSERT_TRUE(reply_.fresh && reply_.cycles == 1) << i;
  }
}

TEST_F(MxtPhase, ALateReplyIsFreshInTheNextCycle) {
  open();
  ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  ASSERT_EQ(hear(3 * kMxtPeriod - 1000), std::nullopt);
  EXPECT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  EXPECT_TRUE(reply_.fresh);
}

TEST_F(MxtPhase, FindsThePhaseAgainWithoutLeavingOutACycle) {
  // The first reply was read late and the second is lost: the others come just before their cycles.
  const Nanos read_late = 500 * kMicrosecond;
  client_.start(-3 * kMxtPeriod);
  hear_first(client_, golden::reply_long(), golden::reply_long_held());
  ASSERT_EQ(client_.on_datagram(golden::reply_long_held(), kMxtPeriod + read_late, reply_),
            RobotEvent::kReply);
  ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  int in_time = 0;
  for (int i = 3; i < 100; ++i) {
    // Between two cycles of the controller one packet is sent.
    const Nanos at = i * kMxtPeriod;
    const bool replied = hear(at) == RobotEvent::kReply;
    in_time = replied ? in_time + 1 : 0;
    if (replied) {
      ASSERT_GE(client_.deadline(), at + kMxtPeriod) << i;
    } else {
      ASSERT_LT(client_.deadline(), at + kMxtPeriod) << i;
      ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence) << i;
    }
    ASSERT_EQ(reply_.cycles, 1) << i;
  }
  EXPECT_GT(in_time, 30);
}

// Where several cycles have passed, one too many would be a step too large. The phase is known to
// an eighth of a period.
TEST_F(MxtPhase, OfSeveralCyclesTheLastIsCountedOnceItHasSurelyBegun) {
  const Nanos sure = kMxtPeriod / 8 + 1;
  for (const bool replied : {false, true}) {
    open();
    const Nanos begins = 5 * kMxtPeriod;
    EXPECT_EQ(replied ? hear(begins + sure - 1) : client_.poll(begins + sure - 1, reply_),
              std::nullopt);
    EXPECT_EQ(client_.deadline(), begins + sure);
    EXPECT_EQ(client_.poll(begins + sure, reply_), RobotEvent::kSilence);
    EXPECT_EQ(reply_.cycles, 4);
    EXPECT_EQ(reply_.fresh, replied);
    EXPECT_FALSE(client_.send(golden::kTarget, begins + sure).empty());
    client_.end();
  }
}

// It may be another controller: it is asked, and told nothing, until its answers say where its
// cycles begin.
// On a busy computer a late reply to what was sent before would begin a cycle in the middle of one.
TEST_F(MxtPhase, ATargetThatMayBeHeldAlreadyTellsOfNoCycle) {
  open();
  send(target(2));
  ASSERT_EQ(hear_held(2, 2 * kMxtPeriod), RobotEvent::kReply);
  send(target(3));
  ASSERT_EQ(hear_held(2, 3 * kMxtPeriod), RobotEvent::kReply) << "lost";
  send(target(2));
  EXPECT_EQ(hear_held(2, 3 * kMxtPeriod + 2 * kMillisecond), std::nullopt);
  send(target(2));
  EXPECT_EQ(hear_held(2, 3 * kMxtPeriod + 3 * kMillisecond), std::nullopt);
  EXPECT_EQ(hear_held(2, 4 * kMxtPeriod), RobotEvent::kReply);
  send(target(5));
  ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  send(target(5));
  EXPECT_EQ(hear_held(5, 5 * kMxtPeriod + 2 * kMillisecond), std::nullopt) << "it may be the first";
  EXPECT_EQ(hear_held(5, 6 * kMxtPeriod), RobotEvent::kReply);
}

TEST_F(MxtPhase, CountsTheCyclesThatPassedWhileNobodyAsked) {
  open();
  EXPECT_EQ(hear(704 * kMxtPeriod + kMillisecond), RobotEvent::kReply);
  EXPECT_EQ(reply_.cycles, 703);
  EXPECT_EQ(client_.poll(client_.deadline() + 9 * kMxtPeriod, reply_), RobotEvent::kSilence);
  EXPECT_EQ(reply_.cycles, 10);
}

TEST_F(MxtPhase, KeepsUpWithAControllerOf711MillisecondsAndOneAsFast) {
  for (const Nanos period : {7'110 * kMicrosecond, 7'090 * kMicrosecond}) {
    open();
    for (int i = 1; i <= 2000; ++i) {
      const Nanos now = kMxtPeriod + i * period;
      if (now >= client_.deadline()) {
        ADD_FAILURE() << "silent in cycle " << i;
      }
      send(target(i / 2));  // one that moves in every second cycle
      ASSERT_EQ(hear_held(i / 2, now), RobotEvent::kReply) << i;
      ASSERT_EQ(reply_.cycles, 1) << i;
    }
    client_.end();
  }
}

// A computer or a controller that stands still now and then: a reply comes a cycle late, and that
// of the cycle itself just before the next. As the next one's it would be answered twice in one
// cycle.
TEST_F(MxtPhase, OnlyAReplyThatHasTheCyclesTargetBeginsTheNextOneEarly) {
  open();
  for (int i = 2; i < 10; ++i) {
    send(target(i));
    ASSERT_EQ(hear_held(i, i * kMxtPeriod), RobotEvent::kReply);
  }
  send(target(10));
  ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  send(target(11));
  ASSERT_EQ(hear_held(10, 11 * kMxtPeriod + kMillisecond), RobotEvent::kReply);
  send(target(12));
  EXPECT_EQ(hear_held(11, 12 * kMxtPeriod - 100 * kMicrosecond), std::nullopt);
  EXPECT_EQ(hear_held(12, 12 * kMxtPeriod), RobotEvent::kReply);
  EXPECT_EQ(reply_.cycles, 1);
  // The phase was wrong: the target that was sent in this cycle is held.
  send(target(13));
  EXPECT_EQ(hear_held(13, 13 * kMxtPeriod - kMillisecond), RobotEvent::kReply);
  EXPECT_EQ(reply_.cycles, 1);
  send(target(14));
  EXPECT_EQ(hear_held(14, 14 * kMxtPeriod - 4 * kMillisecond), RobotEvent::kReply);
  EXPECT_EQ(reply_.cycles, 1);
}

// Its replies come a little early. The one after a lost packet does not know the lost target, and
// an arm that stands holds its target at any time.
TEST_F(MxtPhase, ALossIsNoLastingDelayForAFastController) {
  const auto at = [](int i) { return kMxtPeriod + i * (kMxtPeriod - 10 * kMicrosecond); };
  for (const bool moving : {true, false}) {
    open();
    for (int i = 1; i < 40; ++i) {
      const bool lost = i == 20;
      send(target(moving ? i : 1));
      std::optional<RobotEvent> event;
      if (!lost || moving) event = hear_held(!moving ? 1 : lost ? 19 : i, at(i));
      EXPECT_EQ(event.has_value(), !lost) << i;
      if (lost) event = client_.poll(client_.deadline(), reply_);
      EXPECT_EQ(event, lost ? RobotEvent::kSilence : RobotEvent::kReply) << i;
      EXPECT_EQ(reply_.cycles, 1) << i;
    }
    client_.end();
  }
}

// Its replies know the target before the newest, and so may be late ones after a silent cycle.
TEST_F(MxtPhase, AControllerThatKeepsAPacketIsPromptAgainAfterASilentCycle) {
  const auto silent_cycle = [&] {
    open();
    send(target(2));
    ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  };
  const auto hear_one_before = [&](int i, Nanos late) {
    send(target(i));
    if (hear_held(i - 1, i * kMxtPeriod + late) == RobotEvent::kReply) return true;
    EXPECT_EQ(hear_held(i - 1, i * kMxtPeriod + late), std::nullopt) << "one that is read with it";
    EXPECT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
    EXPECT_TRUE(reply_.fresh && !reply_.prompt && reply_.cycles == 1) << i;
    return false;
  };
  silent_cycle();
  for (int i = 3; i < 10; ++i) EXPECT_FALSE(hear_one_before(i, i % 2 * 100 * kMicrosecond)) << i;
  for (int i = 10; i < 20; ++i) {
    EXPECT_TRUE(hear_one_before(i, 0)) << i;
    EXPECT_TRUE(reply_.prompt && reply_.cycles == 1) << i;
  }
  client_.end();
  silent_cycle();
  for (int i = 3; i < 100; ++i) EXPECT_FALSE(hear_one_before(i, i % 2 * 300 * kMicrosecond)) << i;
}

// A program that was paused reads all replies of that time at once: they tell of no phase.
TEST_F(MxtPhase, RepliesThatAreReadTogetherAreOneThatIsLate) {
  open();
  for (int i = 2; i < 10; ++i) ASSERT_EQ(hear(i * kMxtPeriod), RobotEvent::kReply);
  const Nanos woken = 30 * kMxtPeriod + kMxtPeriod / 2;
  EXPECT_EQ(hear(woken), RobotEvent::kReply);
  EXPECT_EQ(reply_.cycles, 21);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(hear(woken), std::nullopt);
  EXPECT_EQ(client_.deadline(), 32 * kMxtPeriod - kMxtPeriod / 8);
}

// Whoever is read before anything was sent cannot be an answer to it.
TEST_F(MxtPhase, RepliesReadTogetherJustBeforeACycleDoNotBeginIt) {
  open();
  send(target(2));
  ASSERT_EQ(hear_held(2, 2 * kMxtPeriod), RobotEvent::kReply);
  send(target(3));
  const Nanos now = 5 * kMxtPeriod - 100 * kMicrosecond;
  EXPECT_EQ(hear_held(3, now), std::nullopt);
  EXPECT_EQ(hear_held(3, now), std::nullopt);
  EXPECT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  EXPECT_EQ(reply_.cycles, 3);
}

// A busy computer: what comes after its cycle is a second packet in the next, or a double step.
TEST_F(MxtPhase, ATargetThatMayMissItsCycleIsNotSent) {
  open();
  const Nanos last = 2 * kMxtPeriod - kMxtPeriod / 8 + kMxtPeriod / 32;
  EXPECT_TRUE(client_.send(golden::kTarget, last + 2 * kSecond).empty());
  EXPECT_TRUE(client_.send(golden::kTarget, last + 1).empty());
  EXPECT_FALSE(client_.send(golden::kTarget, last).empty());
}

TEST_F(MxtPhase, ACycleThatIsSeenTooLateIsToldWithTheNext) {
  const Nanos most = kMxtPeriod / 32;  // behind the deadline
  const Nanos next = kMxtPeriod / 8 + 1;
  for (const bool replied : {false, true}) {
    open();
    // Cycle 2, just in time.
    ASSERT_EQ(client_.poll(client_.deadline() + most, reply_), RobotEvent::kSilence);
    EXPECT_FALSE(client_.send(golden::kTarget, 3 * kMxtPeriod - kMxtPeriod / 8 + most).empty());
    // Cycle 3, too late.
    const Nanos late = client_.deadline() + most + 1;
    ASSERT_EQ(late, 4 * kMxtPeriod - kMxtPeriod / 8 + most + 1);
    EXPECT_EQ(replied ? hear(late) : client_.poll(late, reply_), std::nullopt);
    EXPECT_EQ(client_.deadline(), 4 * kMxtPeriod + next);
    ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
    EXPECT_EQ(reply_.cycles, 2);
    EXPECT_EQ(reply_.fresh, replied);
    EXPECT_FALSE(reply_.prompt);
    EXPECT_EQ(client_.deadline(), 6 * kMxtPeriod - kMxtPeriod / 8);
    client_.end();
  }
}

TEST_F(MxtPhase, AReplyIsPromptInTheFirstEighthOfItsCycle) {
  open();
  EXPECT_TRUE(reply_.prompt);
  const Nanos eighth = kMxtPeriod / 8;
  ASSERT_EQ(hear(2 * kMxtPeriod + eighth), RobotEvent::kReply);
  EXPECT_TRUE(reply_.prompt);
  ASSERT_EQ(hear(3 * kMxtPeriod + eighth + 1), RobotEvent::kReply);
  EXPECT_FALSE(reply_.prompt);
  EXPECT_TRUE(reply_.fresh);
  ASSERT_EQ(hear(4 * kMxtPeriod), RobotEvent::kReply);
  ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  EXPECT_FALSE(reply_.prompt);
  ASSERT_EQ(hear(6 * kMxtPeriod - 1000), std::nullopt);
  ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
  EXPECT_TRUE(reply_.fresh);
  EXPECT_FALSE(reply_.prompt) << "of the cycle before";
}

// The replies that opened the session were read late, on a busy computer.
TEST_F(MxtPhase, EightRepliesThatComeAlikeTellThePhaseAtOnce) {
  for (const Nanos read_late : {2 * kMillisecond, 4 * kMillisecond, 6 * kMillisecond}) {
    client_.start(-3 * kMxtPeriod);
    hear_first(client_, golden::reply_long(), golden::reply_long_held(), read_late);
    const auto opened =
        client_.on_datagram(golden::reply_long_held(), kMxtPeriod + read_late, reply_);
    ASSERT_EQ(opened, RobotEvent::kReply);
    const auto at = [](int i) { return kMxtPeriod + i * kMxtPeriod + i % 3 * 30 * kMicrosecond; };
    int packets = 0;
    for (int i = 1; i < 12; ++i) {
      int sent = 0;
      if (hear(at(i)) == RobotEvent::kReply) ++sent;
      if (client_.deadline() < at(i + 1)) {
        ASSERT_EQ(client_.poll(client_.deadline(), reply_), RobotEvent::kSilence);
        ++sent;
      }
      send(golden::kTarget);
      EXPECT_LE(sent, 1) << "in cycle " << i;
      packets += sent;
    }
    EXPECT_GE(packets, 10);
    EXPECT_NEAR(to_seconds(client_.deadline()), to_seconds(at(13) - kMxtPeriod / 8), 2e-4);
    client_.end();
  }
}

// Until then a packet may go out as the cycle has begun, and its reply is not here yet.
TEST_F(MxtPhase, APhaseThatIsFoundSendsNoSecondPacketInACycle) {
  const Nanos way = 50 * kMicrosecond;  // and back
  const auto reply_of = [&](int cycle) { return cycle * kMxtPeriod + 2 * way; };
  client_.start(-4 * kMxtPeriod);
  const Nanos read_late = kMxtPeriod / 8 - way;
  hear_first(client_, golden::reply_long(), golden::reply_long_held(), reply_of(-1) + read_late);
  ASSERT_EQ(client_.on_datagram(golden::reply_long_held(), reply_of(0) + read_late, reply_),
            RobotEvent::kReply);
  int sent = 0, held = 0, waiting = 0;
  const auto send_next = [&](Nanos now) {
    if (!client_.send(target(++sent), now).empty()) ++waiting;
  };
  for (int i = 1; i < 30; ++i) {
    // The controller's cycle i begins, the packet before it was there in time.
    while (client_.deadline() + way < i * kMxtPeriod) {
      const Nanos now = client_.deadline();
      ASSERT_EQ(client_.poll(now, reply_), RobotEvent::kSilence);
      send_next(now);
    }
    EXPECT_LE(waiting, 1) << "for cycle " << i;
    if (waiting > 0) held = sent;
    waiting = 0;
    while (client_.deadline() < reply_of(i)) {
      const Nanos now = client_.deadline();
      ASSERT_EQ(client_.poll(now, reply_), RobotEvent::kSilence);
      send_next(now);
    }
    if (hear_held(held, reply_of(i)) == RobotEvent::kReply) send_next(reply_of(i));
  }
  EXPECT_NEAR(to_seconds(client_.deadline()), to_seconds(reply_of(31) - kMxtPeriod / 8), 2e-4);
  client_.end();
}

}  // namespace
}  // namespace handrail
