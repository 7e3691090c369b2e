// The operator socket as a file, and the protocol on it.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <thread>
#include <utility>

#include "client/api/operator_client.h"
#include "server/base/clock.h"
#include "server/base/folder_owner.h"
#include "server/base/pacer.h"
#include "tests/loopback/operator_bench.h"

namespace handrail {
namespace {

constexpr Nanos kPatience = 20 * kSecond;

class OperatorApi : public testing::Test {
 protected:
  TempFolder folder_;
  const std::string path_ = folder_.path() + "/run/operator.sock";
};

mode_t mode_of(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 ? info.st_mode & 07777 : 0;
}

int bound_socket(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), address.sun_path);
  const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
  EXPECT_EQ(::bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  return fd;
}

// What a killed master leaves behind.
void leave_stale_socket(const std::string& path) { ::close(bound_socket(path)); }

// Listens as long as this process lives, and answers nobody.
void leave_listening(const std::string& path) { EXPECT_EQ(::listen(bound_socket(path), 1), 0); }

pb::Request status_request() {
  pb::Request request;
  request.set_status(true);
  return request;
}

TEST_F(OperatorApi, SocketAndFolderAreForTheirOwnerOnly) {
  const OperatorBench bench(path_);
  ASSERT_TRUE(bench.status().is_ok()) << bench.status().message();
  EXPECT_EQ(mode_of(path_), 0600U);
  EXPECT_EQ(mode_of(folder_.path() + "/run"), 0700U);
}

TEST_F(OperatorApi, ReplacesTheFileOfAMasterThatEnded) {
  ASSERT_EQ(::mkdir((folder_.path() + "/run").c_str(), 0700), 0);
  leave_stale_socket(path_);
  const OperatorBench bench(path_);
  ASSERT_TRUE(bench.status().is_ok()) << bench.status().message();
  EXPECT_TRUE(OperatorClient(path_).call(status_request(), kPatience).is_ok());
}

TEST_F(OperatorApi, RefusesToStartWhereAnotherMasterAnswers) {
  OperatorBench first(path_);
  ASSERT_TRUE(first.status().is_ok());
  {
    const OperatorBench second(path_);
    EXPECT_EQ(second.status().message(),
              "operator socket " + path_ + ": another master answers on it");
  }
  // The first one is unharmed.
  EXPECT_TRUE(OperatorClient(path_).call(status_request(), kPatience).is_ok());
}

TEST_F(OperatorApi, WaitsForAMasterThatStartsInTheSameFolder) {
  const std::string folder = folder_.path() + "/run";
  ASSERT_EQ(::mkdir(folder.c_str(), 0700), 0);
  const int other = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  std::thread ends([other] {
    sleep_until(monotonic_now() + 50 * kMillisecond);
    ::close(other);
  });
  const OperatorBench bench(path_);
  ends.join();
  EXPECT_TRUE(bench.status().is_ok()) << bench.status().message();
}

TEST_F(OperatorApi, LeavesAFileThatIsNoSocketAlone) {
  const std::string file = folder_.write("precious", "data");
  const OperatorBench bench(file);
  EXPECT_EQ(bench.status().message(), "operator socket " + file + ": exists and is not a socket");
  EXPECT_TRUE(std::filesystem::is_regular_file(file));
}

TEST_F(OperatorApi, RefusesAFolderThatOthersMayWriteTo) {
  const std::string run = folder_.path() + "/run";
  ASSERT_EQ(::mkdir(run.c_str(), 0700), 0);
  for (const auto& [mode, text] : {std::pair(0777, "0777"), std::pair(0770, "0770"),
                                   std::pair(01777, "1777"), std::pair(0702, "0702")}) {
    ASSERT_EQ(::chmod(run.c_str(), static_cast<mode_t>(mode)), 0);
    const OperatorBench bench(path_);
    EXPECT_EQ(bench.status().message(), "operator socket " + path_ + ": " + run + " of " +
                                            user_text(::geteuid()) + " has mode " + text +
                                            ": others could replace what is in it, expected 0700");
  }
  ASSERT_EQ(::chmod(run.c_str(), 0750), 0);
  EXPECT_TRUE(OperatorBench(path_).status().is_ok());
}

TEST_F(OperatorApi, RefusesAFolderThatIsALink) {
  const std::string run = folder_.path() + "/run";
  std::filesystem::create_directory_symlink(folder_.path(), run);
  const OperatorBench bench(path_);
  EXPECT_EQ(bench.status().message(), "operator socket " + path_ + ": " + run + " is a link of " +
                                          user_text(::geteuid()) +
                                          " with mode 0777, expected the folder itself");
}

// Somebody else was there before the master.
TEST_F(OperatorApi, AClientSaysWhoElseListens) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can be somebody else";
  constexpr uid_t kStranger = 54321;
  ASSERT_EQ(::chmod(folder_.path().c_str(), 0777), 0);
  const auto meet = [&](const std::string& path) {
    int ready[2];
    EXPECT_EQ(::pipe(ready), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      if (::setuid(kStranger) != 0) ::_exit(1);
      leave_listening(path);
      (void)!::write(ready[1], "", 1);
      ::pause();
    }
    char byte = 0;
    EXPECT_EQ(::read(ready[0], &byte, 1), 1);
    std::string said = OperatorClient(path).call(status_request(), 200 * kMillisecond).message();
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    for (const int end : ready) ::close(end);
    return said;
  };
  const auto refused = [&](const std::string& path, const std::string& why) {
    EXPECT_EQ(meet(path), "no master on " + path +
                              ": uid 54321 listens there, expected root or the owner of a folder "
                              "that nobody else can replace; " +
                              why);
    std::filesystem::remove(path);
  };
  const std::string above = folder_.path(), run = above + "/run";
  refused(above + "/theirs.sock", above + " of " + user_text(0) +
                                      " has mode 0777: others could replace what is in it, "
                                      "expected 0700");
  ASSERT_EQ(::mkdir(run.c_str(), 0777), 0);
  ASSERT_EQ(::chmod(run.c_str(), 01777), 0);
  refused(path_, run + " of " + user_text(0) +
                     " has mode 1777: others could replace what is in it, expected 0700");
  // The folder is theirs, but anybody can put another in its place.
  ASSERT_EQ(::chown(run.c_str(), kStranger, kStranger), 0);
  ASSERT_EQ(::chmod(run.c_str(), 0755), 0);
  refused(path_, above + " of " + user_text(0) +
                     " has mode 0777: others could replace what is in it, expected 0700");
  // Nobody else can, also where others may have folders of their own.
  for (const mode_t mode : {mode_t{0755}, mode_t{01777}}) {
    ASSERT_EQ(::chmod(above.c_str(), mode), 0);
    EXPECT_EQ(meet(path_), "no master on " + path_ + ": no answer in time");
    std::filesystem::remove(path_);
  }
  ASSERT_EQ(::chmod(run.c_str(), 0775), 0);
  refused(path_, run +
                     " of uid 54321 has mode 0775: others could replace what is in it, "
                     "expected 0700");
  ASSERT_EQ(::chmod(run.c_str(), 0755), 0);
  ASSERT_EQ(::chown(above.c_str(), kStranger + 1, kStranger + 1), 0);
  refused(path_, above + " is a folder of uid 54322 with mode 1777, who could replace it");
}

