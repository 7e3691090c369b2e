#include "server/link/unix_transport.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>

#include "server/base/clock.h"
#include "server/base/own_places.h"
#include "server/link/pump.h"
#include "tests/support/datagram_relay.h"
#include "tests/support/no_allocation.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/link/link_samples.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using End = UnixTransport::End;
using Bytes = std::vector<std::uint8_t>;

constexpr uid_t kStranger = 54321;

class UnixTransportTest : public ::testing::Test {
 protected:
  std::unique_ptr<UnixTransport> end_of(End end, const std::string& at) {
    return std::make_unique<UnixTransport>(io, end, at);
  }
  void open_both() {
    ASSERT_TRUE(slave->open());
    ASSERT_TRUE(master->open());
  }
  static mode_t mode_of(const std::string& file) {
    struct stat info {};
    return ::stat(file.c_str(), &info) == 0 ? info.st_mode & 07777u : 0;
  }
  // What waits longest; nothing where nothing waits: a local datagram is there once it is sent.
  std::optional<Transport::Arrival> take(UnixTransport& at) { return at.receive(buffer); }

  TempFolder folder;
  const std::string path = folder.path() + "/run/link.sock";
  boost::asio::io_context io;
  std::unique_ptr<UnixTransport> slave = end_of(End::kSlave, path);
  std::unique_ptr<UnixTransport> master = end_of(End::kMaster, path);
  std::array<std::uint8_t, 16> buffer{};
  const std::string own_name = "process " + std::to_string(::getpid()) + " on this computer";
};

TEST_F(UnixTransportTest, EachHasAFileForItsUserAloneAndRemovesItAtTheEnd) {
  const mode_t before = ::umask(0);
  open_both();
  ::umask(before);
  const std::string own = master_socket(path, ::getpid());
  EXPECT_EQ(slave->place(), path);
  EXPECT_EQ(master->place(), own);
  EXPECT_EQ(mode_of(path), 0600u);
  EXPECT_EQ(mode_of(own), 0600u);
  EXPECT_EQ(mode_of(folder.path() + "/run"), 0700u);
  slave.reset();
  master->close();
  EXPECT_EQ(master->place(), "");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() + "/run"));
}

TEST_F(UnixTransportTest, APathThatAnotherHasIsRefusedAndStaysWithIt) {
  open_both();
  EXPECT_EQ(end_of(End::kSlave, path)->open().message(),
            "link socket " + path + ": another slave answers on it");
  EXPECT_THAT(end_of(End::kMaster, path)->open().message(), HasSubstr("another master answers"));
  ASSERT_TRUE(master->send(Bytes{1}));
  EXPECT_TRUE(take(*slave));
}

TEST_F(UnixTransportTest, WhatAnEndedProgramLeftIsReplaced) {
  ASSERT_TRUE(slave->open());
  slave->close();
  for (const std::string& file : {path, master_socket(path, ::getpid())}) {
    PlacedSocket ended{DatagramPlace(file)};
    ASSERT_EQ(::link(file.c_str(), (file + ".kept").c_str()), 0);
    ASSERT_EQ(::rename((file + ".kept").c_str(), (file + ".left").c_str()), 0);
  }
  for (const std::string& file : {path, master_socket(path, ::getpid())}) {
    ASSERT_EQ(::rename((file + ".left").c_str(), file.c_str()), 0);
  }
  open_both();
  ASSERT_TRUE(master->send(Bytes{1}));
  EXPECT_TRUE(take(*slave));
}

TEST_F(UnixTransportTest, AFileThatIsNoSocketStays) {
  folder.write("run/link.sock", "mine");
  std::filesystem::permissions(folder.path() + "/run", std::filesystem::perms::owner_all);
  EXPECT_EQ(slave->open().message(), "link socket " + path + ": exists and is not a socket");
  EXPECT_EQ(std::filesystem::file_size(path), 4u);
}

