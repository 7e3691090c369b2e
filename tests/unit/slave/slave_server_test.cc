// The slave's IO thread on real sockets.
#include "server/slave/slave_server.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <atomic>
#include <csignal>
#include <optional>
#include <sstream>
#include <thread>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/link/pump.h"
#include "server/link/unix_transport.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

// Gives one record a poll.
class CountingSensor : public FtSensor {
 public:
  const FtCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return Status::ok(); }
  bool poll(Nanos, FtSample& sample) noexcept override {
    sample.sequence = ++sequence_;
    sample.wrench.force.z() = 3.0;
    sample.status = faulty ? 1 : 0;
    sample.overrange = overrange;
    return true;
  }
  void bias() noexcept override {}
  void stop() noexcept override {}
  std::atomic<bool> faulty{false}, overrange{false};

 private:
  FtCapabilities capabilities_;
  std::uint32_t sequence_ = 0;
};

class SlaveServerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    previous_ = spdlog::default_logger();
    const auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(log);
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("test", sink));
    slave_state.scene = scene_name("here");
    ASSERT_TRUE(transport.open());
    begin();
  }
  void TearDown() override {
    end();
    spdlog::set_default_logger(previous_);
  }
  void begin() {
    boxes.report.publish({slave_state});
    ASSERT_TRUE(server->open());
    done = false;
    thread = std::thread([this] {
      server->run({[this] { signalled = true; },
                   [this] {
                     rusage usage{};
                     EXPECT_EQ(getrusage(RUSAGE_THREAD, &usage), 0);
                     worked_us = usage_us(usage.ru_utime) + usage_us(usage.ru_stime);
                     slept = usage.ru_nvcsw;
                     return done.load();
                   }});
    });
  }
  void end() {
    done = true;
    if (thread.joinable()) thread.join();
  }

  static long usage_us(const timeval& time) { return time.tv_sec * 1'000'000 + time.tv_usec; }

  // Plays the master until `condition` or for ten seconds.
  template <typename Condition>
  bool play(Condition condition) {
    const Nanos give_up = monotonic_now() + 10 * kSecond;
    while (monotonic_now() < give_up) {
      if (condition()) return true;
      const Nanos now = monotonic_now();
      (void)pump.receive(now);
      pump.send(now, master_state);
      sleep_until(now + kMillisecond);
    }
    return false;
  }

  std::optional<Result<FollowSettings>> load(const std::string& name) {
    if (disk_waits) return std::nullopt;
    ++looks;
    if (name == "missing") return Status::error("no such scene");
    FollowSettings settings;
    settings.scene = scene_name(name);
    return settings;
  }

  SlaveServerOptions options() {
    return {.link =
                [this](boost::asio::io_context& io_of_server) {
                  return std::make_unique<UnixTransport>(io_of_server, UnixTransport::End::kSlave,
                                                         link_socket);
                },
            .load_scene = [this](const std::string& name) { return load(name); }};
  }
  // Lines of the log that hold `text`, once the server has ended.
  int lines_with(const std::string& text) {
    std::istringstream lines(log.str());
    int count = 0;
    for (std::string line; std::getline(lines, line);) count += line.find(text) != line.npos;
    return count;
  }

  TempFolder folder;
  const std::string link_socket = folder.path() + "/link.sock";
  std::ostringstream log;
  std::atomic<int> looks{0};
  std::atomic<bool> disk_waits{false};
  SlaveMailboxes boxes;
  CountingSensor sensor;
  SlaveState slave_state;
  std::unique_ptr<IoServer> server = make_slave_server(boxes, &sensor, options());
  boost::asio::io_context io;
  UnixTransport transport{io, UnixTransport::End::kMaster, link_socket};
  MasterPeer peer{random_session_id()};
  LinkPump<MasterState, SlaveState> pump{transport, peer};
  MasterState master_state;
  std::atomic<bool> done{false};
  std::atomic<bool> signalled{false};
  std::atomic<long> worked_us{0}, slept{0};  // of the server's thread
  std::thread thread;

 private:
  std::shared_ptr<spdlog::logger> previous_;
};

