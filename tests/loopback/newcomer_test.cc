// The first hour: a demo that is interrupted, a painted scene, a second user on the computer.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>

#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class NewcomerTest : public WholeCell {
 protected:
  // Ends a demo in motion: the exit code, within 2 s.
  int interrupt(Program& demo) {
    const Nanos start = monotonic_now();
    demo.send(SIGINT);
    const int code = demo.finish();
    EXPECT_LT(monotonic_now() - start, 2 * kSecond);
    EXPECT_THAT(demo.output(), HasSubstr("interrupted; disengaged"));
    EXPECT_EQ(status().state(), "off");
    return code;
  }
};

TEST_F(NewcomerTest, CtrlCInADemoDisengagesAndTheNextBeginsAtA) {
  {
    Program demo(folder, "handrail", {"demo", "--socket", socket()});
    (void)demo.after("without tools ...");
    const Vec3 a = mm(status().tip());
    ASSERT_TRUE(eventually([&](const pb::Status& s) { return (mm(s.tip()) - a).norm() > 20.0; }));
    EXPECT_EQ(interrupt(demo), 130);
  }
  Program next(folder, "handrail", {"demo", "--socket", socket()});
  (void)next.after("going to A");
  (void)next.after("without tools ...");
  EXPECT_LT((mm(status().slave_command()) - Vec3(350, 0, 429)).norm(), 15.0);
  EXPECT_EQ(interrupt(next), 130);
}

TEST_F(NewcomerTest, CtrlCWhileADemoWaitsToEngageEndsItToo) {
  slave->send(SIGSTOP);
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.packet_age_ms() > 100.0; }));
  Program demo(folder, "handrail", {"demo", "--socket", socket()});
  sleep_until(monotonic_now() + kSecond);
  EXPECT_EQ(interrupt(demo), 130);
  slave->send(SIGCONT);
}

TEST_F(NewcomerTest, ADemoWhoseReaderGoesDisengages) {
  const std::string said = folder.path() + "/said.txt";
  Program shell(folder, "/bin/bash",
                {"-c", std::string(HANDRAIL_BIN_DIR) + "/handrail demo --socket " + socket() +
                           " 2>" + said + " | head -n 1; exit ${PIPESTATUS[0]}"});
  EXPECT_EQ(shell.finish(), 1);
  std::ostringstream text;
  text << std::ifstream(said).rdbuf();
  EXPECT_EQ(text.str().find("handrail: the standard output cannot be written"), 0u) << text.str();
  EXPECT_EQ(status().state(), "off");
}

// The hand is where the scene says, in the aisle, and nothing pushes it.
TEST_F(NewcomerTest, InAPaintedSceneTheHandBeginsFreeAtItsStart) {
  master->send(SIGTERM);
  EXPECT_EQ(master->finish(), 0);
  client.close();
  master = launch("handrail-master", "link_port: 0 operator_socket: '" + socket() +
                                         "' scene: 'painted-aisle' device { kind: SIM_JOYSTICK }");
  (void)master->after("READY ");
  sleep_until(monotonic_now() + kSecond);
  const pb::Status s = status();
  ASSERT_TRUE(s.has_walls());
  EXPECT_FALSE(s.walls().touching());
  ASSERT_EQ(s.walls().proxy_mm_size(), 2);
  EXPECT_NEAR(s.walls().proxy_mm(0), -25.0, 3.0);  // of the scene, and the hand's straying
  EXPECT_NEAR(s.walls().proxy_mm(1), -10.0, 3.0);
  EXPECT_LT(s.device_force().magnitude_n(), 1.0);
}

// As user `number`, in a user name space of its own.
std::vector<std::string> as_user(int number, const std::string& program,
                                 std::vector<std::string> words) {
  std::vector<std::string> out = {"-U", "--map-user=" + std::to_string(number),
                                  std::string(HANDRAIL_BIN_DIR) + "/" + program};
  out.insert(out.end(), words.begin(), words.end());
  return out;
}

TEST(TwoUsers, BothStartWithTheDefaultsAndAreToldHowToBeGrantedRealTime) {
  if (::access("/usr/bin/unshare", X_OK) != 0) GTEST_SKIP() << "needs unshare";
  const TempFolder folder;
  {
    Program probe(folder, "/usr/bin/unshare", {"-U", "/bin/true"});
    if (probe.finish() != 0) GTEST_SKIP() << "no user name spaces here";
  }
  const int first = 4'000'000 + ::getpid(), second = 9'000'000 + ::getpid();
  std::vector<std::unique_ptr<Program>> running;
  for (const int user : {first, second}) {
    for (const std::string program : {"handrail-rig", "handrail-slave", "handrail-master"}) {
      running.push_back(
          std::make_unique<Program>(folder, "/usr/bin/unshare", as_user(user, program, {})));
      EXPECT_THAT(running.back()->after("READY "), HasSubstr("port=")) << user << program;
      (void)running.back()->after("not in real time: ");
      EXPECT_THAT(running.back()->output(), HasSubstr("/etc/security/limits.d/"));
    }
  }
  for (const int user : {first, second}) {
    Program engage(folder, "/usr/bin/unshare", as_user(user, "handrail", {"engage"}));
    EXPECT_EQ(engage.finish(), 0) << engage.output();
  }
  for (const auto& program : running) {
    program->send(SIGTERM);
    EXPECT_EQ(program->finish(), 0);
  }
  for (const int user : {first, second}) {
    std::filesystem::remove_all("/tmp/handrail-" + std::to_string(user));
  }
}

}  // namespace
}  // namespace handrail
