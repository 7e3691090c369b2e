// Which datagram may move the state: replay, order and restarted peers.
#include <gtest/gtest.h>

#include "server/link/peer.h"
#include "tests/unit/link/link_samples.h"

namespace handrail {
namespace {

constexpr Nanos kSessionStart = 1000 * kSecond;
constexpr std::uint64_t kOwn = 0xbbbb;

class SessionTest : public ::testing::Test {
 protected:
  Reject receive(std::uint64_t session, std::uint64_t sequence, Nanos now) {
    MasterState state = sample_master();
    state.stop_epoch = static_cast<std::uint32_t>(sequence);
    return slave.on_datagram(datagram(sample_header(session, sequence), state), now);
  }
  // As above, from a master that has heard us: it echoes what we send now.
  Reject receive_answer(std::uint64_t session, std::uint64_t sequence, Nanos now) {
    std::array<std::uint8_t, kMaxDatagram> out;
    EXPECT_NE(slave.poll(now, sample_slave(), out), 0u);
    DatagramHeader header = sample_header(session, sequence);
    header.echo_session = kOwn;
    header.echo_sequence = slave.snapshot().sent;
    header.echo_sent = now;
    MasterState state = sample_master();
    state.stop_epoch = static_cast<std::uint32_t>(sequence);
    return slave.on_datagram(datagram(header, state), now);
  }
  SlavePeer slave{kOwn};
};

TEST_F(SessionTest, TheNewestWinsInAnyOrderOfArrival) {
  EXPECT_EQ(receive(1, 4, kSessionStart), Reject::kNone);
  EXPECT_EQ(receive(1, 2, kSessionStart), Reject::kStale);
  EXPECT_EQ(receive(1, 6, kSessionStart), Reject::kNone);
  EXPECT_EQ(receive(1, 5, kSessionStart), Reject::kStale);
  EXPECT_EQ(receive(1, 6, kSessionStart), Reject::kDuplicate);
  EXPECT_EQ(slave.newest().stop_epoch, 6u);
}

TEST_F(SessionTest, AReplayOfTheWholeHistoryMovesNothing) {
  for (std::uint64_t n = 1; n <= 300; ++n) {
    ASSERT_EQ(receive(1, n, kSessionStart + static_cast<Nanos>(n) * kMillisecond), Reject::kNone);
  }
  const Nanos after = kSessionStart + 10 * kSecond;
  for (std::uint64_t n = 1; n <= 300; ++n) EXPECT_NE(receive(1, n, after), Reject::kNone) << n;
  EXPECT_EQ(slave.newest().stop_epoch, 300u);
  EXPECT_EQ(slave.snapshot().accepted, 300u);
}

TEST_F(SessionTest, TheLastSequenceIsAcceptedOnceAndThenOnlyANewSession) {
  EXPECT_EQ(receive(1, UINT64_MAX, kSessionStart), Reject::kNone);
  EXPECT_EQ(receive(1, UINT64_MAX, kSessionStart), Reject::kDuplicate);
  EXPECT_EQ(receive(1, 1, kSessionStart), Reject::kStale);
  EXPECT_EQ(receive(2, 1, kSessionStart + 201 * kMillisecond), Reject::kNone);
}

TEST_F(SessionTest, TheFirstSessionIsAcceptedAtOnce) {
  EXPECT_EQ(receive(1, 1, kSessionStart), Reject::kNone);
  EXPECT_EQ(slave.snapshot().peer_epoch, 1u);
}

TEST_F(SessionTest, ARestartedPeerIsAcceptedAfterTwoHundredMillisecondsOfSilence) {
  (void)receive_answer(1, 9, kSessionStart);
  EXPECT_EQ(receive(2, 1, kSessionStart + kMillisecond), Reject::kSessionBusy);
  EXPECT_EQ(receive(2, 2, kSessionStart + 200 * kMillisecond), Reject::kSessionBusy);
  EXPECT_EQ(slave.snapshot().peer_epoch, 1u);
  EXPECT_EQ(receive(2, 3, kSessionStart + 200 * kMillisecond + 1), Reject::kNone);
  EXPECT_EQ(slave.snapshot().peer_epoch, 2u);
  EXPECT_EQ(slave.newest().stop_epoch, 3u);
}

TEST_F(SessionTest, AReplacedSessionNeverComesBack) {
  (void)receive_answer(1, 9, kSessionStart);
  (void)receive(2, 1, kSessionStart + kSecond);
  EXPECT_EQ(receive(1, 10, kSessionStart + kSecond), Reject::kSessionRetired);
  EXPECT_EQ(receive(1, 11, kSessionStart + 10 * kSecond), Reject::kSessionRetired);
  EXPECT_EQ(receive(2, 2, kSessionStart + 10 * kSecond), Reject::kNone);
}

TEST_F(SessionTest, TheLastEightReplacedSessionsAreRemembered) {
  Nanos now = kSessionStart;
  for (std::uint64_t session = 1; session <= 9; ++session, now += kSecond) {
    ASSERT_EQ(receive_answer(session, 1, now), Reject::kNone);
  }
  for (std::uint64_t session = 1; session <= 8; ++session) {
    EXPECT_EQ(receive(session, 2, now), Reject::kSessionRetired) << session;
  }
  EXPECT_EQ(receive(9, 2, now), Reject::kNone);
}

TEST_F(SessionTest, ASilentSessionResumesWhereItWas) {
  (void)receive(1, 9, kSessionStart);
  EXPECT_EQ(receive(1, 9, kSessionStart + 60 * kSecond), Reject::kDuplicate);
  EXPECT_EQ(receive(1, 10, kSessionStart + 60 * kSecond), Reject::kNone);
  EXPECT_EQ(slave.snapshot().peer_epoch, 1u);
}

TEST_F(SessionTest, AStalledIntruderDoesNotKeepTheSessionBusy) {
  (void)receive_answer(1, 9, kSessionStart);
  EXPECT_EQ(receive(1, 9, kSessionStart + 150 * kMillisecond), Reject::kDuplicate);
  EXPECT_EQ(receive(2, 1, kSessionStart + 201 * kMillisecond), Reject::kNone);
}

TEST_F(SessionTest, TheReceiversOwnSessionIsRefused) {
  EXPECT_EQ(receive(kOwn, 1, kSessionStart), Reject::kHeader);
  EXPECT_EQ(slave.snapshot().peer_epoch, 0u);
}

TEST_F(SessionTest, ANewSessionStartsItsOwnStatistics) {
  std::array<std::uint8_t, kMaxDatagram> out;
  ASSERT_NE(slave.poll(kSessionStart, sample_slave(), out), 0u);
  DatagramHeader header = sample_header(1, 1);
  header.echo_session = kOwn;
  header.echo_sequence = 1;
  header.echo_sent = kSessionStart;
  ASSERT_EQ(slave.on_datagram(datagram(header, sample_master()), kSessionStart + 5), Reject::kNone);
  ASSERT_EQ(slave.snapshot().round_trip, 5);
  ASSERT_EQ(slave.snapshot().loop_age(kSessionStart + 6), 6);
  for (std::uint64_t n = 2; n <= 100; ++n) (void)receive(1, n, kSessionStart);
  ASSERT_EQ(slave.snapshot().received_of_100, 100);
  (void)receive(2, 77, kSessionStart + kSecond);
  EXPECT_EQ(slave.snapshot().received_of_100, 1);
  EXPECT_DOUBLE_EQ(slave.snapshot().loss_share, 0.0);
  EXPECT_EQ(slave.snapshot().round_trip, -1);
  EXPECT_EQ(slave.snapshot().loop_age(kSessionStart + kSecond), kForever);
}

TEST_F(SessionTest, ReorderIsNotCountedAsLoss) {
  (void)receive(1, 1, kSessionStart);
  for (std::uint64_t n = 2; n <= 200; n += 2) {
    (void)receive(1, n + 1, kSessionStart);
    EXPECT_EQ(receive(1, n, kSessionStart), Reject::kStale);
  }
  EXPECT_EQ(slave.snapshot().received_of_100, 100);
  EXPECT_DOUBLE_EQ(slave.snapshot().loss_share, 0.0);
}

// What one start of a master and a slave said to each other proves nothing to another start.
TEST_F(SessionTest, ARecordedSessionPlayedToARestartedSlaveIsNeverConfirmed) {
  MasterPeer master{1};
  std::vector<std::vector<std::uint8_t>> recorded;
  for (Nanos now = kSessionStart; now < kSessionStart + kSecond; now += kMillisecond) {
    std::vector<std::uint8_t> there(kMaxDatagram), back(kMaxDatagram);
    there.resize(master.poll(now, sample_master(), there));
    (void)slave.on_datagram(there, now);
    recorded.push_back(there);
    back.resize(slave.poll(now, sample_slave(), back));
    (void)master.on_datagram(back, now);
  }
  ASSERT_TRUE(slave.snapshot().confirmed(kSessionStart + kSecond));
  ASSERT_TRUE(master.snapshot().confirmed(kSessionStart + kSecond));
  SlavePeer restarted{kOwn + 1};
  Nanos now = kSessionStart + kSecond;
  for (const auto& datagram : recorded) {
    EXPECT_EQ(restarted.on_datagram(datagram, now), Reject::kNone);
    EXPECT_FALSE(restarted.snapshot().confirmed(now));
    now += kMillisecond;
  }
  EXPECT_EQ(restarted.snapshot().age(now), kMillisecond);
  EXPECT_FALSE(restarted.snapshot().view(now).confirmed);
}

TEST_F(SessionTest,
       OneThatNeverAnsweredYieldsAtOnceButNotMoreOftenThanEveryTwoHundredMilliseconds) {
  EXPECT_EQ(receive(1, 9, kSessionStart), Reject::kNone);
  EXPECT_EQ(receive(2, 1, kSessionStart + kMillisecond), Reject::kNone);
  EXPECT_EQ(slave.snapshot().peer_epoch, 2u);
  EXPECT_EQ(receive(2, 2, kSessionStart + 2 * kMillisecond), Reject::kNone);
  EXPECT_EQ(receive(3, 1, kSessionStart + 3 * kMillisecond), Reject::kSessionBusy);
  EXPECT_EQ(receive(2, 3, kSessionStart + 200 * kMillisecond), Reject::kNone);
  EXPECT_EQ(receive(3, 2, kSessionStart + 201 * kMillisecond), Reject::kSessionBusy);
  EXPECT_EQ(receive(3, 3, kSessionStart + 202 * kMillisecond), Reject::kNone);
}

TEST_F(SessionTest, OneThatNeverAnsweredMayComeBackWithWhatIsNewer) {
  (void)receive(1, 9, kSessionStart);
  (void)receive(2, 1, kSessionStart);
  const Nanos later = kSessionStart + 201 * kMillisecond;
  EXPECT_EQ(receive(1, 8, later), Reject::kStale);
  EXPECT_EQ(receive(1, 9, later), Reject::kStale);
  EXPECT_EQ(receive(1, 10, later), Reject::kNone);
  EXPECT_EQ(receive_answer(1, 11, later), Reject::kNone);
  EXPECT_EQ(receive(2, 2, later + 300 * kMillisecond), Reject::kNone) << "silent";
  EXPECT_EQ(receive(1, 12, later + kSecond), Reject::kSessionRetired) << "had answered";
}

// A recording plays to a restarted slave, and the master it knows nothing of comes in beside it.
TEST_F(SessionTest, ARecordedSessionKeepsTheRealMasterOutForNoTimeAndIsNeverConfirmed) {
  for (const int transit : {0, 90, 150, 500}) {
    SlavePeer restarted{kOwn + 10};
    MasterPeer master{77};
    std::vector<std::vector<std::uint8_t>> there, back;  // by the time they were sent
    int confirmed = -1;
    const MasterState old = sample_master();
    MasterState real = sample_master();
    real.stop_epoch = old.stop_epoch + 1;
    for (int ms = 0; ms < 6000; ++ms) {
      const Nanos now = kSessionStart + ms * kMillisecond;
      const auto recorded = datagram(sample_header(1, static_cast<std::uint64_t>(ms + 1)), old);
      (void)restarted.on_datagram(recorded, now);
      there.emplace_back(kMaxDatagram);
      there.back().resize(master.poll(now, real, there.back()));
      if (ms >= transit + 5) {
        (void)restarted.on_datagram(there[static_cast<std::size_t>(ms - transit)], now);
      }
      // The slave answers to where the newest datagram came from.
      back.emplace_back(kMaxDatagram);
      back.back().resize(restarted.poll(now, sample_slave(), back.back()));
      if (restarted.newest().stop_epoch != real.stop_epoch) back.back().clear();
      if (ms >= transit)
        (void)master.on_datagram(back[static_cast<std::size_t>(ms - transit)], now);
      if (restarted.snapshot().confirmed(now)) {
        ASSERT_EQ(restarted.newest().stop_epoch, real.stop_epoch) << ms;
        if (confirmed < 0) confirmed = ms;
      }
    }
    EXPECT_GE(confirmed, 0);
    EXPECT_LE(confirmed, transit < 100 ? 10 + 4 * transit : 1800) << transit;
    EXPECT_TRUE(restarted.snapshot().confirmed(kSessionStart + 6 * kSecond));
    EXPECT_LT(restarted.snapshot().age(kSessionStart + 6 * kSecond), 5 * kMillisecond);
  }
}

TEST_F(SessionTest, AnAnswerProvesASessionForTwelveSecondsAndAnotherSessionStartsAnew) {
  DatagramHeader header = sample_header(1, 1);
  std::vector<std::uint8_t> sent(kMaxDatagram);
  ASSERT_NE(slave.poll(kSessionStart, sample_slave(), sent), 0u);
  header.echo_session = kOwn;
  header.echo_sequence = 1;
  header.echo_sent = kSessionStart;
  ASSERT_EQ(slave.on_datagram(datagram(header, sample_master()), kSessionStart), Reject::kNone);
  EXPECT_TRUE(slave.snapshot().confirmed(kSessionStart + kConfirmedAge));
  EXPECT_FALSE(slave.snapshot().confirmed(kSessionStart + kConfirmedAge + 1));
  ASSERT_EQ(receive(2, 1, kSessionStart + kSecond), Reject::kNone);
  EXPECT_FALSE(slave.snapshot().confirmed(kSessionStart + kSecond));
}

// Two masters at one slave. Datagrams arrive at once; the slave answers to whom it took last, and a
// refusal goes back to who is refused.
class TwoMastersTest : public ::testing::Test {
 protected:
  void run(Nanos span, bool first_runs, bool second_runs) {
    for (const Nanos end = now + span; now < end; now += kMillisecond) {
      if (first_runs) speak(first);
      if (second_runs) speak(second);
      std::vector<std::uint8_t> state(kMaxDatagram);
      state.resize(slave.poll(now, sample_slave(), state));
      if (leader == &first ? first_runs : second_runs) (void)leader->on_datagram(state, now);
    }
  }
  void speak(MasterPeer& master) {
    std::vector<std::uint8_t> bytes(kMaxDatagram), back(kMaxDatagram);
    bytes.resize(master.poll(now, sample_master(), bytes));
    const Reject cause = slave.on_datagram(bytes, now);
    if (cause == Reject::kNone) leader = &master;
    back.resize(slave.refuse(cause, leader == &first ? "one" : "three", now, back));
    if (back.empty()) return;
    ++told;
    (void)master.on_datagram(back, now);
  }
  bool leads(const MasterPeer& master) const {
    return master.snapshot().confirmed(now) && master.snapshot().age(now) < 5 * kMillisecond;
  }

