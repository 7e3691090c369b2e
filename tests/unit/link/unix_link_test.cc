// Two ends of the plain link over real sockets: who starts when, who pauses, who ends.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <memory>

#include "server/base/clock.h"
#include "server/base/own_places.h"
#include "server/base/pacer.h"
#include "server/link/pump.h"
#include "server/link/unix_transport.h"
#include "tests/support/datagram_relay.h"
#include "tests/support/no_allocation.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/link/link_samples.h"

namespace handrail {
namespace {

template <typename Local, typename Remote>
struct LinkEnd {
  LinkEnd(boost::asio::io_context& io, UnixTransport::End end, const std::string& path)
      : transport(io, end, path) {}
  std::uint64_t rejected(Reject cause) const {
    return peer.rejects()[static_cast<std::size_t>(cause)];
  }
  UnixTransport transport;
  LinkPeer<Local, Remote> peer{random_session_id()};
  LinkPump<Local, Remote> pump{transport, peer};
};
using MasterEnd = LinkEnd<MasterState, SlaveState>;
using SlaveEnd = LinkEnd<SlaveState, MasterState>;

// Time is made up; what is sent is there at once.
class UnixLinkTest : public ::testing::Test {
 protected:
  std::unique_ptr<MasterEnd> start_master() {
    auto out = std::make_unique<MasterEnd>(io, UnixTransport::End::kMaster, path);
    EXPECT_TRUE(out->transport.open());
    return out;
  }
  std::unique_ptr<SlaveEnd> start_slave() {
    auto out = std::make_unique<SlaveEnd>(io, UnixTransport::End::kSlave, path);
    EXPECT_TRUE(out->transport.open());
    return out;
  }
  // Every end but those left out, once a millisecond.
  void run(int ms, MasterEnd* m, SlaveEnd* s) {
    for (; ms > 0; --ms) {
      now += kMillisecond;
      if (m != nullptr) (void)m->pump.receive(now);
      if (m != nullptr) m->pump.send(now, sample_master());
      if (s != nullptr) (void)s->pump.receive(now);
      if (s != nullptr) s->pump.send(now, sample_slave());
    }
  }
  bool talk(const MasterEnd& m, const SlaveEnd& s) const {
    return m.peer.snapshot().confirmed(now) && s.peer.snapshot().confirmed(now) &&
           m.peer.snapshot().age(now) < 5 * kMillisecond &&
           s.peer.snapshot().age(now) < 5 * kMillisecond;
  }

  TempFolder folder;
  const std::string path = folder.path() + "/link.sock";
  boost::asio::io_context io;
  Nanos now = 1000 * kSecond;
};

TEST_F(UnixLinkTest, AMasterFindsASlaveThatStartsAfterIt) {
  const auto master = start_master();
  run(300, master.get(), nullptr);
  EXPECT_EQ(master->peer.snapshot().peer_epoch, 0u);
  const auto slave = start_slave();
  run(10, master.get(), slave.get());
  EXPECT_TRUE(talk(*master, *slave));
  EXPECT_TRUE(same(slave->peer.newest(), sample_master()));
  EXPECT_TRUE(same(master->peer.newest(), sample_slave()));
}

TEST_F(UnixLinkTest, AMasterFindsASlaveThatStartsAgain) {
  const auto master = start_master();
  auto slave = start_slave();
  run(10, master.get(), slave.get());
  slave.reset();
  run(300, master.get(), nullptr);
  slave = start_slave();
  run(10, master.get(), slave.get());
  EXPECT_TRUE(talk(*master, *slave));
  EXPECT_EQ(master->peer.snapshot().peer_epoch, 2u);
}

// Its file stays behind, as after SIGKILL, and nobody listens there.
TEST_F(UnixLinkTest, ASlaveThatIsKilledIsFollowedByAnother) {
  const auto master = start_master();
  {
    const auto slave = start_slave();
    run(10, master.get(), slave.get());
    ASSERT_EQ(::link(path.c_str(), (path + ".left").c_str()), 0);
  }
  ASSERT_EQ(::rename((path + ".left").c_str(), path.c_str()), 0);
  run(300, master.get(), nullptr);
  const auto slave = start_slave();
  run(10, master.get(), slave.get());
  EXPECT_TRUE(talk(*master, *slave));
}

TEST_F(UnixLinkTest, AMasterThatIsKilledIsFollowedByAnotherAndItsFileHarmsNobody) {
  const auto slave = start_slave();
  {
    const auto master = start_master();
    run(10, master.get(), slave.get());
    const std::string own = master->transport.place();
    ASSERT_EQ(::link(own.c_str(), (path + ".left").c_str()), 0);
  }
  ASSERT_EQ(::rename((path + ".left").c_str(), master_socket(path, ::getpid()).c_str()), 0);
  run(1, nullptr, slave.get());  // speaks to nobody
  const auto master = start_master();
  run(300, master.get(), slave.get());
  EXPECT_TRUE(talk(*master, *slave));
  EXPECT_EQ(slave->peer.snapshot().peer_epoch, 2u);
}

TEST_F(UnixLinkTest, TheSecondOfTwoMastersIsToldWhichProcessLeads) {
  const auto slave = start_slave();
  const auto first = start_master();
  PlacedSocket second{DatagramPlace(folder.path() + "/second")};
  MasterPeer waiting{0x2222};
  run(10, first.get(), slave.get());
  std::vector<std::uint8_t> bytes(kMaxDatagram);
  bytes.resize(waiting.poll(now, sample_master(), bytes));
  ASSERT_TRUE(second.send(DatagramPlace(path), bytes));
  run(1, first.get(), slave.get());
  bytes.resize(kMaxDatagram);
  DatagramPlace from;
  bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(second.receive(bytes, from), 0)));
  EXPECT_EQ(waiting.on_datagram(bytes, now), Reject::kRefused);
  EXPECT_EQ(leader_text(waiting.snapshot().refusal, 0),
            "process " + std::to_string(::getpid()) + " on this computer, for 0 s");
  EXPECT_TRUE(talk(*first, *slave));
}

