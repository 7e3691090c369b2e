#include "devices/rig/rig_server.h"

#include <gtest/gtest.h>

#include <thread>

namespace handrail {
namespace {

TEST(RigServer, BindsAnyFreePortsAndSaysWhich) {
  RigServer server(RigOptions{});
  ASSERT_TRUE(server.open("127.0.0.1", 0, 0));
  EXPECT_NE(server.robot_port(), 0);
  EXPECT_NE(server.sensor_port(), 0);
  EXPECT_NE(server.robot_port(), server.sensor_port());
}

TEST(RigServer, NamesAPortInUse) {
  RigServer first(RigOptions{});
  ASSERT_TRUE(first.open("127.0.0.1", 0, 0));
  const auto expect_refused = [](const Status& status, const std::string& what) {
    ASSERT_FALSE(status);
    EXPECT_EQ(status.message().find(what), 0u) << status.message();
    EXPECT_NE(status.message().find("in use"), std::string::npos) << status.message();
  };
  RigServer second(RigOptions{});
  const std::string robot = std::to_string(first.robot_port());
  expect_refused(second.open("127.0.0.1", first.robot_port(), 0), "robot port 127.0.0.1:" + robot);
  RigServer third(RigOptions{});
  const std::string sensor = std::to_string(first.sensor_port());
  expect_refused(third.open("127.0.0.1", 0, first.sensor_port()),
                 "sensor port 127.0.0.1:" + sensor);
}

TEST(RigServer, NamesAnAddressThatIsNone) {
  RigServer server(RigOptions{});
  const Status opened = server.open("localhost", 0, 0);
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.message().find("'localhost'"), std::string::npos) << opened.message();
}

TEST(RigServer, RunsUntilItIsStopped) {
  RigServer server(RigOptions{});
  ASSERT_TRUE(server.open("127.0.0.1", 0, 0));
  bool ran = false;
  server.post([&](Rig& rig) {
    ran = rig.controller().alarm().kind == AlarmKind::kNone;
    server.stop();
  });
  std::thread thread([&] { server.run(); });
  thread.join();
  EXPECT_TRUE(ran);
}

}  // namespace
}  // namespace handrail
