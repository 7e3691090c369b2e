// The real slave daemon between a simulated laboratory and a master played by the test.
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio.hpp>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "devices/rig/rig_server.h"
#include "server/base/clock.h"
#include "server/base/own_places.h"
#include "server/base/pacer.h"
#include "server/link/pump.h"
#include "server/link/unix_transport.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

// A program whose standard output and error come through one pipe.
class Program {
 public:
  explicit Program(std::vector<std::string> words) {
    int ends[2];
    if (::pipe(ends) != 0) return;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 2);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    if (::posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), environ) != 0) pid_ = -1;
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    out_ = ::fdopen(ends[0], "r");
  }
  ~Program() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      (void)exit_code();
    }
    if (out_ != nullptr) std::fclose(out_);
  }

  // The next line that begins with `start`; empty at the end of the output.
  std::string line(const std::string& start) {
    char text[512];
    while (std::fgets(text, sizeof text, out_) != nullptr) {
      if (std::string(text).starts_with(start)) return text;
    }
    return "";
  }
  // Everything from here to the end of the output.
  std::vector<std::string> rest() {
    std::vector<std::string> lines;
    char text[512];
    while (std::fgets(text, sizeof text, out_) != nullptr) lines.push_back(text);
    return lines;
  }
  void terminate() const { ::kill(pid_, SIGTERM); }
  // Waits for the end; -1 when a signal ended it.
  int exit_code() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_ = -1;
  std::FILE* out_ = nullptr;
};

const std::string kSlave = HANDRAIL_BIN_DIR "/handrail-slave";

class SlaveDaemonTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(rig.open(own_address(), 0, 0));
    rig_thread = std::thread([this] { rig.run(); });
    const std::string config = folder.write(
        "slave.config",
        "link_socket: '" + link_socket + "'\nrobot { port: " + std::to_string(rig.robot_port()) +
            " }\nforce_sensor { port: " + std::to_string(rig.sensor_port()) + " }\n");
    slave = std::make_unique<Program>(std::vector<std::string>{kSlave, "--config", config});
    ASSERT_EQ(slave->line("READY"), "READY link=" + link_socket + "\n");
    ASSERT_TRUE(transport.open());
  }
  void TearDown() override {
    stop_rig();
    slave.reset();
  }
  void stop_rig() {
    if (!rig_thread.joinable()) return;
    rig.stop();
    rig_thread.join();
  }

  // Plays the master until `condition` or for twenty seconds.
  template <typename Condition>
  bool play(Condition condition) {
    const Nanos give_up = monotonic_now() + 20 * kSecond;
    while (monotonic_now() < give_up) {
      const Nanos now = monotonic_now();
      (void)pump.receive(now);
      if (condition()) return true;
      pump.send(now, master);
      sleep_until(now + kMillisecond);
    }
    return false;
  }
  const SlaveState& said() const { return peer.newest(); }

  void engage() {
    ASSERT_TRUE(play([&] { return said().has_pose && said().has_wrench; }));
    master.scene = said().scene;
    master.hashes = said().hashes;
    master.desired = Desired::kEngaged;
    master.state = SessionState::kAligning;
    master.has_command = true;
    ASSERT_TRUE(play([&] {
      master.X_SU = said().X_ST_command;
      return said().state == SessionState::kEngaged;
    })) << describe(said().reason);
    master.state = SessionState::kEngaged;
  }

  TempFolder folder;
  const std::string link_socket = folder.path() + "/link.sock";
  RigServer rig{RigOptions{}};
  std::thread rig_thread;
  std::unique_ptr<Program> slave;
  boost::asio::io_context io;
  UnixTransport transport{io, UnixTransport::End::kMaster, link_socket};
  MasterPeer peer{random_session_id()};
  LinkPump<MasterState, SlaveState> pump{transport, peer};
  MasterState master;
};

