// Two peers under a manual clock: schedule, ages, echoes and quality.
#include "server/link/peer.h"

#include <gtest/gtest.h>

#include "tests/support/no_allocation.h"
#include "tests/unit/link/link_samples.h"

namespace handrail {
namespace {

constexpr Nanos kStart = 1000 * kSecond;

struct Packet {
  std::array<std::uint8_t, kMaxDatagram> bytes{};
  std::size_t size = 0;
  std::span<const std::uint8_t> span() const { return std::span(bytes).first(size); }
};

class PeerTest : public ::testing::Test {
 protected:
  // The next datagram of each, sent at `now`.
  Packet from_master(Nanos now) {
    Packet p;
    p.size = master.poll(now, master_state, p.bytes);
    EXPECT_NE(p.size, 0u);
    return p;
  }
  Packet from_slave(Nanos now) {
    Packet p;
    p.size = slave.poll(now, slave_state, p.bytes);
    EXPECT_NE(p.size, 0u);
    return p;
  }

  MasterPeer master{0xaaaa};
  SlavePeer slave{0xbbbb};
  MasterState master_state = sample_master();
  SlaveState slave_state = sample_slave();
};

TEST_F(PeerTest, NothingIsKnownBeforeTheFirstDatagram) {
  EXPECT_EQ(slave.snapshot().peer_epoch, 0u);
  EXPECT_EQ(slave.snapshot().age(kStart), kForever);
  EXPECT_EQ(slave.snapshot().loop_age(kStart), kForever);
  EXPECT_EQ(slave.snapshot().round_trip, -1);
  EXPECT_EQ(slave.snapshot().quality(kStart), LinkQuality::kPoor);
}

TEST_F(PeerTest, DeliversTheNewestState) {
  master_state.stop_epoch = 5;
  EXPECT_EQ(slave.on_datagram(from_master(kStart).span(), kStart + 7), Reject::kNone);
  EXPECT_TRUE(same(slave.newest(), master_state));
  EXPECT_EQ(slave.snapshot().peer_epoch, 1u);
  EXPECT_EQ(slave.snapshot().accepted, 1u);
}

TEST_F(PeerTest, SendsOnceAMillisecondAndRepeatsTheState) {
  Packet p;
  EXPECT_EQ(master.wait_time(kStart), 0);
  EXPECT_NE(master.poll(kStart, master_state, p.bytes), 0u);
  EXPECT_EQ(master.wait_time(kStart), kMillisecond);
  EXPECT_EQ(master.wait_time(kStart + 400'000), 600'000);
  EXPECT_EQ(master.poll(kStart + kMillisecond - 1, master_state, p.bytes), 0u);
  EXPECT_NE(master.poll(kStart + kMillisecond, master_state, p.bytes), 0u);
  EXPECT_EQ(master.snapshot().sent, 2u);
}

TEST_F(PeerTest, ALatePollKeepsTheGridAndSendsNoBurst) {
  Packet p;
  (void)from_master(kStart);
  EXPECT_NE(master.poll(kStart + 5'300'000, master_state, p.bytes), 0u);
  EXPECT_EQ(master.poll(kStart + 5'300'001, master_state, p.bytes), 0u);
  EXPECT_EQ(master.wait_time(kStart + 5'300'000), 700'000);
}

TEST_F(PeerTest, AnotherStopGoesAtOnceInPlaceOfTheNextDatagram) {
  (void)from_master(kStart);
  ++master_state.stop_epoch;
  Packet p = from_master(kStart + 300'000);
  EXPECT_EQ(slave.on_datagram(p.span(), kStart + 300'000), Reject::kNone);
  EXPECT_EQ(slave.newest().stop_epoch, master_state.stop_epoch);
  EXPECT_EQ(master.poll(kStart + 300'001, master_state, p.bytes), 0u);
  EXPECT_EQ(master.wait_time(kStart + 300'000), 1'700'000);
  EXPECT_EQ(master.poll(kStart + kMillisecond, master_state, p.bytes), 0u);
  EXPECT_NE(master.poll(kStart + 2 * kMillisecond, master_state, p.bytes), 0u);
  EXPECT_EQ(master.snapshot().sent, 3u);
}

TEST_F(PeerTest, AgeGrowsWithTheClockAndFreshDatagramsResetIt) {
  (void)slave.on_datagram(from_master(kStart).span(), kStart);
  EXPECT_EQ(slave.snapshot().age(kStart), 0);
  EXPECT_EQ(slave.snapshot().age(kStart + 20 * kMillisecond), 20 * kMillisecond);
  (void)slave.on_datagram(from_master(kStart + kSecond).span(), kStart + kSecond);
  EXPECT_EQ(slave.snapshot().age(kStart + kSecond + 1), 1);
}

TEST_F(PeerTest, RefusedDatagramsDoNotResetTheAge) {
  const Packet first = from_master(kStart);
  (void)slave.on_datagram(first.span(), kStart);
  EXPECT_EQ(slave.on_datagram(first.span(), kStart + kMillisecond), Reject::kDuplicate);
  Packet broken = from_master(kStart + kMillisecond);
  broken.bytes[100] ^= 1;
  EXPECT_EQ(slave.on_datagram(broken.span(), kStart + kMillisecond), Reject::kChecksum);
  EXPECT_EQ(slave.snapshot().age(kStart + 2 * kMillisecond), 2 * kMillisecond);
  EXPECT_EQ(slave.snapshot().rejected, 2u);
  EXPECT_EQ(slave.rejects()[static_cast<std::size_t>(Reject::kDuplicate)], 1u);
  EXPECT_EQ(slave.rejects()[static_cast<std::size_t>(Reject::kChecksum)], 1u);
}

// 3 ms there, held 2 ms, 4 ms back.
TEST_F(PeerTest, RoundTripLeavesOutTheTimeHeldAndLoopAgeDoesNot) {
  const Packet there = from_master(kStart);
  (void)slave.on_datagram(there.span(), kStart + 3 * kMillisecond);
  const Packet back = from_slave(kStart + 5 * kMillisecond);
  ASSERT_EQ(master.on_datagram(back.span(), kStart + 9 * kMillisecond), Reject::kNone);
  EXPECT_EQ(master.snapshot().round_trip, 7 * kMillisecond);
  EXPECT_EQ(master.snapshot().loop_age(kStart + 9 * kMillisecond), 9 * kMillisecond);
  EXPECT_EQ(master.snapshot().loop_age(kStart + 10 * kMillisecond), 10 * kMillisecond);
}

TEST_F(PeerTest, ClocksOfTheTwoSidesNeedNotAgree) {
  constexpr Nanos kOffset = 5000 * kSecond;  // the slave's clock runs this far ahead
  (void)slave.on_datagram(from_master(kStart).span(), kStart + kOffset + kMillisecond);
  const Packet back = from_slave(kStart + kOffset + 2 * kMillisecond);
  ASSERT_EQ(master.on_datagram(back.span(), kStart + 3 * kMillisecond), Reject::kNone);
  EXPECT_EQ(master.snapshot().round_trip, 2 * kMillisecond);
}

TEST_F(PeerTest, LoopAgeSeesADelayThatArrivalsDoNot) {
  constexpr Nanos kDelay = 150 * kMillisecond;  // each way
  std::vector<Packet> there, back;
  Nanos now = kStart;
  for (std::size_t i = 0; i < 400; ++i, now += kMillisecond) {
    there.push_back(from_master(now));
    back.push_back(from_slave(now));
    if (i < 150) continue;
    (void)slave.on_datagram(there[i - 150].span(), now);
    (void)master.on_datagram(back[i - 150].span(), now);
  }
  now -= kMillisecond;
  EXPECT_EQ(master.snapshot().age(now), 0);
  EXPECT_EQ(master.snapshot().quality(now), LinkQuality::kExcellent);
  EXPECT_NEAR(to_seconds(master.snapshot().loop_age(now)), 2 * to_seconds(kDelay), 0.0011);
}

TEST_F(PeerTest, EchoesThatCannotBeTrueAreIgnored) {
  (void)from_master(kStart);
  DatagramHeader header = sample_header(0xbbbb, 1);
  header.echo_session = 0xaaaa;
  header.echo_sequence = 1;
  const auto arrives = [&](Nanos now) {
    EXPECT_EQ(master.on_datagram(datagram(header, slave_state), now), Reject::kNone);
    ++header.sequence;
    return master.snapshot().round_trip;
  };
  header.echo_sent = kStart + 10;  // in the future
  EXPECT_EQ(arrives(kStart + 9), -1);
  EXPECT_EQ(master.snapshot().peer_age, kForever);
  header.echo_sent = kStart;
  header.echo_sequence = 2;  // never sent
  EXPECT_EQ(arrives(kStart + 11), -1);
  header.echo_sequence = 1;
  header.echo_session = 0xaaab;  // not ours
  EXPECT_EQ(arrives(kStart + 12), -1);
  header.echo_session = 0xaaaa;
  EXPECT_EQ(arrives(kStart + 13), 13);
}

// As where a thread does not run between reading its clock and reading what has come: the link is
// no worse for it, and nothing is taken for younger than it is known to be.
TEST_F(PeerTest, WhatWasHeldLongerThanItWasUnderWayIsAsOldAsTheWayAtMost) {
  (void)from_master(kStart);
  DatagramHeader header = sample_header(0xbbbb, 1);
  header.echo_session = 0xaaaa;
  header.echo_sequence = 1;
  header.echo_sent = kStart;
  header.echo_held = 2 * kMillisecond;
  const Nanos now = kStart + kMillisecond;
  ASSERT_EQ(master.on_datagram(datagram(header, slave_state), now), Reject::kNone);
  EXPECT_EQ(master.snapshot().peer_age, kMillisecond);
  EXPECT_EQ(master.snapshot().loop_age(now), kMillisecond);
  EXPECT_EQ(master.snapshot().round_trip, -1);  // it says nothing about that
  header.sequence = 2;
  header.echo_held = kMillisecond / 4;
  ASSERT_EQ(master.on_datagram(datagram(header, slave_state), now), Reject::kNone);
  EXPECT_EQ(master.snapshot().peer_age, kMillisecond / 4);
  EXPECT_EQ(master.snapshot().round_trip, 3 * kMillisecond / 4);
}

TEST_F(PeerTest, QualityFollowsTheShareReceived) {
  Nanos now = kStart;
  const auto deliver = [&](int count) {
    for (int i = 0; i < count; ++i, now += kMillisecond) {
      ASSERT_EQ(slave.on_datagram(from_master(now).span(), now), Reject::kNone);
    }
  };
  const auto lose = [&](int count) {
    for (int i = 0; i < count; ++i, now += kMillisecond) (void)from_master(now);
  };
  deliver(39);
  EXPECT_EQ(slave.snapshot().quality(now), LinkQuality::kPoor);
  deliver(1);
  EXPECT_EQ(slave.snapshot().quality(now), LinkQuality::kFair);
  deliver(34);
  EXPECT_EQ(slave.snapshot().quality(now), LinkQuality::kFair);
  deliver(1);
  EXPECT_EQ(slave.snapshot().quality(now), LinkQuality::kGood);
  deliver(23);
  EXPECT_EQ(slave.snapshot().quality(now), LinkQuality::kGood);
  deliver(1);
  EXPECT_EQ(slave.snapshot().quality(now), LinkQuality::kExcellent);
  deliver(1);
  lose(1);
  deliver(1);
  EXPECT_EQ(slave.snapshot().quality(now), LinkQuality::kExcellent);
  lose(1);
  deliver(1);
  EXPECT_EQ(slave.snapshot().quality(now), LinkQuality::kGood);
  EXPECT_NEAR(slave.snapshot().loss_share, 0.02, 1e-12);
}

TEST_F(PeerTest, EachSideHearsHowMuchOfItsOwnArrivesThere) {
  Nanos now = kStart;
  for (int i = 0; i < 200; ++i, now += kMillisecond) {
    const Packet there = from_master(now), back = from_slave(now);
    if (i % 4 != 0) (void)slave.on_datagram(there.span(), now);
    (void)master.on_datagram(back.span(), now);
  }
  EXPECT_EQ(master.snapshot().received_of_100, 100);
  EXPECT_EQ(master.snapshot().peer_received_of_100, 75);
  EXPECT_EQ(master.snapshot().sequence, 200u);
  EXPECT_EQ(slave.snapshot().sequence, 200u);
  EXPECT_EQ(slave.snapshot().received_of_100, 75);
}

TEST_F(PeerTest, TheOtherSideSaysForHowLongItHasHadNothingFresh) {
  const Nanos ms = kMillisecond;
  EXPECT_EQ(master.snapshot().view(kStart).peer_age, kForever);
  const Packet unanswered = from_slave(kStart);
  ASSERT_EQ(master.on_datagram(unanswered.span(), kStart + ms), Reject::kNone);
  EXPECT_EQ(master.snapshot().view(kStart + ms).peer_age, kForever);
  ASSERT_EQ(slave.on_datagram(from_master(kStart + ms).span(), kStart + 3 * ms), Reject::kNone);
  ASSERT_EQ(master.on_datagram(from_slave(kStart + 10 * ms).span(), kStart + 12 * ms),
            Reject::kNone);
  EXPECT_EQ(master.snapshot().view(kStart + 99 * ms).peer_age, 7 * ms);
  // Started anew it has heard nothing yet.
  SlavePeer another{0xcccc};
  Packet p;
  p.size = another.poll(kStart + kSecond, slave_state, p.bytes);
  ASSERT_EQ(master.on_datagram(p.span(), kStart + kSecond), Reject::kNone);
  EXPECT_EQ(master.snapshot().view(kStart + kSecond).peer_age, kForever);
}

TEST_F(PeerTest, SilenceBeyondTwentyMillisecondsIsPoor) {
  Nanos now = kStart;
  for (int i = 0; i < 100; ++i, now += kMillisecond) {
    (void)slave.on_datagram(from_master(now).span(), now);
  }
  now -= kMillisecond;
  EXPECT_EQ(slave.snapshot().quality(now + 20 * kMillisecond), LinkQuality::kExcellent);
  EXPECT_EQ(slave.snapshot().quality(now + 20 * kMillisecond + 1), LinkQuality::kPoor);
}

TEST_F(PeerTest, AStateThatCannotBeSentIsCountedAndNotSent) {
  master_state.X_SU.p.x() = std::nan("");
  Packet p;
  EXPECT_EQ(master.poll(kStart, master_state, p.bytes), 0u);
  EXPECT_EQ(master.snapshot().unsendable, 1u);
  EXPECT_EQ(master.last_unsendable(), Reject::kNotFinite);
  EXPECT_EQ(master.wait_time(kStart), kMillisecond);
  master_state = sample_master();
  EXPECT_NE(master.poll(kStart + kMillisecond, master_state, p.bytes), 0u);
  EXPECT_EQ(slave.on_datagram(std::span(p.bytes).first(478), kStart), Reject::kNone);
}

TEST_F(PeerTest, DoesNotAllocate) {
  Packet p;
  Nanos now = kStart;
  std::uint64_t accepted = 0;
  {
    test::NoAllocation guard("the peers");
    for (int i = 0; i < 10; ++i, now += kMillisecond) {
      p.size = master.poll(now, master_state, p.bytes);
      accepted += slave.on_datagram(p.span(), now) == Reject::kNone;
      p.size = slave.poll(now, slave_state, p.bytes);
      accepted += master.on_datagram(p.span(), now) == Reject::kNone;
    }
  }
  EXPECT_EQ(accepted, 20u);
}

}  // namespace
}  // namespace handrail