TEST_F(UnixTransportTest, AFolderThatOthersMayWriteToIsRefused) {
  std::filesystem::create_directory(folder.path() + "/run");
  ASSERT_EQ(::chmod((folder.path() + "/run").c_str(), 0777), 0);
  for (const End end : {End::kSlave, End::kMaster}) {
    EXPECT_THAT(end_of(end, path)->open().message(), HasSubstr("has mode 0777"));
  }
}

TEST_F(UnixTransportTest, AFolderOfSomebodyElseIsRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a folder away";
  std::filesystem::create_directory(folder.path() + "/run");
  ASSERT_EQ(::chmod((folder.path() + "/run").c_str(), 0755), 0);
  ASSERT_EQ(::chown((folder.path() + "/run").c_str(), kStranger, kStranger), 0);
  for (const End end : {End::kSlave, End::kMaster}) {
    EXPECT_THAT(end_of(end, path)->open().message(), HasSubstr("is a folder of uid 54321"));
  }
}

TEST_F(UnixTransportTest, APathThatIsTooLongForAMasterBesideItIsNamed) {
  const std::string longest = folder.path() + "/" + std::string(106 - folder.path().size(), 'a');
  EXPECT_TRUE(end_of(End::kSlave, longest)->open());
  EXPECT_THAT(end_of(End::kMaster, longest)->open().message(), HasSubstr("expected 1 to 107"));
}

// Whichever links and however few folders each was told.
TEST_F(UnixTransportTest, TheTwoMeetByAnyNameOfTheFolder) {
  ASSERT_TRUE(slave->open());
  std::filesystem::create_directory_symlink(folder.path(), folder.path() + "/other");
  master = end_of(End::kMaster, folder.path() + "/other/run/link.sock");
  ASSERT_TRUE(master->open());
  ASSERT_TRUE(master->send(Bytes{1}));
  ASSERT_TRUE(take(*slave));
  slave->adopt_sender();
  ASSERT_TRUE(slave->send(Bytes{1, 2}));
  const auto arrival = take(*master);
  ASSERT_TRUE(arrival);
  EXPECT_TRUE(arrival->from_peer);
}

TEST_F(UnixTransportTest, TheSlaveLearnsItsPeerFromAnAcceptedDatagramOnly) {
  open_both();
  EXPECT_FALSE(slave->send(Bytes{1, 2, 3}));
  ASSERT_TRUE(master->send(Bytes{1, 2, 3}));
  const auto arrival = take(*slave);
  ASSERT_TRUE(arrival);
  EXPECT_EQ(arrival->size, 3u);
  EXPECT_TRUE(arrival->from_peer);
  EXPECT_FALSE(slave->send(Bytes{1}));
  EXPECT_EQ(slave->peer_name(), "");
  slave->adopt_sender();
  EXPECT_EQ(slave->peer_name(), own_name);
  EXPECT_TRUE(slave->send(Bytes{1}));
  EXPECT_TRUE(take(*master));
}

TEST_F(UnixTransportTest, TheMasterHearsItsSlaveOnly) {
  open_both();
  PlacedSocket stranger{DatagramPlace(folder.path() + "/stranger")};
  ASSERT_TRUE(stranger.send(DatagramPlace(master->place()), Bytes{9}));
  const auto arrival = take(*master);
  ASSERT_TRUE(arrival);
  EXPECT_FALSE(arrival->from_peer);
  master->adopt_sender();  // changes nothing: the peer is given
  EXPECT_EQ(master->peer_name(), "");
  EXPECT_FALSE(master->answer(Bytes{1}));
  ASSERT_TRUE(master->send(Bytes{1, 2}));
  EXPECT_TRUE(take(*slave));
}

