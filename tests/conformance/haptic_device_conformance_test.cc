// What every haptic device of the registry promises (devices/haptic_device.h).
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "devices/registry.h"
#include "server/base/random.h"
#include "tests/support/fake_force_stick.h"
#include "tests/support/no_allocation.h"
#include "tests/support/spnav_server.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

class HapticDeviceConformance : public ::testing::TestWithParam<HapticDeviceKind> {
 protected:
  std::unique_ptr<HapticDevice> make() {
    HapticDeviceOptions options;
    options.kind = GetParam();
    options.hand.seed = 42;
    if (options.kind == HapticDeviceKind::kRecorded) options.recording_path = path();
    if (options.kind == HapticDeviceKind::kSpaceMouse) {
      // Each has a daemon of its own, whose cap nobody touches.
      const std::string socket = folder.path() + "/" + std::to_string(spnavs.size());
      spnavs.push_back(std::make_unique<test::SpnavServer>(socket));
      options.spacemouse.socket = socket;
    }
    if (options.kind == HapticDeviceKind::kGamepad) {
      pads.push_back(std::make_unique<test::FakeGamepad>());
      pads.back()->make_pad();
      options.gamepad.path = "/dev/input/event5";
      options.evdev = pads.back().get();
    }
    if (options.kind == HapticDeviceKind::kForceStick) {
      auto stick = std::make_unique<test::FakeForceStick>();
      options.force_stick.path = "/dev/input/event5";
      options.force_stick.full = {4.0, 4.0};
      options.force_stick.mass = 0.3;
      options.force_stick.damping = 3.0;
      options.evdev = stick.get();
      pads.push_back(std::move(stick));
    }
    std::ofstream(path()) << "t_s,x_mm,y_mm,z_mm\n0,0,0,0\n0.1,5,1,0\n0.9,20,-9,4\n1.0,21,-9,4\n";
    auto device = make_haptic_device(options);
    std::remove(path().c_str());
    EXPECT_TRUE(device.is_ok()) << device.message();
    return std::move(*device);
  }
  // Somebody moves the newest device, if it does not move by itself.
  void push() {
    if (!pads.empty()) return pads.back()->axis(ABS_X, 9000);
    if (spnavs.empty()) return;
    ASSERT_NE(spnavs.back()->accept(), 0u);
    spnavs.back()->send(test::spnav_motion({100, 0, 0, 0, 0, 0}));
  }
  static std::string path() {
    return ::testing::TempDir() + "conformance_hand_" +
           std::to_string(static_cast<int>(GetParam())) + ".csv";
  }

  TempFolder folder;
  std::vector<std::unique_ptr<test::SpnavServer>> spnavs;
  std::vector<std::unique_ptr<test::FakeGamepad>> pads;
};

void expect_sound(const HapticSample& sample) {
  ASSERT_TRUE(sample.valid);
  ASSERT_TRUE(is_finite(sample.X_MH));
  ASSERT_TRUE(is_finite(sample.v_MH));
  ASSERT_TRUE(is_unit(sample.X_MH.q));
}

bool same_bits(const HapticSample& a, const HapticSample& b) {
  return a.X_MH.p == b.X_MH.p && a.X_MH.q.coeffs() == b.X_MH.q.coeffs() && a.v_MH == b.v_MH &&
         a.buttons == b.buttons && a.valid == b.valid;
}

// Ordinary, saturating and senseless wrenches in turn.
Wrench any_wrench(Random& random, int i) {
  Wrench w{4.0 * Vec3(random.normal(), random.normal(), random.normal()),
           0.2 * Vec3(random.normal(), random.normal(), random.normal())};
  if (i % 11 == 3) w.force *= 1e3;
  if (i % 13 == 5) w.force.y() = 1e308;
  if (i % 17 == 7) w.force.x() = kNan;
  if (i % 19 == 9) w.torque.z() = -kInf;
  return w;
}

