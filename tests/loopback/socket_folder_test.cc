// The real master and command line where the operators' socket lies in a folder that is not safe.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "server/base/folder_owner.h"
#include "tests/loopback/program.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

constexpr int kUsage = 2, kNoMaster = 3;
constexpr uid_t kStranger = 54321;

class SocketFolderTest : public ::testing::Test {
 protected:
  SocketFolderTest() { std::filesystem::create_directory(run); }

  std::string config() const {
    return folder.write("master.cfg", "link_socket: '" + link_folder +
                                          "/link.sock' operator_socket: '" + run +
                                          "/operator.sock'");
  }
  // A master that does not start: what it says.
  std::string refusal() {
    Program master(folder, "handrail-master", {"--config", config()});
    EXPECT_EQ(master.finish(), kUsage);
    EXPECT_THAT(master.output(), ::testing::Not(HasSubstr("READY")));
    return master.output();
  }
  std::string start_of_refusal() const {
    return "handrail-master: operator socket " + run + "/operator.sock: ";
  }
  std::pair<int, std::string> stop() {
    Program program(folder, "handrail", {"stop", "--socket", run + "/operator.sock"});
    const int code = program.finish();
    return {code, program.output()};
  }

  TempFolder folder;
  const std::string run = folder.path() + "/run";
  std::string link_folder = folder.path();
  const std::string self = user_text(::geteuid());
};

TEST_F(SocketFolderTest, AMasterRefusesALink) {
  std::filesystem::rename(run, folder.path() + "/elsewhere");
  std::filesystem::create_directory_symlink(folder.path() + "/elsewhere", run);
  EXPECT_EQ(refusal(), start_of_refusal() + run + " is a link of " + self +
                           " with mode 0777, expected the folder itself\n");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() + "/elsewhere"));
}

TEST_F(SocketFolderTest, AMasterRefusesAFolderOfAGroup) {
  ASSERT_EQ(::chmod(run.c_str(), 0770), 0);
  EXPECT_EQ(refusal(), start_of_refusal() + run + " of " + self +
                           " has mode 0770: others could replace what is in it, expected 0700\n");
  EXPECT_TRUE(std::filesystem::is_empty(run));
}

TEST_F(SocketFolderTest, AMasterRefusesAFolderOfSomebodyElse) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a folder away";
  ASSERT_EQ(::chmod(run.c_str(), 0755), 0);
  ASSERT_EQ(::chown(run.c_str(), kStranger, kStranger), 0);
  EXPECT_EQ(refusal(), start_of_refusal() + run + " is a folder of uid 54321 with mode 0755, " +
                           "expected one of " + self + " or root\n");
}

// As root stops the master of a user, below /tmp.
TEST_F(SocketFolderTest, ACommandTrustsTheOwnerOfASafeFolderAndNobodyElse) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can be somebody else";
  ASSERT_EQ(::chmod(folder.path().c_str(), 01777), 0);
  ASSERT_EQ(::chown(run.c_str(), kStranger, kStranger), 0);
  ASSERT_EQ(::chmod(run.c_str(), 0700), 0);
  link_folder = run;
  const std::string file = config();
  const std::string program = HANDRAIL_BIN_DIR "/handrail-master", out = folder.path() + "/out";
  ASSERT_EQ(::chmod(file.c_str(), 0644), 0);
  const pid_t master = ::fork();
  if (master == 0) {
    const bool stranger = ::setgid(kStranger) == 0 && ::setuid(kStranger) == 0;
    if (!stranger || ::access(program.c_str(), X_OK) != 0) ::_exit(126);
    if (std::freopen(out.c_str(), "w", stdout) == nullptr) ::_exit(127);
    ::execl(program.c_str(), program.c_str(), "--config", file.c_str(), nullptr);
    ::_exit(127);
  }
  const Nanos give_up = monotonic_now() + Program::kPatience;
  int ended = 0;
  while (!std::filesystem::exists(run + "/operator.sock") && monotonic_now() < give_up &&
         ::waitpid(master, &ended, WNOHANG) == 0) {
    sleep_until(monotonic_now() + 5 * kMillisecond);
  }
  if (WIFEXITED(ended) && WEXITSTATUS(ended) == 126) {
    GTEST_SKIP() << "another user cannot start what was built here";
  }
  EXPECT_THAT(stop().second, HasSubstr("none heard it"));
  EXPECT_EQ(stop().first, 1);
  ASSERT_EQ(::chmod(run.c_str(), 0770), 0);
  const auto [code, said] = stop();
  EXPECT_EQ(code, kNoMaster);
  EXPECT_THAT(said, HasSubstr("uid 54321 listens there, expected root or the owner of a folder "
                              "that nobody else can replace; " +
                              run + " of uid 54321 has mode 0770"));
  ::kill(master, SIGTERM);
  EXPECT_EQ(::waitpid(master, nullptr, 0), master);
}

}  // namespace
}  // namespace handrail