TEST_F(UnixTransportTest, AnAnswerGoesToTheSenderAndLeavesThePeer) {
  open_both();
  PlacedSocket second{DatagramPlace(folder.path() + "/second")};
  DatagramPlace from;
  ASSERT_TRUE(master->send(Bytes{1}));
  ASSERT_TRUE(take(*slave));
  slave->adopt_sender();
  ASSERT_TRUE(second.send(DatagramPlace(path), Bytes{1}));
  ASSERT_TRUE(take(*slave));
  ASSERT_TRUE(slave->answer(Bytes{1, 2}));
  EXPECT_EQ(second.receive(buffer, from), 2);
  ASSERT_TRUE(slave->send(Bytes{1, 2, 3}));
  const auto arrival = take(*master);
  ASSERT_TRUE(arrival);
  EXPECT_EQ(arrival->size, 3u);
}

TEST_F(UnixTransportTest, WhoCannotBeAnsweredIsNoPeer) {
  ASSERT_TRUE(slave->open());
  const int nameless = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const DatagramPlace to(path);
  EXPECT_EQ(::sendto(nameless, "x", 1, 0, to.address(), to.size), 1);
  ::close(nameless);
  const auto arrival = take(*slave);
  ASSERT_TRUE(arrival);
  EXPECT_FALSE(arrival->from_peer);
  EXPECT_FALSE(slave->answer(Bytes{1}));
}

// Descriptors and credentials as a message's control data.
class Control {
 public:
  void add(int type, const void* data, std::size_t size) {
    message_.msg_control = bytes_.data();
    message_.msg_controllen = used_ + CMSG_SPACE(size);
    auto* part = reinterpret_cast<cmsghdr*>(bytes_.data() + used_);
    part->cmsg_level = SOL_SOCKET;
    part->cmsg_type = type;
    part->cmsg_len = CMSG_LEN(size);
    std::memcpy(CMSG_DATA(part), data, size);
    used_ += CMSG_SPACE(size);
  }
  msghdr& message() { return message_; }

 private:
  alignas(cmsghdr) std::array<std::byte, 128> bytes_{};
  std::size_t used_ = 0;
  msghdr message_{};
};

TEST(SenderOf, IsWhatTheKernelSaysAndNobodyWhereItSaysNothing) {
  Control control;
  EXPECT_FALSE(sender_of(control.message()));
  const int descriptor = 0;
  control.add(SCM_RIGHTS, &descriptor, sizeof descriptor);
  EXPECT_FALSE(sender_of(control.message()));
  const ucred who{4711, kStranger, 5};
  control.add(SCM_CREDENTIALS, &who, sizeof who - 1);
  EXPECT_FALSE(sender_of(control.message())) << "cut off";
  control.add(SCM_CREDENTIALS, &who, sizeof who);
  const auto found = sender_of(control.message());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->pid, 4711);
  EXPECT_EQ(found->uid, kStranger);
}

TEST_F(UnixTransportTest, DescriptorsThatAreHandedOverAreNotTaken) {
  open_both();
  PlacedSocket sender{DatagramPlace(folder.path() + "/sender")};
  const DatagramPlace to(path);
  iovec part{buffer.data(), 1};
  Control control;
  const int descriptors[] = {0, 1, 2};
  control.add(SCM_RIGHTS, descriptors, sizeof descriptors);
  msghdr& message = control.message();
  message.msg_name = const_cast<sockaddr*>(to.address());
  message.msg_namelen = to.size;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  const auto open = [] {
    const std::filesystem::directory_iterator all("/proc/self/fd");
    return std::distance(begin(all), end(all));
  };
  const auto before = open();
  ASSERT_EQ(::sendmsg(sender.fd(), &message, 0), 1);
  const auto arrival = take(*slave);
  ASSERT_TRUE(arrival);
  EXPECT_TRUE(arrival->from_peer) << "its datagram is as good as any of this user";
  EXPECT_EQ(open(), before);
}