TEST_F(SlaveDaemonTest, EngagingMovesNothingAndFollowingReachesTheCommand) {
  ASSERT_TRUE(play([&] { return said().has_pose; }));
  const Pose before = said().X_ST_command;
  engage();
  EXPECT_EQ((said().X_ST_command.p - before.p).norm(), 0.0);
  master.X_SU.p.z() += 0.02;
  EXPECT_TRUE(play([&] { return (said().X_ST_command.p - master.X_SU.p).norm() < 1e-6; }));
  EXPECT_TRUE(play([&] { return (said().X_ST.p - master.X_SU.p).norm() < 1e-3; }));
}

TEST_F(SlaveDaemonTest, AProgramThatSpeaksTheProtocolWithoutOurSceneDrivesNothing) {
  ASSERT_TRUE(play([&] { return said().has_pose && said().has_wrench; }));
  const Pose before = said().X_ST_command;
  master.desired = Desired::kEngaged;
  master.has_command = true;
  for (int i = 0; i < 200; ++i) {
    master.state = i < 100 ? SessionState::kAligning : SessionState::kEngaged;
    master.X_SU = said().X_ST_command;
    if (i >= 100) master.X_SU.p.z() += 0.02;
    const std::uint64_t heard = peer.snapshot().accepted;
    ASSERT_TRUE(play([&] { return peer.snapshot().accepted > heard + 2; }));
    ASSERT_EQ(said().state, SessionState::kOff);
  }
  EXPECT_EQ(said().reason, Reason::kSceneDiffers);
  EXPECT_EQ((said().X_ST_command.p - before.p).norm(), 0.0);
}

TEST_F(SlaveDaemonTest, SilenceOfTheMasterLatchesUntilReset) {
  engage();
  sleep_until(monotonic_now() + 400 * kMillisecond);
  ASSERT_TRUE(play([&] { return said().state == SessionState::kFault; }));
  EXPECT_EQ(said().fault, Reason::kLinkLost);
  master.desired = Desired::kOff;
  master.state = SessionState::kOff;
  master.fault_reset = said().fault_epoch;
  EXPECT_TRUE(play([&] { return said().state == SessionState::kOff; }));
}

TEST_F(SlaveDaemonTest, ADeadControllerIsAFaultAndTheDaemonLivesOn) {
  engage();
  stop_rig();
  ASSERT_TRUE(play([&] { return said().state == SessionState::kFault; }));
  EXPECT_TRUE(said().fault == Reason::kRobotLost || said().fault == Reason::kSensorMissing);
  const std::uint64_t before = peer.snapshot().accepted;
  EXPECT_TRUE(play([&] { return peer.snapshot().accepted > before + 100; }));
}

TEST_F(SlaveDaemonTest, TermStopsTheMovingArmAndExitsWithZero) {
  engage();
  const double start = said().X_ST_command.p.z();
  master.X_SU.p.z() += 0.2;
  ASSERT_TRUE(play([&] { return said().X_ST_command.p.z() > start + 0.005; }));
  slave->terminate();
  (void)play([&] { return said().reason == Reason::kShutdown; });
  EXPECT_EQ(slave->exit_code(), 0);
}

TEST_F(SlaveDaemonTest, ASecondDaemonOnItsSocketEndsWithTwo) {
  const std::string config = folder.write("second.config", "link_socket: 'link.sock'\n");
  Program second({kSlave, "--config", config});
  EXPECT_EQ(second.line("handrail-slave: "),
            "handrail-slave: link socket " + link_socket + ": another slave answers on it\n");
  EXPECT_EQ(second.exit_code(), 2);
}

// Where the controller should be, somebody who sends one answer more to each question; none is one.
class NoController {
 public:
  explicit NoController(bool answers)
      : socket_(io_, {boost::asio::ip::make_address("127.0.0.1"), 0}) {
    if (answers) hear();
    thread_ = std::thread([this] { io_.run(); });
  }
  ~NoController() {
    boost::asio::post(io_, [this] { socket_.close(); });
    work_.reset();
    thread_.join();
  }
  int port() const { return socket_.local_endpoint().port(); }