TEST_P(HapticDeviceConformance, CapabilitiesArePositive) {
  const auto device = make();
  const HapticCapabilities& c = device->capabilities();
  EXPECT_FALSE(c.name.empty());
  EXPECT_GE(c.continuous_force, 0.0);
  EXPECT_GE(c.max_force, c.continuous_force);
  EXPECT_EQ(c.max_torque > 0.0, c.actuates_torque);
  EXPECT_STRNE(c.dynamics.source, "");
  const bool makes_none =
      GetParam() == HapticDeviceKind::kSpaceMouse || GetParam() == HapticDeviceKind::kGamepad;
  EXPECT_EQ(c.max_force == 0.0, makes_none);
  if (!makes_none) {
    EXPECT_GT(c.continuous_force, 0.0);
    EXPECT_GT(c.dynamics.mass, 0.0);
    EXPECT_GT(c.dynamics.damping + c.dynamics.friction, 0.0);
    EXPECT_GT(c.dynamics.resolution, 0.0);
  }
  EXPECT_GT(c.workspace_half.minCoeff(), 0.0);
  EXPECT_GT(c.buttons, 0);
}

TEST_P(HapticDeviceConformance, FirstReadingIsValidBeforeAnyWrite) {
  const auto device = make();
  EXPECT_FALSE(device->read(0).valid) << "before it was opened";
  ASSERT_TRUE(device->open().is_ok());
  expect_sound(device->read(123 * kSecond));
}

TEST_P(HapticDeviceConformance, TimeStandingStillGivesTheSameSample) {
  const auto device = make();
  ASSERT_TRUE(device->open().is_ok());
  device->read(0);
  device->write({Vec3(1.0, 0.0, 0.0), Vec3::Zero()});
  const HapticSample first = device->read(50 * kMillisecond);
  device->write({Vec3(-1.0, 2.0, 0.0), Vec3::Zero()});
  EXPECT_TRUE(same_bits(device->read(50 * kMillisecond), first));
  ASSERT_NO_FATAL_FAILURE(push());
  device->read(51 * kMillisecond);
  EXPECT_FALSE(same_bits(device->read(90 * kMillisecond), first));
}

TEST_P(HapticDeviceConformance, StaysFiniteUnderAnyWrenchForAMinute) {
  const auto device = make();
  ASSERT_TRUE(device->open().is_ok());
  Random random(7);
  Nanos now = 0;
  for (int i = 0; i < 60'000; ++i) {
    const HapticSample sample = device->read(now);
    ASSERT_NO_FATAL_FAILURE(expect_sound(sample)) << i;
    ASSERT_LT(sample.X_MH.p.norm(), 0.3) << i;
    ASSERT_LT(sample.v_MH.norm(), 3.0) << i;
    device->write(any_wrench(random, i));
    // Ticks of uneven length, with a stall now and then.
    now += kMillisecond / 2 + static_cast<Nanos>(random.uniform() * 1e6);
    if (i % 5000 == 4999) now += 300 * kMillisecond;
  }
}

TEST_P(HapticDeviceConformance, AWrenchThatIsNotFiniteCountsAsNone) {
  const auto bad = make();
  const auto none = make();
  ASSERT_TRUE(bad->open().is_ok());
  ASSERT_TRUE(none->open().is_ok());
  for (Nanos now = 0; now < kSecond; now += kMillisecond) {
    ASSERT_TRUE(same_bits(bad->read(now), none->read(now)));
    bad->write({Vec3(2.0, kNan, 0.0), Vec3::Zero()});
    none->write(Wrench{});
  }
}

TEST_P(HapticDeviceConformance, SameSeedAndCallsGiveTheSameBits) {
  const auto a = make();
  const auto b = make();
  ASSERT_TRUE(a->open().is_ok());
  ASSERT_TRUE(b->open().is_ok());
  Random random(3);
  for (int i = 0; i < 5000; ++i) {
    if (i % 900 == 0 && a->hand() != nullptr) {
      HandIntent intent;
      intent.displacement_M = 0.02 * Vec3(random.normal(), random.normal(), 0.0);
      a->hand()->steer(intent);
      b->hand()->steer(intent);
    }
    ASSERT_TRUE(same_bits(a->read(i * kMillisecond), b->read(i * kMillisecond))) << i;
    const Wrench wrench = any_wrench(random, i);
    a->write(wrench);
    b->write(wrench);
  }
}

TEST_P(HapticDeviceConformance, CloseTakesTheForceAwayAndMayBeCalledTwice) {
  const auto device = make();
  const auto never_pushed = make();
  Nanos now = 0;
  for (const auto& d : {device.get(), never_pushed.get()}) {
    ASSERT_TRUE(d->open().is_ok());
    d->read(now);
  }
  device->write({Vec3(0.0, 3.3, 0.0), Vec3::Zero()});
  device->close();
  device->close();
  device->write({Vec3(0.0, 3.3, 0.0), Vec3::Zero()});
  EXPECT_FALSE(device->read(now).valid);
  never_pushed->close();
  for (const auto& d : {device.get(), never_pushed.get()}) {
    ASSERT_TRUE(d->open().is_ok());
    d->read(now);
  }
  for (int i = 0; i < 500; ++i) {
    now += kMillisecond;
    ASSERT_TRUE(same_bits(device->read(now), never_pushed->read(now))) << i;
  }
}