// The files' modes would keep him out: they are opened, so that only the kernel's word is left.
class OtherUserTest : public UnixTransportTest {
 protected:
  void SetUp() override {
    if (::geteuid() != 0) GTEST_SKIP() << "only root can be somebody else";
    open_both();
    for (const std::string& at : {folder.path(), folder.path() + "/run"}) {
      ASSERT_EQ(::chmod(at.c_str(), 01777), 0);
    }
  }
  void open_files() {
    for (const std::string& at : {slave->place(), master->place()}) {
      ASSERT_EQ(::chmod(at.c_str(), 0666), 0);
    }
  }
  // What `f` returns in a process of another user; -1: it could not be one.
  static int as_stranger(const std::function<int()>& f) {
    const pid_t child = ::fork();
    if (child == 0) {
      const bool changed = ::setgid(kStranger) == 0 && ::setuid(kStranger) == 0;
      ::_exit(changed ? f() : 255);
    }
    int status = 0;
    return ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) != 255
               ? WEXITSTATUS(status)
               : -1;
  }
  // Bound beside the files, so that it can be answered.
  int say(const std::string& to, const Bytes& bytes) const {
    return as_stranger([&] {
      PlacedSocket socket{DatagramPlace(folder.path() + "/run/eve")};
      return socket.good() && socket.send(DatagramPlace(to), bytes) ? 0 : 1;
    });
  }
};

TEST_F(OtherUserTest, TheFilesKeepHimOut) {
  for (const std::string& at : {slave->place(), master->place()}) {
    EXPECT_EQ(say(at, {1}), 1);
  }
  EXPECT_FALSE(take(*slave));
  EXPECT_FALSE(take(*master));
}

TEST_F(OtherUserTest, WhatHeSaysIsDroppedAtBothEndsAndNeverAnswered) {
  open_files();
  for (UnixTransport* end : {slave.get(), master.get()}) {
    ASSERT_EQ(say(end->place(), {1}), 0);
    const auto arrival = take(*end);
    ASSERT_TRUE(arrival);
    EXPECT_FALSE(arrival->from_peer);
    end->adopt_sender();
    EXPECT_EQ(end->peer_name(), "");
    EXPECT_FALSE(end->answer(Bytes{1}));
  }
  EXPECT_FALSE(slave->send(Bytes{1})) << "he is no peer";
}

// Sound, from a session that the slave would refuse for the leading one, or take without one.
TEST_F(OtherUserTest, ASoundDatagramOfHisIsCountedAsAStrangersAndLeadsNobody) {
  open_files();
  SlavePeer peer{1};
  LinkPump<SlaveState, MasterState> pump{*slave, peer};
  ASSERT_EQ(say(path, datagram(sample_header(7, 1), sample_master())), 0);
  EXPECT_FALSE(pump.receive(kSecond));
  EXPECT_EQ(peer.rejects()[static_cast<std::size_t>(Reject::kSender)], 1u);
  EXPECT_EQ(peer.snapshot().peer_epoch, 0u);
  ASSERT_TRUE(master->send(datagram(sample_header(8, 1), sample_master())));
  EXPECT_TRUE(pump.receive(kSecond)) << "the own user's is taken";
}

// A program of the slave's user that has the slave's path, but not its user any more.
TEST_F(OtherUserTest, AMasterDoesNotHearHimFromTheSlavesOwnSocket) {
  open_files();
  slave->close();
  PlacedSocket socket{DatagramPlace(path)};
  const Bytes bytes = datagram(sample_header(7, 1), sample_slave());
  ASSERT_TRUE(socket.send(DatagramPlace(master->place()), bytes));
  EXPECT_TRUE(take(*master)->from_peer);
  ASSERT_EQ(as_stranger([&] { return socket.send(DatagramPlace(master->place()), bytes) ? 0 : 1; }),
            0);
  const auto arrival = take(*master);
  ASSERT_TRUE(arrival);
  EXPECT_FALSE(arrival->from_peer);
}

}  // namespace
}  // namespace handrail
