// The gateway and a rig: what is told, and which workpiece is played.
#include "client/console/rig_link.h"

#include <gtest/gtest.h>

#include <memory>

#include "devices/rig/rig_server.h"
#include "devices/rig/rig_status_server.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

// A rig that serves its status socket, somewhere in time.
struct RunningRig {
  RigFeed feed{false};
  RigServer rig{RigOptions{}};
  RigStatusServer status{feed, "", workpiece_finder({})};
  std::thread thread;

  explicit RunningRig(const std::string& path) {
    EXPECT_TRUE(rig.open("127.0.0.1", 0, 0));
    rig.tell(feed);
    EXPECT_TRUE(status.start(path));
    thread = std::thread([this] { rig.run(); });
  }
  ~RunningRig() {
    rig.stop();
    thread.join();
  }
};

class RigLinkTest : public ::testing::Test {
 protected:
  template <typename Condition>
  bool eventually(Condition condition) {
    for (const Nanos give_up = monotonic_now() + 10 * kSecond; monotonic_now() < give_up;) {
      {
        const std::lock_guard<std::mutex> lock(mutex);
        if (condition(news)) return true;
      }
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    ADD_FAILURE() << news.DebugString();
    return false;
  }

  TempFolder folder;
  std::string path = folder.path() + "/rig.sock";
  std::mutex mutex;
  pb::RigNews news;
  RigLink link{path, [](const std::function<void()>& work) { work(); },
               [this](const pb::RigNews& now) {
                 const std::lock_guard<std::mutex> lock(mutex);
                 news = now;
               }};
};

TEST_F(RigLinkTest, TheRigPlaysTheMastersSceneAndSaysWhatItCannot) {
  EXPECT_TRUE(eventually(
      [](const auto& n) { return n.problem().find("no simulated rig on") != std::string::npos; }));
  auto rig = std::make_unique<RunningRig>(path);
  EXPECT_TRUE(eventually([](const auto& n) { return n.has_moment() && !n.has_scene(); }));
  link.follow("screw-fastening");
  EXPECT_TRUE(eventually([](const auto& n) {
    return n.scene() == "screw-fastening" && n.moment().has_screw() && !n.has_problem();
  }));
  link.follow("nothing");
  EXPECT_TRUE(eventually([](const auto& n) {
    return n.problem().find("play: scene 'nothing'") != std::string::npos && n.has_moment();
  }));
  link.follow("linear-movement");
  EXPECT_TRUE(eventually([](const auto& n) {
    return n.scene() == "linear-movement" && !n.moment().has_screw() && !n.has_problem();
  }));
  rig.reset();
  EXPECT_TRUE(eventually([](const auto& n) { return n.has_problem() && !n.has_moment(); }));
}

}  // namespace
}  // namespace handrail