 private:
  void hear() {
    socket_.async_receive_from(boost::asio::buffer(bytes_), from_, [this](auto error, auto) {
      if (error) return;
      ++asked_;
      for (int i = 0; i < asked_; ++i) {
        boost::system::error_code ignored;
        socket_.send_to(boost::asio::buffer(bytes_, 10), from_, 0, ignored);
      }
      hear();
    });
  }
  boost::asio::io_context io_{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{
      io_.get_executor()};
  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint from_;
  std::array<char, 512> bytes_{};
  int asked_ = 0;
  std::thread thread_;
};

class SlaveAlone : public ::testing::TestWithParam<bool> {};

TEST_P(SlaveAlone, WithoutAControllerIsALineWhenItBeginsAndNothingASecond) {
  const NoController nobody(GetParam());
  TempFolder folder;
  Program slave({kSlave, "--config",
                 folder.write("alone.config", "link_socket: 'link.sock' robot { port: " +
                                                  std::to_string(nobody.port()) +
                                                  " } force_sensor { enabled: false }")});
  ASSERT_FALSE(slave.line("READY").empty());
  sleep_until(monotonic_now() + 6 * kSecond);  // it tries once a second
  slave.terminate();
  const std::vector<std::string> lines = slave.rest();
  EXPECT_EQ(slave.exit_code(), 0);
  const auto with = [&lines](const std::string& part) {
    return std::count_if(lines.begin(), lines.end(),
                         [&part](const std::string& line) { return line.find(part) != line.npos; });
  };
  std::string log;
  for (const std::string& line : lines) log += line;
  EXPECT_EQ(with("robot controller 127.0.0.1:"), 1) << log;
  EXPECT_EQ(with(GetParam() ? "none a joint reply" : "no answer"), 1) << log;
  EXPECT_EQ(with("; trying again"), 1) << log;
  EXPECT_LE(with("stands still") + with("runs again"), 1) << log;  // a busy machine's own
  EXPECT_EQ(with("session "), 0) << log;
}

INSTANTIATE_TEST_SUITE_P(, SlaveAlone, ::testing::Bool(),
                         [](const auto& of) { return of.param ? "Garbage" : "Silence"; });

TEST(SlaveProgram, CheckReadsTheConfigurationAndTheScene) {
  TempFolder folder;
  Program good({kSlave, "--check"});
  EXPECT_EQ(good.line("configuration ok"), "configuration ok\n");
  EXPECT_EQ(good.line("stop circuit: "),
            "stop circuit: none (stop_switch); the controller's emergency stop must be in reach\n");
  EXPECT_EQ(good.exit_code(), 0);
  const std::string text = "force_sensor { filter_ms: 20 } payload { mass_kg: 0.5 }";
  Program filtered({kSlave, "--check", "--config", folder.write("f", text)});
  EXPECT_EQ(
      filtered.line("force sensor: "),
      "force sensor: 0.5 kg are taken out of its readings; its low pass makes the force 20 ms "
      "late, 21 ms behind the joints in all\n");
  EXPECT_EQ(filtered.exit_code(), 0);
  folder.write("late.scene", "name: 'late' bumper { sensor_lag_ms: 90 }");
  const std::string late_scene = "scene: 'late' scene_path: '" + folder.path() + "' ";
  Program edge({kSlave, "--check", "--config",
                folder.write("e", late_scene + "force_sensor { filter_ms: 10 }")});
  EXPECT_EQ(edge.exit_code(), 0);
  Program late({kSlave, "--check", "--config",
                folder.write("l", late_scene + "force_sensor { filter_ms: 20 }")});
  EXPECT_EQ(late.line("handrail-slave: "),
            "handrail-slave: force_sensor.filter_ms: 20 ms and bumper.sensor_lag_ms of scene late "
            "make 110 ms, expected at most 100 ms\n");
  EXPECT_EQ(late.exit_code(), 2);
  Program bad({kSlave, "--check", "--config", folder.write("a", "scene: \"nowhere\"\n")});
  EXPECT_NE(bad.line("handrail-slave: ").find("nowhere"), std::string::npos);
  EXPECT_EQ(bad.exit_code(), 2);
}

}  // namespace
}  // namespace handrail
