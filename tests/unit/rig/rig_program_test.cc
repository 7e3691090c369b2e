// The program itself: what it prints, and how it ends.
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <vector>

#include "devices/rig/tap.h"
#include "server/base/own_places.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

// One run of handrail-rig; both outputs come through one pipe.
class RigProcess {
 public:
  explicit RigProcess(std::vector<std::string> arguments) {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    arguments.insert(arguments.begin(), HANDRAIL_BIN_DIR "/handrail-rig");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    EXPECT_EQ(posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    output_ = fdopen(ends[0], "r");
  }
  ~RigProcess() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      finish();
    }
    fclose(output_);
  }

  std::string line() {
    char buffer[512];
    return fgets(buffer, sizeof(buffer), output_) != nullptr ? buffer : "";
  }
  // READY, after what a busy machine made it log before.
  std::string ready() {
    std::string next = line();
    while (next.starts_with('[')) next = line();
    return next;
  }
  std::string rest() {
    std::string all;
    for (std::string next; !(next = line()).empty();) all += next;
    return all;
  }
  void send(int signal) { kill(pid_, signal); }
  // Waits for the end; the exit code, or minus the signal.
  int finish() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t pid_ = 0;
  FILE* output_ = nullptr;
};

class RigProgram : public ::testing::Test {
 protected:
  std::string write_config(const std::string& text) { return folder_.write("rig.txtpb", text); }
  // Runs to the end and expects `code` and every one of `parts` in the output.
  void expect_end(std::vector<std::string> arguments, int code, std::vector<std::string> parts) {
    RigProcess rig(std::move(arguments));
    const std::string output = rig.rest();
    EXPECT_EQ(rig.finish(), code) << output;
    for (const std::string& part : parts) {
      EXPECT_NE(output.find(part), std::string::npos) << "no '" << part << "' in: " << output;
    }
  }

  TempFolder folder_;
};

TEST_F(RigProgram, AnnouncesItsPortsAndEndsCleanlyOnASignal) {
  const std::string config = write_config("robot_port: 0 sensor_port: 0");
  for (const int signal : {SIGINT, SIGTERM}) {
    RigProcess rig({"--config", config});
    int robot = 0;
    int sensor = 0;
    const std::string ready = rig.ready();
    EXPECT_EQ(std::sscanf(ready.c_str(), "READY robot_port=%d sensor_port=%d", &robot, &sensor), 2)
        << ready;
    EXPECT_GT(robot, 0);
    EXPECT_GT(sensor, 0);
    rig.send(signal);
    EXPECT_EQ(rig.finish(), 0);
  }
}

TEST_F(RigProgram, SaysWhichPortIsInUse) {
  RigProcess first({"--config", write_config("robot_port: 0 sensor_port: 0")});
  int robot = 0;
  ASSERT_EQ(std::sscanf(first.ready().c_str(), "READY robot_port=%d", &robot), 1);
  const std::string taken = "robot_port: " + std::to_string(robot) + " sensor_port: 0";
  expect_end({"--config", write_config(taken)}, 2,
             {"robot port " + own_address() + ":" + std::to_string(robot), "in use",
              "set robot_port to another"});
}

TEST_F(RigProgram, ChecksAConfigurationWithoutStarting) {
  expect_end({"--check"}, 0, {"ok"});
  expect_end({"--check", "--config", write_config("drop_share: 0.01")}, 0, {"ok"});
  expect_end({"--check", "--config", write_config("drop_share: 2")}, 2, {"drop_share", "2"});
  expect_end({"--check", "--config", write_config("servo_lags_ms: 45")}, 2, {"servo_lags_ms"});
  expect_end({"--check", "--config", write_config("start_joints_deg: [0, 0, 40, 0, 90, 0]")}, 2,
             {"rig.txtpb", "J3 = 40"});
  expect_end({"--config", "/nowhere/rig.txtpb"}, 2, {"/nowhere/rig.txtpb"});
}

TEST_F(RigProgram, ATapIsReadWhileItRunsAndAfterItIsKilled) {
  const std::string config = write_config("robot_port: 0 sensor_port: 0 tap: 'rig.tap'");
  const std::string path = folder_.path() + "/rig.tap";
  RigProcess rig({"--config", config});
  EXPECT_EQ(rig.ready().substr(0, 5), "READY");
  // Until the newest record says `did`.
  const auto wait_for = [&](std::uint32_t did) {
    for (int i = 0; i < 1000; ++i) {
      const auto tap = read_tap(path);
      if (tap && !tap->records.empty() && tap->records.back().did == did) return true;
      usleep(10'000);
    }
    return false;
  };
  EXPECT_TRUE(wait_for(0));
  rig.send(SIGUSR2);
  EXPECT_TRUE(wait_for(kTapCableOut));
  rig.send(SIGUSR2);
  EXPECT_TRUE(wait_for(0));
  const std::size_t before = read_tap(path)->records.size();
  rig.send(SIGKILL);
  EXPECT_EQ(rig.finish(), -SIGKILL);
  EXPECT_GE(read_tap(path)->records.size(), before);
}

TEST_F(RigProgram, SaysWhyATapCannotBeMade) {
  expect_end({"--config", write_config("robot_port: 0 sensor_port: 0 tap: 'none/rig.tap'")}, 2,
             {folder_.path() + "/none/rig.tap", "No such file"});
  expect_end({"--check", "--config", write_config("tap: ''")}, 2, {"rig.txtpb:1", "tap", "empty"});
}

TEST_F(RigProgram, HelpsAndRefusesWhatItDoesNotKnow) {
  expect_end({"--help"}, 0, {"usage: handrail-rig", "--config", "SIGUSR1", "SIGUSR2"});
  expect_end({"--version"}, 0, {"handrail-rig "});
  expect_end({"--prot", "3"}, 2, {"'--prot'", "expected"});
}

}  // namespace
}  // namespace handrail