TEST_F(UnixLinkTest, AReaderThatPausesHoldsNobodyUpAndHearsWhatIsFreshAtOnceAfterIt) {
  const auto master = start_master();
  const auto slave = start_slave();
  run(10, master.get(), slave.get());
  const std::uint64_t before = master->peer.snapshot().sent;
  const Nanos began = monotonic_now();
  run(3000, master.get(), nullptr);
  EXPECT_LT(monotonic_now() - began, 2 * kSecond) << "nothing waited for the full queue";
  EXPECT_EQ(master->peer.snapshot().sent, before + 3000) << "what is lost counts as sent";
  // What waited is dropped, all of it, and the next is a millisecond away.
  const std::uint64_t accepted = slave->peer.snapshot().accepted;
  (void)slave->pump.receive(now);
  EXPECT_EQ(slave->peer.snapshot().accepted, accepted);
  const std::uint64_t waited = slave->rejected(Reject::kAfterStall);
  EXPECT_GT(waited, 0u);
  EXPECT_LT(waited, 3000u) << "a queue is not endless";
  run(2, master.get(), slave.get());
  EXPECT_EQ(slave->peer.snapshot().accepted, accepted + 2);
  EXPECT_EQ(slave->peer.snapshot().sequence, master->peer.snapshot().sent);
  EXPECT_TRUE(talk(*master, *slave));
}

// The queue keeps the oldest: a pause that drops nothing shows what is old for one millisecond.
TEST_F(UnixLinkTest, AfterAPauseWithinTheLimitTheNextDatagramIsFresh) {
  const auto master = start_master();
  const auto slave = start_slave();
  run(10, master.get(), slave.get());
  run(19, master.get(), nullptr);
  (void)slave->pump.receive(now);
  EXPECT_EQ(slave->rejected(Reject::kAfterStall), 0u);
  EXPECT_GT(slave->peer.snapshot().sequence + 20, master->peer.snapshot().sent);
  run(1, master.get(), slave.get());
  EXPECT_EQ(slave->peer.snapshot().sequence, master->peer.snapshot().sent);
}

TEST_F(UnixLinkTest, NoDatagramAllocates) {
  const auto master = start_master();
  const auto slave = start_slave();
  run(10, master.get(), slave.get());
  PlacedSocket second{DatagramPlace(folder.path() + "/second")};
  const auto refused = datagram(sample_header(0x2222, 1), sample_master());
  const MasterState from_master = sample_master();
  const SlaveState from_slave = sample_slave();
  {
    const test::NoAllocation guard("a second of the link");
    for (int ms = 0; ms < 1000; ++ms) {
      now += kMillisecond;
      if (ms % 50 == 0) (void)second.send(DatagramPlace(path), refused);
      (void)master->pump.receive(now);
      master->pump.send(now, from_master);
      (void)slave->pump.receive(now);
      slave->pump.send(now, from_slave);
    }
  }
  EXPECT_TRUE(talk(*master, *slave));
  EXPECT_GT(slave->rejected(Reject::kSessionBusy), 10u);
}

TEST_F(UnixLinkTest, EachIsWokenByWhatTheOtherSends) {
  const auto master = start_master();
  const auto slave = start_slave();
  master->transport.on_readable([&] { (void)master->pump.receive(monotonic_now()); });
  slave->transport.on_readable([&] {
    (void)slave->pump.receive(monotonic_now());
    slave->pump.send(monotonic_now(), sample_slave());
  });
  const Nanos give_up = monotonic_now() + 10 * kSecond;
  while (master->peer.snapshot().round_trip < 0 && monotonic_now() < give_up) {
    master->pump.send(monotonic_now(), sample_master());
    (void)io.run_one_for(std::chrono::milliseconds(1));
  }
  EXPECT_GE(master->peer.snapshot().round_trip, 0);
  EXPECT_TRUE(same(slave->peer.newest(), sample_master()));
}

}  // namespace
}  // namespace handrail
