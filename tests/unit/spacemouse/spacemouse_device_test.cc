#include "devices/spacemouse/spacemouse_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <thread>

#include "tests/support/no_allocation.h"
#include "tests/support/spnav_server.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using test::spnav_button;
using test::spnav_device;
using test::spnav_motion;
using test::SpnavServer;
using ::testing::HasSubstr;

std::ptrdiff_t open_descriptors() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return std::distance(begin(all), end(all));
}

class SpaceMouse : public ::testing::Test {
 protected:
  SpaceMouse() { options.socket = server.path(); }

  void open(SpaceMouseDevice& device) {
    ASSERT_TRUE(server.works());
    const Status status = device.open();
    ASSERT_TRUE(status.is_ok()) << status.message();
    ASSERT_EQ(server.accept(), 0x7faa5501u) << "asks for protocol 1";
    server.answer(0x7faa5501);
  }
  HapticSample tick(SpaceMouseDevice& device, int milliseconds = 1) {
    HapticSample out;
    for (int i = 0; i < milliseconds; ++i) out = device.read(now += kMillisecond);
    return out;
  }
  // Until readings are as wanted, for at most ten seconds.
  bool becomes(SpaceMouseDevice& device, bool valid) {
    for (int i = 0; i < 10'000; ++i) {
      if (tick(device).valid == valid) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  TempFolder folder;
  SpnavServer server{folder.path() + "/spnav.sock"};
  SpaceMouseOptions options;
  Nanos now = 50 * kSecond;
};

TEST_F(SpaceMouse, ThePushIsAVelocityInTheAxesOfM) {
  SpaceMouseDevice device(options);
  open(device);
  EXPECT_TRUE(tick(device).valid);
  // Right 350, up 175, away from the user 350 of 350.
  server.send(spnav_motion({350, 175, 350, 0, 0, 0}));
  const HapticSample moved = tick(device, 180);
  EXPECT_LT((moved.v_MH - Vec3(0.05, 0.025, -0.05)).norm(), 2e-5) << moved.v_MH.transpose();
  EXPECT_GT(moved.X_MH.p.x(), 0.006);
}

TEST_F(SpaceMouse, TurnsAreAboutTheSameAxes) {
  for (int axis = 0; axis < 3; ++axis) {
    SpaceMouseDevice device(options);
    open(device);
    tick(device);
    std::array<std::int32_t, 6> counts{};
    counts[static_cast<std::size_t>(3 + axis)] = 350;
    server.send(spnav_motion(counts));
    const Vec3 turned = rotation_log(tick(device, 180).X_MH.q);
    const Vec3 wanted = Vec3::Unit(axis) * (axis == 2 ? -1.0 : 1.0);
    EXPECT_GT(turned.dot(wanted), 0.06) << axis;
    EXPECT_NEAR(turned.norm(), turned.dot(wanted), 1e-9) << axis;
  }
}

TEST_F(SpaceMouse, AMotionThatIsNotRenewedEnds) {
  options.patience = 150 * kMillisecond;
  SpaceMouseDevice device(options);
  open(device);
  tick(device);
  server.send(spnav_motion({350, 0, 0, 0, 0, 0}));
  EXPECT_GT(tick(device, 140).v_MH.x(), 0.049);
  EXPECT_LT(tick(device, 260).v_MH.x(), 1e-4);
  const Vec3 place = tick(device).X_MH.p;
  EXPECT_NEAR(place.x(), 0.05 * 0.15, 2e-4);
  EXPECT_LT((tick(device, 1000).X_MH.p - place).norm(), 1e-6);
}

TEST_F(SpaceMouse, ButtonsAreThoseThatAreConfigured) {
  options.clutch_button = 3;
  options.drop_button = 0;
  options.enable_button = 9;
  SpaceMouseDevice device(options);
  EXPECT_EQ(device.capabilities().buttons, 3);
  open(device);
  tick(device);
  const auto shown = [&](int number) {
    server.send(spnav_button(number, true));
    const std::uint32_t down = tick(device).buttons;
    server.send(spnav_button(number, false));
    EXPECT_EQ(tick(device).buttons, 0u);
    return down;
  };
  EXPECT_EQ(shown(3), 1u);
  EXPECT_EQ(shown(0), 2u);
  EXPECT_EQ(shown(9), 4u);
  EXPECT_EQ(shown(1), 0u);
}

TEST_F(SpaceMouse, WithoutADeadManItHasTwoButtons) {
  const SpaceMouseDevice device(options);
  EXPECT_EQ(device.capabilities().buttons, 2);
  EXPECT_EQ(device.capabilities().max_force, 0.0);
}

TEST_F(SpaceMouse, TheClutchButtonGivesBackTheWorkSpace) {
  SpaceMouseDevice device(options);
  open(device);
  tick(device);
  for (int i = 0; i < 10; ++i) {
    server.send(spnav_motion({350, 0, 0, 0, 0, 0}));
    tick(device, 100);
  }
  ASSERT_GT(tick(device).X_MH.p.x(), 0.045);
  server.send(spnav_button(0, true));
  EXPECT_LT(tick(device, 1500).X_MH.p.norm(), 1e-4);
}

TEST_F(SpaceMouse, ADeviceThatIsUnpluggedIsNoReadingUntilItIsBack) {
  SpaceMouseDevice device(options);
  open(device);
  tick(device);
  server.send(spnav_motion({350, 0, 0, 0, 0, 0}));
  const HapticSample before = tick(device, 100);
  server.send(spnav_device(false));
  EXPECT_FALSE(tick(device).valid);
  EXPECT_EQ(text_of(device.trouble()), "it is unplugged, as spacenavd says");
  EXPECT_EQ(tick(device, 100).buttons, 0u);
  server.send(spnav_device(true));
  const HapticSample after = tick(device);
  EXPECT_TRUE(after.valid);
  EXPECT_EQ(after.X_MH.p, before.X_MH.p) << "where it was";
  EXPECT_EQ(after.v_MH.norm(), 0.0) << "and at rest";
}

TEST_F(SpaceMouse, AHundredTimesTheCapIsPulledOutAndPluggedIn) {
  SpaceMouseDevice device(options);
  open(device);
  tick(device);
  for (int i = 0; i < 100; ++i) {
    server.send(spnav_motion({i % 2 == 0 ? 350 : -350, 0, 0, 0, 0, 0}));
    server.send(spnav_button(1, true));
    const HapticSample before = tick(device, 100);
    ASSERT_GT(std::abs(before.v_MH.x()), 0.04) << i;
    server.send(spnav_device(false));
    ASSERT_FALSE(tick(device).valid) << i;
    ASSERT_EQ(tick(device, 20).buttons, 0u) << i;
    server.send(spnav_device(true));
    const HapticSample after = tick(device, 20);
    ASSERT_TRUE(after.valid) << i;
    ASSERT_EQ(after.X_MH.p, before.X_MH.p) << i;
    ASSERT_EQ(after.v_MH.norm(), 0.0) << i;
  }
}

TEST_F(SpaceMouse, AHundredTimesTheDaemonEndsAndIsThereAgain) {
  options.reopen_pause = kMillisecond;
  SpaceMouseDevice device(options);
  open(device);
  tick(device);
  for (int i = 0; i < 100; ++i) {
    server.send(spnav_motion({350, 0, 0, 0, 0, 0}));
    ASSERT_GT(tick(device, 100).v_MH.x(), 0.04) << i;
    const Vec3 place = device.read(now).X_MH.p;
    server.end();
    ASSERT_TRUE(becomes(device, false)) << i;
    ASSERT_EQ(tick(device).buttons, 0u) << i;
    server.listen();
    ASSERT_TRUE(server.works()) << i;
    ASSERT_EQ(server.accept(), 0x7faa5501u) << i;
    ASSERT_TRUE(becomes(device, true)) << i;
    ASSERT_EQ(device.read(now).X_MH.p, place) << i;
    ASSERT_EQ(device.read(now).v_MH.norm(), 0.0) << i;
    // It comes back to the middle, for the next round.
    server.send(spnav_button(0, true));
    tick(device, 1500);
    server.send(spnav_button(0, false));
  }
}

TEST_F(SpaceMouse, WhatIsNotSpacenavdIsLeftAndCalledAgain) {
  SpaceMouseDevice device(options);
  open(device);
  tick(device);
  server.send(test::SpnavWords{99, 1, 2, 3});
  ASSERT_TRUE(becomes(device, false));
  ASSERT_EQ(server.accept(), 0x7faa5501u);
  EXPECT_TRUE(becomes(device, true));
}

TEST_F(SpaceMouse, ItReadsWithoutAllocatingAndGivesBackItsDescriptors) {
  SpaceMouseDevice device(options);
  open(device);
  for (int i = 0; i < 120; ++i) server.send(spnav_motion({i, 0, 0, 0, 0, 0}));
  {
    test::NoAllocation guard("SpaceMouse");
    tick(device, 100);
    server.end();
    tick(device, 10);
  }
  device.close();
  server.drop();
  const std::ptrdiff_t before = open_descriptors();
  server.listen();
  for (int i = 0; i < 20; ++i) {
    open(device);
    EXPECT_TRUE(tick(device).valid);
  }
  device.close();
  device.close();
  EXPECT_FALSE(device.read(now).valid);
  server.end();
  EXPECT_EQ(open_descriptors(), before);
}

TEST_F(SpaceMouse, WithoutADaemonItSaysWhereItLookedAndWhatToDo) {
  server.end();
  SpaceMouseDevice device(options);
  const Status status = device.open();
  EXPECT_THAT(status.message(), HasSubstr(options.socket));
  EXPECT_THAT(status.message(), HasSubstr("No such file"));
  EXPECT_THAT(status.message(), HasSubstr("apt-get install spacenavd"));
  EXPECT_FALSE(device.read(now).valid);
}

TEST_F(SpaceMouse, ASocketPathMustFit) {
  const Result<SpnavConnection> at = connect_spnav(std::string(200, 'x'));
  EXPECT_THAT(at.message(), HasSubstr("200 bytes, expected the path of a Unix socket, 1 to 107"));
  EXPECT_THAT(connect_spnav("").message(), HasSubstr("0 bytes"));
}

TEST_F(SpaceMouse, TheSocketIsTheConfiguredOrThatOfTheEnvironmentOrTheUsual) {
  ::setenv("SPNAV_SOCKET", "/tmp/elsewhere", 1);
  EXPECT_EQ(spnav_socket_path("/tmp/mine"), "/tmp/mine");
  EXPECT_EQ(spnav_socket_path(""), "/tmp/elsewhere");
  ::unsetenv("SPNAV_SOCKET");
  EXPECT_EQ(spnav_socket_path(""), "/var/run/spnav.sock");
}

}  // namespace
}  // namespace handrail
