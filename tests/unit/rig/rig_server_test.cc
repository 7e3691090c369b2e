#include "devices/rig/rig_server.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>
#include <vector>

#include "devices/rig/tap.h"
#include "devices/udp/udp_client.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/support/temp_folder.h"

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

// A rig whose thread stands still for a while, and a client that opens a session meanwhile.
class LateRig : public ::testing::Test {
 protected:
  LateRig() {
    EXPECT_TRUE(server.open("127.0.0.1", 0, 0));
    EXPECT_TRUE(server.open_tap(path));
    thread = std::thread([this] { server.run(); });
  }
  ~LateRig() override {
    server.stop();
    thread.join();
  }
  // When the opening packet was sent: `after` from the beginning of the stand.
  Nanos open_while_it_stands(Nanos stand, Nanos after) {
    std::atomic<bool> stands{false};
    server.post([&](Rig&) {
      stands = true;
      sleep_until(monotonic_now() + stand);
    });
    while (!stands) sleep_until(monotonic_now() + kMillisecond);
    sleep_until(monotonic_now() + after);
    UdpClient client;
    EXPECT_TRUE(client.open("127.0.0.1", server.robot_port(), 0));
    std::array<std::uint8_t, kMxtLong> buffer;
    const Nanos sent = monotonic_now();
    client.send(encode_mxt(MxtPacket(), kMxtLong, buffer));
    sleep_until(sent + stand + 200 * kMillisecond);
    return sent;
  }
  // When the session began at the controller's clock; 0: it did not.
  Nanos opened() const {
    const auto tap = read_tap(path);
    for (const TapRecord& r : tap->records) {
      if (r.has(kTapOpened)) return r.at;
    }
    return 0;
  }

  TempFolder folder;
  std::string path = folder.path() + "/rig.tap";
  RigServer server{RigOptions{}};
  std::thread thread;
};

TEST_F(LateRig, ADatagramIsOfTheCycleItCameIn) {
  const Nanos sent = open_while_it_stands(80 * kMillisecond, 15 * kMillisecond);
  ASSERT_NE(opened(), 0);
  EXPECT_GE(opened(), sent);
  EXPECT_LE(opened(), sent + kMxtPeriod + kMillisecond);
}

TEST_F(LateRig, NobodyHearsWhatCameInCyclesThatAreLeftOut) {
  (void)open_while_it_stands(300 * kMillisecond, 100 * kMillisecond);
  EXPECT_EQ(opened(), 0);
}

// Questions after a command to move do not hide when that came.
TEST_F(LateRig, TheTapTellsWhenCommandsToMoveCame) {
  UdpClient client;
  ASSERT_TRUE(client.open("127.0.0.1", server.robot_port(), 0));
  std::array<std::uint8_t, kMxtLong> buffer;
  const auto ask = [&] { client.send(encode_mxt(MxtPacket(), kMxtLong, buffer)); };
  std::atomic<bool> known{false};
  MxtPacket move;
  server.post([&](Rig& rig) {
    move.block[0].set_joints(rig.controller().arm().target());
    known = true;
  });
  while (!known) sleep_until(monotonic_now() + kMillisecond);
  move.command = MxtCommand::kMove;
  move.send_type = MxtType::kJoint;
  ask();
  std::vector<std::array<Nanos, 2>> sent;  // before, after
  for (int i = 0; i < 5; ++i) {
    sleep_until(monotonic_now() + 20 * kMillisecond);
    const Nanos before = monotonic_now();
    client.send(encode_mxt(move, kMxtLong, buffer));
    sent.push_back({before, monotonic_now()});
    for (int k = 0; k < 8; ++k) {
      sleep_until(monotonic_now() + kMillisecond);
      ask();
    }
  }
  sleep_until(monotonic_now() + 20 * kMillisecond);
  std::size_t n = 0;
  constexpr Nanos kClocks = 200 * kMicrosecond;  // the kernel's stamp is of another clock
  const auto tap = read_tap(path);
  for (const TapRecord& r : tap->records) {
    if (!r.has(kTapAccepted)) continue;
    ASSERT_LT(n, sent.size());
    const Nanos came = r.at - kMxtPeriod + r.came * kMicrosecond;
    EXPECT_GE(came, sent[n][0] - kClocks) << n;
    EXPECT_LE(came, sent[n][1] + kClocks) << n;
    ++n;
  }
  EXPECT_EQ(n, sent.size());
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
