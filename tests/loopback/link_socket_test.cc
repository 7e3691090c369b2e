// The socket where the real master and slave meet: who starts when, what the ended leave, another
// user who speaks on it.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>

#include "tests/loopback/whole_cell.h"
#include "tests/support/bad_datagrams.h"
#include "tests/support/datagram_relay.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class LinkSocketTest : public WholeCell {
 protected:
  static bool is_fresh(const pb::Status& s) {
    return s.has_tip() && s.packet_age_ms() >= 0.0 && s.packet_age_ms() < 20.0;
  }
  static void end(Program& program) {
    program.send(SIGTERM);
    EXPECT_EQ(program.finish(), 0);
  }
};

class MasterFirst : public LinkSocketTest {
 protected:
  void SetUp() override {}
};

TEST_F(MasterFirst, ASlaveThatStartsAfterItsMasterIsFoundAndSoIsTheNext) {
  start_rig();
  start_master();
  EXPECT_THAT(refusal("stop: true"), HasSubstr("no slave has answered at " + link_socket));
  start_slave();
  ASSERT_TRUE(eventually(is_fresh));
  end(*slave);
  EXPECT_FALSE(std::filesystem::exists(link_socket));
  start_slave();
  ASSERT_TRUE(eventually(is_fresh));
  order("reset: true");
  ASSERT_TRUE(eventually([this](const pb::Status&) { return ask("engage: true").done(); }));
  EXPECT_TRUE(slave_reaches("engaged"));
}

TEST_F(LinkSocketTest, WhatKilledProgramsLeaveHarmsNobodyAndTheOthersLeaveNothing) {
  const std::string left = master_place(*master);
  master->kill();
  slave->kill();
  client.close();
  EXPECT_TRUE(std::filesystem::exists(left) && std::filesystem::exists(link_socket));
  start_slave();
  start_master();
  ASSERT_TRUE(eventually(is_fresh));
  ASSERT_TRUE(eventually([this](const pb::Status&) { return ask("engage: true").done(); }));
  const std::string own = master_place(*master);
  end(*master);
  end(*slave);
  EXPECT_FALSE(std::filesystem::exists(own));
  EXPECT_FALSE(std::filesystem::exists(link_socket));
}

// Its queue is full of what is old by then, and takes nothing new meanwhile.
TEST_F(LinkSocketTest, ASlaveThatWasPausedForSecondsHearsWhatIsFreshSoonAfterIt) {
  slave->send(SIGSTOP);
  sleep_until(monotonic_now() + 3 * kSecond);
  EXPECT_GT(status().packet_age_ms(), 2000.0) << "the master went on";
  slave->send(SIGCONT);
  const Nanos resumed = monotonic_now();
  ASSERT_TRUE(eventually([](const pb::Status& s) {
    return is_fresh(s) && s.peer_quality() == "EXCELLENT" && s.link_quality() == "EXCELLENT";
  }));
  const auto took = (monotonic_now() - resumed) / kMillisecond;
  RecordProperty("fresh_after_ms", std::to_string(took));
  EXPECT_LT(took, 5000);
  end(*slave);
  EXPECT_THAT(slave->output(), HasSubstr("queued while this program stalled"));
}

// Modes that let him in are put there by root: what is left is the kernel's word on who sends.
TEST_F(LinkSocketTest, AnotherUserIsNeitherHeardNorAnswered) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can be somebody else";
  constexpr uid_t kEve = 54321;
  constexpr int kTimes = 50;
  ASSERT_EQ(::chmod(folder.path().c_str(), 01777), 0);
  for (const std::string& at : {link_socket, master_place(*master)}) {
    ASSERT_EQ(::chmod(at.c_str(), 0666), 0);
  }
  const DatagramPlace to_slave(link_socket), to_master(master_place(*master));
  const DatagramPlace own(folder.path() + "/eve");
  const DatagramHeader header{.session = 0x5eed, .sequence = 1, .sent = kSecond};
  const auto as_master = test::sound_datagram(header, MasterState());
  const auto as_slave = test::sound_datagram(header, SlaveState());
  const pid_t eve = ::fork();
  if (eve == 0) {
    if (::setgid(kEve) != 0 || ::setuid(kEve) != 0) ::_exit(2);
    PlacedSocket socket{own};
    for (int i = 0; i < kTimes; ++i) {
      while (!socket.send(to_slave, as_master)) sleep_until(monotonic_now() + kMillisecond);
      while (!socket.send(to_master, as_slave)) sleep_until(monotonic_now() + kMillisecond);
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    sleep_until(monotonic_now() + kSecond / 2);
    std::array<std::uint8_t, kMaxDatagram> buffer;
    DatagramPlace from;
    ::_exit(socket.receive(buffer, from) < 0 ? 0 : 1);
  }
  int ended = -1;
  ASSERT_EQ(::waitpid(eve, &ended, 0), eve);
  EXPECT_EQ(ended, 0) << "1 in its second byte: answered; 2: cannot be another user";
  order("engage: true");
  EXPECT_TRUE(slave_reaches("engaged"));
  end(*master);
  end(*slave);
  for (const Program* program : {master.get(), slave.get()}) {
    EXPECT_THAT(program->output(), HasSubstr("unknown sender " + std::to_string(kTimes)));
    EXPECT_THAT(program->output(), ::testing::Not(HasSubstr("another session is alive")));
  }
}

}  // namespace
}  // namespace handrail