TEST_F(SlaveServerTest, CarriesStatesBothWays) {
  master_state.stop_epoch = 17;
  MasterNews news;
  EXPECT_TRUE(play([&] {
    (void)boxes.master.take(news);
    return news.state.stop_epoch == 17 && text_of(peer.newest().scene) == "here" &&
           peer.snapshot().round_trip >= 0;
  }));
  EXPECT_EQ(news.link.peer_epoch, 1u);
}

TEST_F(SlaveServerTest, RepeatsTheNewestStateWithoutBeingAskedAgain) {
  EXPECT_TRUE(play([&] { return peer.snapshot().accepted >= 50; }));
}

TEST_F(SlaveServerTest, PollsWhereItIsToldToAndRests) {
  // What the server took of a processor while 300 datagrams of it came, and how often it slept.
  const auto looked_at = [this] {
    EXPECT_TRUE(play([&] { return peer.snapshot().accepted > 0; }));
    const std::uint64_t first = peer.snapshot().accepted;
    const long worked = worked_us, sleeps = slept;
    const Nanos start = monotonic_now();
    EXPECT_TRUE(play([&] { return peer.snapshot().accepted >= first + 300; }));
    const double us = to_seconds(monotonic_now() - start) * 1e6;
    return std::pair(static_cast<double>(worked_us - worked) / us, slept - sleeps);
  };
  const double sleeping = looked_at().first;
  end();
  SlaveServerOptions busy = options();
  busy.busy_poll = true;
  server = make_slave_server(boxes, &sensor, busy);
  begin();
  EXPECT_TRUE(play([&] { return peer.snapshot().peer_epoch == 2; }));
  const auto [polling, rests] = looked_at();
  EXPECT_GT(polling, 2.0 * sleeping);
  EXPECT_LT(polling, 0.95) << "a real-time thread that takes more is stopped";
  EXPECT_GT(rests, 100) << "it rests after each tick";
}

TEST_F(SlaveServerTest, PassesOnForcesAndTheSensorsFaults) {
  ForceReading reading;
  EXPECT_TRUE(play([&] { return boxes.force.take(reading); }));
  EXPECT_TRUE(reading.healthy);
  EXPECT_DOUBLE_EQ(reading.f_E_T.force.z(), 3.0);
  sensor.faulty = true;
  EXPECT_TRUE(play([&] {
    (void)boxes.force.take(reading);
    return !reading.healthy;
  }));
  EXPECT_FALSE(reading.overrange);
  sensor.overrange = true;
  EXPECT_TRUE(play([&] {
    (void)boxes.force.take(reading);
    return reading.overrange;
  }));
}

TEST_F(SlaveServerTest, LoadsTheMastersSceneByName) {
  master_state.scene = scene_name("there");
  FollowSettings settings;
  EXPECT_TRUE(play([&] { return boxes.settings.take(settings); }));
  EXPECT_EQ(text_of(settings.scene), "there");
}

TEST_F(SlaveServerTest, ADiskThatTakesItsTimeKeepsNobodyFromTheLink) {
  disk_waits = true;
  master_state.scene = scene_name("there");
  const std::uint64_t before = peer.snapshot().accepted;
  EXPECT_TRUE(play([&] { return peer.snapshot().accepted >= before + 300; }));
  FollowSettings settings;
  EXPECT_FALSE(boxes.settings.take(settings));
  disk_waits = false;
  EXPECT_TRUE(play([&] { return boxes.settings.take(settings); }));
  EXPECT_EQ(text_of(settings.scene), "there");
}

TEST_F(SlaveServerTest, AFileThatComesWhenTheMasterHasAnotherSceneIsNotUsed) {
  disk_waits = true;
  master_state.scene = scene_name("there");
  const std::uint64_t before = peer.snapshot().accepted;
  EXPECT_TRUE(play([&] { return peer.snapshot().accepted >= before + 100; }));
  master_state.scene = scene_name("elsewhere");
  const std::uint64_t then = peer.snapshot().accepted;
  EXPECT_TRUE(play([&] { return peer.snapshot().accepted >= then + 100; }));
  disk_waits = false;
  FollowSettings settings;
  EXPECT_TRUE(play([&] { return boxes.settings.take(settings); }));
  EXPECT_EQ(text_of(settings.scene), "elsewhere");
}