// A loop that stands still for half a second leaves the hand as one that lets go after 50 ms.
TEST_P(HapticDeviceConformance, AForceThatIsNotRenewedActsForFiftyMilliseconds) {
  const Wrench push{Vec3(1.5, 0.0, 0.0), Vec3(0.0, 0.02, 0.0)};
  const auto stalled = make();
  const auto lets_go = make();
  for (const auto& d : {stalled.get(), lets_go.get()}) {
    ASSERT_TRUE(d->open().is_ok());
    d->read(0);
    d->write(push);
  }
  for (Nanos now = 1; now <= 500; ++now) {
    lets_go->read(now * kMillisecond);
    lets_go->write(now < 50 ? push : Wrench{});
  }
  EXPECT_TRUE(same_bits(stalled->read(500 * kMillisecond), lets_go->read(500 * kMillisecond)));
  for (Nanos now = 501; now <= 1000; ++now) {
    ASSERT_TRUE(same_bits(stalled->read(now * kMillisecond), lets_go->read(now * kMillisecond)));
  }
}

TEST_P(HapticDeviceConformance, ReadingWritingAndSteeringDoNotAllocate) {
  const auto device = make();
  ASSERT_TRUE(device->open().is_ok());
  HandIntent intent;
  intent.displacement_M = Vec3(0.01, 0.0, 0.0);
  test::NoAllocation guard("haptic device");
  for (Nanos now = 0; now < kSecond; now += kMillisecond) {
    if (now % (300 * kMillisecond) == 0 && device->hand() != nullptr) device->hand()->steer(intent);
    device->read(now);
    device->write({Vec3(1.0, 0.0, 0.0), Vec3::Zero()});
  }
  device->close();
}

TEST_P(HapticDeviceConformance, AHandThatIsSteeredArrives) {
  const auto device = make();
  if (device->hand() == nullptr) return;  // nobody holds a recording
  ASSERT_TRUE(device->open().is_ok());
  device->read(0);
  HandIntent intent;
  intent.displacement_M = Vec3(0.03, 0.0, 0.0);
  device->hand()->steer(intent);
  Nanos now = 0;
  while (device->hand()->moving() && now < 10 * kSecond) device->read(now += kMillisecond);
  EXPECT_LT(now, 2 * kSecond);
  EXPECT_NEAR(device->read(now).X_MH.p.x(), 0.03, 0.004);
}

std::string name_of(const ::testing::TestParamInfo<HapticDeviceKind>& info) {
  switch (info.param) {
    case HapticDeviceKind::kSimOmni: return "SimOmni";
    case HapticDeviceKind::kSimOmniTorque: return "SimOmniTorque";
    case HapticDeviceKind::kRecorded: return "Recorded";
    case HapticDeviceKind::kSimJoystick: return "SimJoystick";
    case HapticDeviceKind::kPage: return "Page";
    case HapticDeviceKind::kSpaceMouse: return "SpaceMouse";
    case HapticDeviceKind::kGamepad: return "Gamepad";
    case HapticDeviceKind::kForceStick: return "ForceStick";
    case HapticDeviceKind::kTouch:
    case HapticDeviceKind::kJoystick:
    case HapticDeviceKind::kCount: break;
  }
  return "Unnamed";
}

std::vector<HapticDeviceKind> all_kinds() {
  std::vector<HapticDeviceKind> kinds;
  for (int i = 0; i < static_cast<int>(HapticDeviceKind::kCount); ++i) {
    const auto kind = static_cast<HapticDeviceKind>(i);
    // There is one of each at a time, and their readings come when a thread of their own has
    // them, not by the clock of these tests: tests/unit/touch and tests/unit/comedi test those.
    if (kind == HapticDeviceKind::kTouch || kind == HapticDeviceKind::kJoystick) continue;
    kinds.push_back(kind);
  }
  return kinds;
}

INSTANTIATE_TEST_SUITE_P(Registry, HapticDeviceConformance, ::testing::ValuesIn(all_kinds()),
                         name_of);

}  // namespace
}  // namespace handrail