TEST_F(OperatorApi, RefusesAPathTooLongForASocket) {
  const std::string path = folder_.path() + "/" + std::string(108, 'a');
  const OperatorBench bench(path);
  EXPECT_NE(bench.status().message().find("expected 1 to 107"), std::string::npos);
  EXPECT_NE(OperatorClient(path).call(status_request(), kPatience).message().find("1 to 107"),
            std::string::npos);
}

TEST_F(OperatorApi, RemovesItsOwnFileOnly) {
  { const OperatorBench bench(path_); }
  EXPECT_FALSE(std::filesystem::exists(path_));
  {
    const OperatorBench bench(path_);
    std::filesystem::remove(path_);
    leave_stale_socket(path_);
  }
  EXPECT_TRUE(std::filesystem::exists(path_)) << "belonged to somebody else";
}

TEST_F(OperatorApi, AnswersRequestsInOrder) {
  const OperatorBench bench(path_);
  RawClient client(path_);
  ASSERT_TRUE(client.send(status_frame() + status_frame() + status_frame()));
  for (std::uint64_t n = 1; n <= 3; ++n) EXPECT_EQ(client.receive().status().ticks(), n);
}

TEST_F(OperatorApi, UnderstandsAFrameThatComesByteByByte) {
  const OperatorBench bench(path_);
  RawClient client(path_);
  for (const char byte : status_frame()) ASSERT_TRUE(client.send(std::string(1, byte)));
  EXPECT_TRUE(client.receive().done());
}

TEST_F(OperatorApi, RefusesAnOversizeFrameAndCloses) {
  const OperatorBench bench(path_);
  RawClient client(path_);
  const auto header = frame_header(kMaxFrame + 1);
  ASSERT_TRUE(client.send(std::string(header.begin(), header.end())));
  const pb::Reply reply = client.receive();
  EXPECT_FALSE(reply.done());
  EXPECT_EQ(reply.reason(), "a request of 65537 bytes, expected at most 65536");
  EXPECT_EQ(client.receive().reason(), "(closed)");
}

TEST_F(OperatorApi, TakesAFrameOfExactlyTheLargestSize) {
  OperatorBench bench(path_);
  RawClient client(path_);
  pb::Request request;
  request.set_scene_load(std::string(kMaxFrame - 4, 'a'));
  ASSERT_EQ(request.ByteSizeLong(), kMaxFrame);
  // Its echo would be too long a reply to care about: only see that it arrives.
  ASSERT_TRUE(client.send(framed(request.SerializeAsString())));
  client.receive();
  EXPECT_EQ(bench.master.requests, 1);
}

TEST_F(OperatorApi, RefusesGarbageAndEmptyOrdersAndCloses) {
  OperatorBench bench(path_);
  const std::pair<std::string, std::string> cases[] = {
      {framed("\xff\xff\xff\xff\xff"), "the request is garbled"},
      {framed(""), "the request holds no order"},
      {framed(std::string("\x10\x00", 2)), "the request holds no order"},  // engage: false
  };
  for (const auto& [frame, reason] : cases) {
    RawClient client(path_);
    ASSERT_TRUE(client.send(frame));
    const pb::Reply reply = client.receive();
    EXPECT_FALSE(reply.done());
    EXPECT_EQ(reply.reason(), reason);
    EXPECT_EQ(client.receive().reason(), "(closed)");
  }
  EXPECT_EQ(bench.master.requests, 0);
}

TEST_F(OperatorApi, PassesClutchOffAsAnOrder) {
  const OperatorBench bench(path_);
  pb::Request request;
  request.set_clutch(false);
  const Result<pb::Reply> reply = OperatorClient(path_).call(request, kPatience);
  ASSERT_TRUE(reply.is_ok()) << reply.message();
  EXPECT_EQ(reply->reason(), "clutch: false");
}

}  // namespace
}  // namespace handrail