  SlavePeer slave{kOwn};
  MasterPeer first{0x1111}, second{0x2222};
  MasterPeer* leader = &first;
  int told = 0;  // refusals
  Nanos now = kSessionStart;
};

TEST_F(TwoMastersTest, TheRefusedOneIsToldWhoLeadsAndSinceWhen) {
  run(kSecond, true, false);
  run(3 * kSecond, true, true);
  EXPECT_TRUE(leads(first));
  EXPECT_FALSE(first.snapshot().refused(now));
  ASSERT_TRUE(second.snapshot().refused(now));
  EXPECT_TRUE(second.snapshot().view(now).other_master);
  EXPECT_EQ(second.snapshot().peer_epoch, 0u);
  const Refusal& said = second.snapshot().refusal;
  EXPECT_EQ(text_of(said.leader), "one");
  EXPECT_FALSE(said.retired);
  const Nanos led = said.led_for + now - second.snapshot().refused_at;
  EXPECT_NEAR(static_cast<double>(led), 4e9, 5e6);
  // It is told no more, and believes it for a second.
  run(700 * kMillisecond, true, false);
  EXPECT_TRUE(second.snapshot().refused(now));
  run(400 * kMillisecond, true, false);
  EXPECT_FALSE(second.snapshot().refused(now));
}

// The first pauses for 0.4 s while the second waits.
TEST_F(TwoMastersTest, APausedMasterIsReplacedIsToldAndLeadsAgainWhenTheOtherHasEnded) {
  run(kSecond, true, false);
  run(kSecond, true, true);
  const std::uint64_t session = first.session();
  run(400 * kMillisecond, false, true);
  EXPECT_TRUE(leads(second));
  run(kSecond, true, true);
  EXPECT_TRUE(leads(second)) << "the first does not take it away again";
  ASSERT_TRUE(first.snapshot().refused(now));
  EXPECT_EQ(text_of(first.snapshot().refusal.leader), "three");
  EXPECT_NE(first.session(), session);
  EXPECT_FALSE(first.snapshot().confirmed(now));
  run(300 * kMillisecond, true, false);
  EXPECT_TRUE(leads(first));
  EXPECT_FALSE(first.snapshot().refused(now));
  EXPECT_EQ(slave.snapshot().peer_epoch, 3u);
}

TEST_F(TwoMastersTest, EachOfTwoThatWaitIsTold) {
  MasterPeer third{0x3333};
  run(kSecond, true, false);
  for (int i = 0; i < 1000; ++i) {
    run(kMillisecond, true, true);
    speak(third);
  }
  EXPECT_TRUE(second.snapshot().refused(now));
  EXPECT_TRUE(third.snapshot().refused(now));
}

// They speak in the same order in every millisecond, and the first of them is not always told.
TEST_F(TwoMastersTest, EachOfFiftyThatWaitIsToldAndTheAnswersAreFew) {
  std::vector<MasterPeer> waiting;
  for (std::uint64_t i = 0; i < 50; ++i) waiting.emplace_back(0x3333 + i);
  run(kSecond, true, false);
  told = 0;
  for (int ms = 0; ms < 5000; ++ms) {
    run(kMillisecond, true, false);
    for (MasterPeer& master : waiting) speak(master);
    if (ms < 1000) continue;
    for (MasterPeer& master : waiting) ASSERT_TRUE(master.snapshot().refused(now)) << ms;
  }
  EXPECT_LE(told, 500) << "one in 10 ms";
}

// Every datagram another session: what is made up costs no more than that, and a round ends.
TEST_F(TwoMastersTest, AFloodOfSessionsIsAnsweredAsRarely) {
  run(kSecond, true, false);
  told = 0;
  for (int ms = 0; ms < 1000; ++ms) {
    run(kMillisecond, true, false);
    for (std::uint64_t i = 0; i < 20; ++i) {
      MasterPeer stranger(0x7777'0000 + static_cast<std::uint64_t>(ms) * 20 + i);
      speak(stranger);
    }
  }
  EXPECT_GT(told, 90);
  EXPECT_LE(told, 100);
}

TEST_F(TwoMastersTest, ARefusalOfAnotherSessionOrOfALeadingMasterChangesNothing) {
  run(kSecond, true, false);
  Codec codec;
  std::vector<std::uint8_t> bytes(kMaxDatagram);
  bytes.resize(codec.encode(Refusal{0x9999, true, fixed_text<LeaderName>("three"), 0}, bytes));
  const std::uint64_t session = first.session();
  EXPECT_EQ(first.on_datagram(bytes, now), Reject::kStale);
  EXPECT_EQ(first.session(), session);
  EXPECT_FALSE(first.snapshot().refused(now));
  EXPECT_EQ(slave.on_datagram(bytes, now), Reject::kKind) << "a slave takes none";
  // One that was under way when the slave took this master after all.
  bytes.resize(kMaxDatagram);
  bytes.resize(codec.encode(Refusal{session, false, fixed_text<LeaderName>("three"), 0}, bytes));
  EXPECT_EQ(first.on_datagram(bytes, now), Reject::kRefused);
  run(2 * kMillisecond, true, false);
  EXPECT_FALSE(first.snapshot().refused(now));
  EXPECT_TRUE(leads(first));
}

TEST(SessionAfter, IsAnotherAndTheSameForTheSame) {
  EXPECT_NE(session_after(5), 5u);
  EXPECT_NE(session_after(5), 0u);
  EXPECT_EQ(session_after(5), session_after(5));
  EXPECT_NE(session_after(5), session_after(6));
}

TEST(RandomSessionId, DiffersFromStartToStartAndIsNeverZero) {
  const std::uint64_t a = random_session_id();
  EXPECT_NE(a, 0u);
  EXPECT_NE(a, random_session_id());
}

}  // namespace
}  // namespace handrail