TEST_F(SlaveServerTest, LoadsItsFileAgainWhenTheSameSceneDiffers) {
  master_state.scene = scene_name("here");
  master_state.hashes.limits = 1;
  FollowSettings settings;
  EXPECT_TRUE(play([&] { return boxes.settings.take(settings); }));
}

TEST_F(SlaveServerTest, KeepsItsSceneWhenTheMastersIsMissing) {
  master_state.scene = scene_name("missing");
  FollowSettings settings;
  EXPECT_TRUE(play([&] { return peer.snapshot().accepted >= 50; }));
  EXPECT_FALSE(boxes.settings.take(settings));
}

TEST_F(SlaveServerTest, KeepsItsSceneWhileTheArmFollows) {
  slave_state.state = SessionState::kEngaged;
  boxes.report.publish({slave_state});
  ASSERT_TRUE(play([&] { return peer.newest().state == SessionState::kEngaged; }));
  master_state.scene = scene_name("there");
  FollowSettings settings;
  const std::uint64_t before = peer.snapshot().accepted;
  EXPECT_TRUE(play([&] { return peer.snapshot().accepted >= before + 50; }));
  EXPECT_FALSE(boxes.settings.take(settings));
}

// Whoever asks, and however often: the thread serves the link, and the log stays readable.
TEST_F(SlaveServerTest, ScenesThatAlternateCostALookAndALineASecond) {
  const char* const names[] = {"there", "missing", "elsewhere", "missing-too"};
  std::size_t asked = 0;
  const Nanos start = monotonic_now();
  EXPECT_TRUE(play([&] {
    master_state.scene = scene_name(names[++asked % 4]);
    master_state.hashes.limits = asked % 3;
    // The robot loop takes over what it is given, as when it stands.
    FollowSettings settings;
    if (boxes.settings.take(settings)) {
      slave_state.scene = settings.scene;
      boxes.report.publish({slave_state});
    }
    return monotonic_now() - start > 3500 * kMillisecond;
  }));
  const std::uint64_t answered = peer.snapshot().accepted;
  TearDown();
  const auto seconds = static_cast<int>((monotonic_now() - start) / kSecond);
  EXPECT_GT(asked, 100u);
  EXPECT_GE(looks, 3);
  EXPECT_LE(looks, seconds + 1);
  EXPECT_LE(lines_with("scene"), looks);
  EXPECT_GT(answered, 100u) << "the link was served meanwhile";
}

TEST_F(SlaveServerTest, AMissingSceneIsLoggedOnceHoweverOftenItIsLookedFor) {
  master_state.scene = scene_name("missing");
  EXPECT_TRUE(play([&] { return looks >= 3; }));
  TearDown();
  EXPECT_EQ(lines_with("no such scene"), 1);
}

TEST_F(SlaveServerTest, FallsSilentWhenTheRobotLoopStandsStill) {
  ASSERT_TRUE(play([&] { return peer.snapshot().accepted >= 1; }));
  boxes.report.publish({slave_state, monotonic_now() - 1});
  EXPECT_TRUE(play([&] { return peer.snapshot().age(monotonic_now()) > 100 * kMillisecond; }));
  boxes.report.publish({slave_state});
  EXPECT_TRUE(play([&] { return peer.snapshot().age(monotonic_now()) < kPoorAge; }));
}

TEST_F(SlaveServerTest, ATermSignalIsPassedOnAndServingGoesOn) {
  ASSERT_TRUE(play([&] { return peer.snapshot().accepted >= 1; }));
  ASSERT_EQ(pthread_kill(thread.native_handle(), SIGTERM), 0);
  EXPECT_TRUE(play([&] { return signalled.load(); }));
  const std::uint64_t before = peer.snapshot().accepted;
  EXPECT_TRUE(play([&] { return peer.snapshot().accepted >= before + 20; }));
}

TEST_F(SlaveServerTest, ASocketThatAnotherHasIsAnError) {
  EXPECT_EQ(server->place(), link_socket);
  SlaveMailboxes others;
  const auto second = make_slave_server(others, nullptr, options());
  EXPECT_EQ(second->place(), "");
  const Status status = second->open();
  ASSERT_FALSE(status);
  EXPECT_NE(status.message().find(link_socket), std::string::npos);
}

}  // namespace
}  // namespace handrail
