// `handrail stage` from the command line to the hand: socket, desk, haptic loop and a painted door.
#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <future>
#include <sstream>
#include <thread>

#include "client/cli/command.h"
#include "server/base/units.h"
#include "server/master/haptic_loop.h"
#include "server/master/haptic_settings.h"
#include "server/master/operator_server.h"
#include "server/master/order_desk.h"
#include "server/master/wall_runs.h"
#include "server/scene/scene_io.h"
#include "tests/support/png_sample.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/master/scripted_device.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

// 24 x 20 mm: two rooms of paper in a frame of ink, a door of 4 mm between them at X = 0 to 4 mm.
test::PngSample door_map() {
  test::PngSample png;
  png.width = 120;
  png.height = 100;
  png.pixel = [](int x, int y) {
    if (std::min({x, y, 119 - x, 99 - y}) < 5) return test::Pixel{32, 48, 64, 255};
    return x >= 60 && x < 80 ? test::Pixel{160, 80, 0, 255} : test::Pixel{240, 224, 192, 255};
  };
  return png;
}
constexpr char kScene[] =
    "name: 'door'\n"
    "walls {\n"
    "  image { file: 'door.png' size_mm: [24, 20] edges: SRGB }\n"
    "  region { name: 'paper' kind: FREE colour: '#f0e0c0' }\n"
    "  region { name: 'ink' kind: WALL colour: '#203040' }\n"
    "  region { name: 'leaf' kind: WALL colour: '#a05000' stiffness_n_mm: 5 }\n"
    "  start_mm: [-4, 0]\n"
    "  stage { name: 'shut' }\n"
    "  stage { name: 'open' without: 'leaf' }\n"
    "  stage { name: 'aside' at_mm: [-2, 0] turn_deg: 20 }\n"
    "}\n"
    "effect { wall {} }\n";

HapticCapabilities stick() {
  HapticCapabilities c;
  c.max_force = 25.3;
  c.continuous_force = 8.5;
  return c;
}

// A master without sleep: its two threads' work by turns in one, each turn a millisecond.
class StageOrder : public ::testing::Test {
 protected:
  StageOrder() {
    const Result<Scene> scene = load();
    EXPECT_TRUE(scene.is_ok()) << scene.message();
    OrderDeskOptions options;
    options.load_scene = [](const std::string&) { return Status::error("none"); };
    options.loop_scene = [this](const Scene& s) { return loop_scene(s); };
    desk_.emplace(boxes_, *scene, options);
    loop_.emplace(device_, loop_scene(*scene), boxes_, now_);
    device_.sample.X_MH.p = Vec3(-4e-3, 0.0, 0.0);
    server_.emplace(io_, *desk_);
    EXPECT_TRUE(server_->start(path_).is_ok());
    thread_ = std::thread([this] {
      while (!end_) turn();
    });
    ticks(2);
  }
  ~StageOrder() override {
    end_ = true;
    thread_.join();
    server_->stop();
  }

  // The hand goes straight there at 0.1 m/s, then rests.
  void move_to(double x_mm) {
    run([this, x_mm] { goal_ = x_mm * kMm; });
    while (moving_) std::this_thread::yield();
    ticks(50);
  }
  void ticks(std::uint64_t n) {
    const std::uint64_t until = ticks_ + n;
    while (ticks_ < until) std::this_thread::yield();
  }
  double force_x() {
    double out = 0.0;
    run([&] { out = device_.written.force.x(); });
    return out;
  }
  // Largest change of the force from one millisecond to the next since last asked.
  double largest_step() {
    double out = 0.0;
    run([&] { out = std::exchange(largest_step_, 0.0); });
    return out;
  }
  ExitCode cli(std::vector<std::string> args) {
    args.insert(args.end(), {"--socket", path_});
    out_.str("");
    err_.str("");
    return run_cli(args, Console{out_, err_});
  }

  std::ostringstream out_, err_;

 private:
  Result<Scene> load() {
    folder_.write("door.png", test::png_of(door_map()));
    return load_scene_file(folder_.write("door.scene", kScene));
  }
  LoopScene loop_scene(const Scene& scene) {
    return {haptic_settings(scene, stick()), runs_.make(scene, stick())};
  }
  void turn() {
    now_ += kMillisecond;
    double& x = device_.sample.X_MH.p.x();
    x += std::clamp(goal_ - x, -1e-4, 1e-4);
    const Vec3 before = device_.written.force;
    loop_->tick(now_);
    largest_step_ = std::max(largest_step_, (device_.written.force - before).norm());
    news_.take(boxes_);
    desk_->tick(now_, news_, SlaveState(), LinkSnapshot());
    io_.restart();
    io_.poll();
    moving_ = x != goal_;
    ++ticks_;
    std::this_thread::yield();
  }
  // In the master's thread.
  template <typename F>
  void run(F f) {
    std::promise<void> done;
    boost::asio::post(io_, [&] {
      f();
      moving_ = true;  // until the next turn has looked
      done.set_value();
    });
    done.get_future().wait();
  }

  TempFolder folder_;
  const std::string path_ = folder_.path() + "/operator.sock";
  boost::asio::io_context io_;
  MasterMailboxes boxes_;
  ScriptedDevice device_;
  WallRuns runs_;
  Nanos now_ = 1000 * kSecond;
  LoopNews news_;
  std::optional<OrderDesk> desk_;
  std::optional<HapticLoop> loop_;
  std::optional<OperatorServer> server_;
  double goal_ = -4e-3;  // of the hand along X, frame M [m]
  double largest_step_ = 0.0;
  std::atomic<bool> end_{false}, moving_{false};
  std::atomic<std::uint64_t> ticks_{0};
  std::thread thread_;
};

