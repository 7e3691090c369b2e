#include "devices/evdev/rumble.h"

#include <gtest/gtest.h>

#include <functional>

#include "devices/evdev/gamepad_device.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/support/fake_gamepad.h"
#include "tests/support/no_allocation.h"
#include "tests/support/read_bench.h"

namespace handrail {
namespace {

using test::FakeGamepad;

TEST(RumbleOf, EachCauseHasItsMotorsAndNoneMoreThanItsShare) {
  EXPECT_EQ(rumble_of({Felt::kContact, 1.0}, 1.0), (RumbleStrength{65535, 0}));
  EXPECT_EQ(rumble_of({Felt::kContact, 0.5}, 0.5), (RumbleStrength{16384, 0}));
  EXPECT_EQ(rumble_of({Felt::kLimit, 1.0}, 0.5), (RumbleStrength{32768, 0}));
  EXPECT_EQ(rumble_of({Felt::kHold, 1.0}, 0.5), (RumbleStrength{0, 32768}));
  EXPECT_EQ(rumble_of({Felt::kSingularity, 1.0}, 0.5), (RumbleStrength{0, 32768}));
  EXPECT_EQ(rumble_of({Felt::kLost, 1.0}, 0.5), (RumbleStrength{32768, 32768}));
  EXPECT_TRUE(rumble_of({Felt::kNothing, 1.0}, 1.0).off());
  // Whatever is asked for.
  for (const double wild : {7.0, 1e300, HUGE_VAL}) {
    EXPECT_EQ(rumble_of({Felt::kContact, wild}, wild), (RumbleStrength{65535, 0})) << wild;
  }
  for (const double none : {0.0, -1.0, std::nan("")}) {
    EXPECT_TRUE(rumble_of({Felt::kLost, none}, 1.0).off()) << none;
    EXPECT_TRUE(rumble_of({Felt::kLost, 1.0}, none).off()) << none;
  }
}

class RumbleTest : public test::ReadBench {
 protected:
  HapticDevice& read_device() override { return *device; }
  using Motors = FakeGamepad::Motors;

  RumbleTest() { kernel.make_pad(); }
  // The kernel outlives each thread that uses it.
  ~RumbleTest() override {
    device.reset();
    while (FeedbackThread::running() > 0) sleep_until(monotonic_now() + kMillisecond);
  }
  void open(double share = 0.5) {
    GamepadOptions options;
    options.path = "/dev/input/event5";
    options.rumble_share = share;
    device = std::make_unique<GamepadDevice>(options, kernel);
    ASSERT_TRUE(device->open());
    ASSERT_TRUE(while_felt({}, [this] { return device->read(monotonic_now()).valid; }));
  }
  // As the haptic loop does, each millisecond, for ten seconds at most.
  bool while_felt(const HapticCue& cue, const std::function<bool()>& until) {
    for (const Nanos end = monotonic_now() + 10 * kSecond; monotonic_now() < end;) {
      (void)device->read(monotonic_now());
      device->feel(cue);
      if (until()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  bool on() { return !kernel.motors().empty() && kernel.motors().back().on; }
  bool off() { return !kernel.motors().empty() && !kernel.motors().back().on; }

  FakeGamepad kernel;
  std::unique_ptr<GamepadDevice> device;
  const HapticCue contact{Felt::kContact, 1.0};
};

TEST_F(RumbleTest, WhatIsFeltIsPlayedAndEndsWithIt) {
  kernel.make_motors();
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_EQ(kernel.uploads(), 0);
  ASSERT_TRUE(while_felt(contact, [this] { return on(); }));
  EXPECT_EQ(kernel.written_path(), "/dev/input/event5");
  const Motors told = kernel.motors().back();
  EXPECT_EQ(told.strong, 32768);
  EXPECT_EQ(told.weak, 0);
  // Should this program end here, the kernel ends it.
  EXPECT_EQ(told.lasts, Rumble::kRumbleLasts);
  ASSERT_TRUE(while_felt({}, [this] { return off(); }));
}

TEST_F(RumbleTest, WhatGoesOnIsPlayedAnewBeforeTheKernelEndsIt) {
  kernel.make_motors();
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(while_felt(contact, [this] { return kernel.motors().size() >= 4; }));
  for (const Motors& told : kernel.motors()) EXPECT_TRUE(told.on);
}

TEST_F(RumbleTest, ALoopThatStandsStillLeavesNothingOnTheHand) {
  kernel.make_motors();
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(while_felt(contact, [this] { return on(); }));
  // Nobody calls any more.
  ASSERT_TRUE(comes([this] { return off(); }));
  const std::size_t told = kernel.motors().size();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(kernel.motors().size(), told) << "it stays off";
  ASSERT_TRUE(while_felt(contact, [this] { return on(); }));
}

TEST_F(RumbleTest, ClosingEndsIt) {
  kernel.make_motors();
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(while_felt(contact, [this] { return on(); }));
  device->close();
  EXPECT_TRUE(off());
  device->close();
}

TEST_F(RumbleTest, ClosingDoesNotWaitForAnUploadThatTheKernelHoldsUp) {
  kernel.make_motors();
  kernel.slow(std::chrono::seconds(2));
  ASSERT_NO_FATAL_FAILURE(open());
  int turns = 0;
  ASSERT_TRUE(while_felt(contact, [&] { return ++turns > 100; }));
  device->close();
  EXPECT_TRUE(kernel.motors().empty()) << "it is held up";
  device.reset();
  ASSERT_TRUE(comes([] { return FeedbackThread::running() == 0; }));
  EXPECT_FALSE(kernel.motors().empty());
  for (const Motors& told : kernel.motors()) EXPECT_FALSE(told.on) << "nobody is there";
}

TEST_F(RumbleTest, ASlowUploadKeepsNobodyWaiting) {
  kernel.make_motors();
  kernel.slow(std::chrono::milliseconds(400));
  ASSERT_NO_FATAL_FAILURE(open());
  int turns = 0;
  ASSERT_TRUE(while_felt(contact, [&] { return ++turns, on(); }));
  // Far more turns than there would be with one upload in each.
  EXPECT_GT(turns, 20);
  const test::NoAllocation none("feel");
  for (int i = 0; i < 1000; ++i) device->feel({Felt::kContact, 0.001 * i});
}

TEST_F(RumbleTest, PluggedInAgainItIsFeltAgain) {
  kernel.make_motors();
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(while_felt(contact, [this] { return on(); }));
  kernel.unplug();
  ASSERT_TRUE(while_felt(contact, [this] { return !device->read(monotonic_now()).valid; }));
  ASSERT_TRUE(while_felt(contact, [this] { return off(); }));
  kernel.forget_effects();
  kernel.refuse(0);
  ASSERT_TRUE(while_felt(contact, [this] { return on(); }));
}

TEST_F(RumbleTest, WithoutMotorsOrPermissionOrShareItStaysStillAndDrives) {
  const auto still = [this] {
    return !while_felt(contact, [this, until = monotonic_now() + 200 * kMillisecond] {
      return kernel.uploads() > 0 || monotonic_now() > until;
    }) || kernel.uploads() == 0;
  };
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_TRUE(still()) << "no motors";
  kernel.make_motors(false);
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_TRUE(still()) << "no permission";
  kernel.make_motors();
  ASSERT_NO_FATAL_FAILURE(open(0.0));
  EXPECT_TRUE(still()) << "no share";
  EXPECT_TRUE(device->read(monotonic_now()).valid);
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_FALSE(still());
}

}  // namespace
}  // namespace handrail
