// Two real programs with nothing in common but the emulated network.
#include <dirent.h>

#include <cctype>
#include <iterator>

#include "tests/emulator/netfault_bench.h"

namespace handrail::emulator {
namespace {

// The processes that have `word` on their command line.
std::vector<pid_t> running_with(const std::string& word) {
  std::vector<pid_t> found;
  DIR* const all = ::opendir("/proc");
  while (const dirent* entry = all == nullptr ? nullptr : ::readdir(all)) {
    if (std::isdigit(static_cast<unsigned char>(entry->d_name[0])) == 0) continue;
    std::ifstream file(std::string("/proc/") + entry->d_name + "/cmdline", std::ios::binary);
    const std::string line((std::istreambuf_iterator<char>(file)),
                           std::istreambuf_iterator<char>());
    if (line.find(word) != std::string::npos) found.push_back(std::atoi(entry->d_name));
  }
  if (all != nullptr) ::closedir(all);
  return found;
}

// Waits until there are so many of them.
::testing::AssertionResult comes_to(std::size_t wanted, const std::string& word) {
  const Nanos give_up = monotonic_now() + Program::kPatience;
  std::size_t found = 0;
  while ((found = running_with(word).size()) != wanted) {
    if (monotonic_now() > give_up) return ::testing::AssertionFailure() << found << " processes";
    sleep_until(monotonic_now() + 5 * kMillisecond);
  }
  return ::testing::AssertionSuccess();
}

TEST_F(NetfaultTest, WithoutFaultsARoundTripTakesAFractionOfAMillisecond) {
  for (const char* to : {"10.77.0.2", "fd77::2"}) {
    const std::string report = run(echo_and_ping({}, std::string(to) + " 7000 1000 1000 200"));
    const std::string pings = printed("near-main");
    EXPECT_NE(pings.find("sent=1000 answered=1000 again=0 broken=0"), std::string::npos) << pings;
    const std::string trips = pings.substr(pings.rfind("TRIPS"));
    std::printf("%s: %s", to, trips.c_str());
    // What the emulator takes; the median is also what else the machine does.
    EXPECT_LT(figure(trips, "least="), 300.0);  // [us]
    EXPECT_LT(figure(trips, "p50="), 5000.0);
    EXPECT_EQ(count(report, "to_far", "sent"), 1000) << report;
    EXPECT_EQ(count(report, "to_near", "delivered"), 1000) << report;
    std::filesystem::remove(folder_.path() + "/near-main.out");
  }
}

// The jitter of both ways together: 60 to 140 ms.
TEST_F(NetfaultTest, DelayAndJitterAreThoseThatWereAskedFor) {
  run(echo_and_ping({"--set", "both { delay_ms: 50 jitter_ms: 20 }"},
                    "10.77.0.2 7000 60 50000 500"));
  const std::string pings = printed("near-main");
  EXPECT_NE(pings.find("answered=60 again=0 broken=0"), std::string::npos) << pings;
  const std::string trips = pings.substr(pings.rfind("TRIPS"));
  std::printf("50 +- 20 ms each way: %s", trips.c_str());
  EXPECT_GE(figure(trips, "least="), 60e3);  // [us]
  EXPECT_NEAR(figure(trips, "p50="), 100e3, 15e3);
  EXPECT_LE(figure(trips, "worst="), 150e3);
}

TEST_F(NetfaultTest, LossIsSeenByTheProgramsAsItIsCounted) {
  const std::string report = run(
      echo_and_ping({"--set", "both { loss: 0.2 duplicate: 0.1 }"}, "fd77::2 7000 1000 1000 200"));
  const std::string pings = printed("near-main");
  const double answers = figure(pings, "answered=") + figure(pings, "again=");
  EXPECT_EQ(answers, count(report, "to_near", "delivered")) << report << pings;
  EXPECT_EQ(count(report, "to_far", "delivered"), count(report, "to_near", "sent")) << report;
  EXPECT_NEAR(count(report, "to_far", "lost"), 200.0, 51.0) << report;  // 4 standard deviations
  EXPECT_EQ(figure(pings, "broken="), 0.0);
}

// The checksums are right: the damage reaches the program, as many times as it was done.
TEST_F(NetfaultTest, CorruptedPacketsReachTheProgram) {
  for (const char* to : {"10.77.0.2", "fd77::2"}) {
    const std::string report = run(echo_and_ping({"--set", "to_near { corrupt: 0.3 }"},
                                                 std::string(to) + " 7000 500 1000 200"));
    const std::string pings = printed("near-main");
    EXPECT_GT(count(report, "to_near", "corrupted"), 100.0) << report;
    EXPECT_EQ(figure(pings, "broken="), count(report, "to_near", "corrupted")) << report << pings;
    std::filesystem::remove(folder_.path() + "/near-main.out");
  }
}

TEST_F(NetfaultTest, TheSidesHaveNothingInCommonButTheNetwork) {
  // The far side leaves a file in each common place, listens on loopback, and near looks for them.
  const std::string look =
      "sleep 0.5; ls -A /tmp /var/tmp /dev/shm /run; echo HOME=$HOME SIDE=$HANDRAIL_SIDE; " +
      std::string(kEcho) + " ping 127.0.0.1 7000 20 1000 100";
  const std::string leave =
      "for d in /tmp /var/tmp /dev/shm /run $HOME $XDG_RUNTIME_DIR; do touch $d/left-here; done; "
      "ls $HOME; exec " +
      std::string(kEcho) + " serve 7000";
  run(served() +
      Words{"--until", "near", "--", "near:", "sh", "-c", look, "--", "far:", "sh", "-c", leave});
  EXPECT_NE(printed("far-main").find("left-here"), std::string::npos) << printed("far-main");
  EXPECT_EQ(printed("near-main").find("left-here"), std::string::npos) << printed("near-main");
  EXPECT_NE(printed("near-main").find("HOME=/tmp/home SIDE=near"), std::string::npos);
  EXPECT_NE(printed("near-main").find("sent=20 answered=0"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists("/tmp/left-here"));
}

TEST_F(NetfaultTest, ASharedFolderIsSeenByBoth) {
  folder_.write("given", "hello");
  const std::string file = folder_.path() + "/given";
  for (const bool shared : {false, true}) {
    const Words options = shared ? Words{"--share", folder_.path()} : Words{};
    const std::string report = run(options + Words{"--until", "both", "--", "near:", "test", "-e",
                                                   file, "--", "far:", "test", "-e", file},
                                   shared ? 0 : 1);
    EXPECT_EQ(report.find("near: exit 1") == std::string::npos, shared) << report;
    EXPECT_EQ(report.find("far: exit 1") == std::string::npos, shared) << report;
  }
}

// Also those that left their session and their parents, and whatever state all of them are in.
TEST_F(NetfaultTest, NothingIsLeftWhenTheEmulatorIsKilled) {
  for (const bool stopped : {false, true}) {
    const std::string mark = (stopped ? "98766." : "98765.") + std::to_string(::getpid());
    const std::string command = "sleep " + mark + " & setsid sleep " + mark + " & wait";
    Program netfault(
        folder_, "handrail-netfault",
        {"--until", "both", "--", "near:", "sh", "-c", command, "--", "far:", "sh", "-c", command});
    // The emulator, both first processes, both shells, and what these started.
    ASSERT_TRUE(comes_to(9, mark)) << netfault.output();
    for (const pid_t pid : running_with(mark)) {
      if (stopped && pid != netfault.pid()) ::kill(pid, SIGSTOP);
    }
    netfault.kill();
    EXPECT_TRUE(comes_to(0, mark));
  }
}

TEST_F(NetfaultTest, NothingIsLeftWhenItIsAskedToEndAndSomeDoNotWant) {
  const std::string mark = "98764." + std::to_string(::getpid());
  Program netfault(folder_, "handrail-netfault",
                   {"--json", "--until", "both", "--", "near:", "sh", "-c",
                    "trap '' TERM; sleep " + mark + " & wait; wait", "--", "far:", "sleep", mark});
  ASSERT_TRUE(comes_to(6, mark)) << netfault.output();
  netfault.send(SIGTERM);
  EXPECT_EQ(netfault.finish(), 130) << netfault.output();
  EXPECT_TRUE(comes_to(0, mark));
  EXPECT_NE(netfault.output().find("\"ending\":\"signal 9\""), std::string::npos);
  EXPECT_NE(netfault.output().find("\"ending\":\"signal 15\""), std::string::npos);
}

TEST_F(NetfaultTest, TheExitCodeSaysHowItEnded) {
  EXPECT_EQ(run({"--until", "both", "--", "near:", "true", "--", "far:", "true"}, 0).find("exit 1"),
            std::string::npos);
  EXPECT_NE(run({"--", "near:", "sh", "-c", "exit 3"}, 1).find("near: exit 3"), std::string::npos);
  EXPECT_NE(run({"--", "far:", "/nowhere/x"}, 1)
                .find("far: cannot run: /nowhere/x: No such file or directory"),
            std::string::npos);
  EXPECT_NE(run({"--bogus"}, 2).find("'--bogus': expected --network"), std::string::npos);
}

TEST_F(NetfaultTest, AMachineThatAllowsNoneIsNamedWithACodeOfItsOwn) {
  Program can(folder_, "/usr/bin/unshare", {"-Ur", "true"});
  if (can.finish() != 0) GTEST_SKIP() << can.output();
  const std::string netfault = HANDRAIL_BIN_DIR "/handrail-netfault";
  Program none(
      folder_, "/usr/bin/unshare",
      {"-Ur", "sh", "-c",
       "echo 0 > /proc/sys/user/max_net_namespaces && exec " + netfault + " -- near: true"});
  EXPECT_EQ(none.finish(), 77) << none.output();
  EXPECT_NE(none.output().find("this machine does not allow namespaces of its own: No space left "
                               "on device (see sysctl user.max_net_namespaces"),
            std::string::npos)
      << none.output();
  EXPECT_NE(none.output().find("what runs without: "), std::string::npos);
}

}  // namespace
}  // namespace handrail::emulator