// What no motion explains may change the force by 1.5 % of the device's peak a millisecond.
constexpr double kStep = 0.015 * 25.3 + 1e-9;

TEST_F(StageOrder, TheWallGoesAndComesBackWithoutAStepOfTheForce) {
  move_to(1.0);
  EXPECT_NEAR(force_x(), -5.0, 0.1);
  (void)largest_step();
  ASSERT_EQ(cli({"stage", "open"}), kExitDone) << err_.str();
  EXPECT_EQ(out_.str(), "stage open\n");
  ticks(100);
  EXPECT_EQ(force_x(), 0.0);
  const double leaving = largest_step();
  EXPECT_GT(leaving, 0.0);
  EXPECT_LE(leaving, kStep);
  // It comes back around the hand, which it puts to its nearer side.
  ASSERT_EQ(cli({"stage", "shut"}), kExitDone) << err_.str();
  ticks(100);
  EXPECT_NEAR(force_x(), -5.0, 0.1);
  EXPECT_LE(largest_step(), kStep);
}

TEST_F(StageOrder, AnOpenDoorLetsTheHandThroughAndASecondOrderChangesNothing) {
  ASSERT_EQ(cli({"stage", "open"}), kExitDone);
  move_to(7.0);
  ASSERT_EQ(cli({"stage", "shut"}), kExitDone);
  ticks(20);
  EXPECT_EQ(force_x(), 0.0) << "on the other side now";
  move_to(3.0);
  EXPECT_NEAR(force_x(), 5.0, 0.1);
  (void)largest_step();
  ASSERT_EQ(cli({"stage", "shut"}), kExitDone);
  ticks(20);
  EXPECT_LT(largest_step(), 1e-6);
}

TEST_F(StageOrder, WallsThatMoveAndTurnAreFeltWithoutAStepOfTheForce) {
  move_to(-1.0);
  ASSERT_EQ(force_x(), 0.0);
  (void)largest_step();
  ASSERT_EQ(cli({"stage", "aside"}), kExitDone) << err_.str();
  ticks(200);
  // The door's left side now runs through -2, 0 mm, turned by 20 deg: 0.94 mm from the hand.
  EXPECT_NEAR(force_x(), -5.0 * std::cos(20.0 * kDeg) * std::cos(20.0 * kDeg), 0.1);
  EXPECT_LE(largest_step(), kStep);
}

TEST_F(StageOrder, StatusNamesTheStage) {
  ASSERT_EQ(cli({"status"}), kExitDone);
  EXPECT_THAT(out_.str(), HasSubstr("walls      stage 0 'shut'  free at 'paper'\n"));
  ASSERT_EQ(cli({"stage", "open"}), kExitDone);
  ASSERT_EQ(cli({"status"}), kExitDone);
  EXPECT_THAT(out_.str(), HasSubstr("walls      stage 1 'open'  free at 'paper'\n"));
  ASSERT_EQ(cli({"status", "--json"}), kExitDone);
  EXPECT_THAT(out_.str(), HasSubstr("\"stage_name\": \"open\""));
}

TEST_F(StageOrder, WhyGivesTheForceOfTheWallThatIsPressed) {
  EXPECT_EQ(cli({"why", "--json"}), kExitDone);
  pb::Ledger why;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(out_.str(), &why).ok()) << out_.str();
  EXPECT_EQ(why.walls().magnitude_n(), 0.0);
  move_to(0.5);  // the door begins at 0
  EXPECT_EQ(cli({"why", "--json"}), kExitDone);
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(out_.str(), &why).ok()) << out_.str();
  EXPECT_NEAR(why.walls().magnitude_n(), 2.5, 0.3) << "half a millimetre, 5 N/mm";
  ASSERT_EQ(why.walls().force_n_size(), 3);
  EXPECT_NEAR(why.walls().force_n(0), -why.walls().magnitude_n(), 1e-6);
  // All but the last add up to it.
  double sum = 0.0;
  for (const pb::ForceShare* share : {&why.tool(), &why.walls(), &why.spring(), &why.governor(),
                                      &why.limits(), &why.clamp(), &why.cue()}) {
    sum += share->force_n(0);
  }
  EXPECT_NEAR(sum, why.device().force_n(0), 1e-9);
  EXPECT_NEAR(why.device().force_n(0), force_x(), 0.01);
}

TEST_F(StageOrder, AnUnknownStageIsRefusedWithThoseThereAre) {
  EXPECT_EQ(cli({"stage", "ajar"}), kExitRefused);
  EXPECT_EQ(err_.str(),
            "handrail: refused: scene 'door' has no stage 'ajar', expected one of 'shut', 'open', "
            "'aside'\n");
  EXPECT_EQ(cli({"stage", ""}), kExitRefused);
  // As long as a request may be: the answer is not longer.
  EXPECT_EQ(cli({"stage", std::string(65'000, 'x')}), kExitRefused) << err_.str();
  EXPECT_LT(err_.str().size(), 200u);
  ASSERT_EQ(cli({"status"}), kExitDone);
  EXPECT_THAT(out_.str(), HasSubstr("stage 0 'shut'"));
}

}  // namespace
}  // namespace handrail
