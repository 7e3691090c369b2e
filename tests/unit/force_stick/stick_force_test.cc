// What a force-feedback joystick's motors are told, and when they are told nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "devices/force_stick/force_stick.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/support/fake_force_stick.h"
#include "tests/support/no_allocation.h"
#include "tests/support/read_bench.h"

namespace handrail {
namespace {

using test::FakeForceStick;

TEST(StickLevel, IsAShareOfFullScaleAlongTheKernelsDirection) {
  // linux/input.h: 0x8000 is up, 0xC000 is right.
  EXPECT_EQ(stick_level(0, 2.0, 4.0).direction, 0xC000);
  EXPECT_EQ(stick_level(1, 2.0, 4.0).direction, 0x8000);
  EXPECT_EQ(stick_level(0, 2.0, 4.0).level, 16384);
  EXPECT_EQ(stick_level(0, -2.0, 4.0).level, -16384);
  EXPECT_EQ(stick_level(1, 2.0, -4.0).level, -16384) << "it pushes the other way";
  EXPECT_EQ(stick_level(0, 4.0, 4.0).level, 32767);
  for (const double wild : {9.0, 1e300, 1e9}) {
    EXPECT_EQ(stick_level(0, wild, 4.0).level, 32767) << wild;
    EXPECT_EQ(stick_level(0, -wild, 4.0).level, -32767) << wild;
  }
  EXPECT_EQ(stick_level(0, 3.0, 0.0).level, 0) << "none is configured";
  EXPECT_EQ(stick_level(0, std::nan(""), 4.0).level, 0);
  EXPECT_EQ(stick_level(0, HUGE_VAL, 4.0).level, 0);
}

class StickForceTest : public test::ReadBench {
 protected:
  HapticDevice& read_device() override { return *device; }
  StickForceTest() {
    options.path = "/dev/input/event5";
    options.full = {4.0, 8.0};
    options.most_upload = 10.0;  // no upload is late, however slow this computer is
  }
  // The kernel outlives each thread that uses it.
  ~StickForceTest() override {
    device.reset();
    while (FeedbackThread::running() > 0) sleep_until(monotonic_now() + kMillisecond);
  }
  void open() {
    device = std::make_unique<ForceStick>(options, kernel);
    const Status opened = device->open();
    ASSERT_TRUE(opened) << opened.message();
    ASSERT_TRUE(while_pushed(Vec3::Zero(), [this] { return device->read(monotonic_now()).valid; }));
  }
  // As the haptic loop does, each millisecond, for ten seconds at most.
  bool while_pushed(const Vec3& force, const std::function<bool()>& until) {
    for (const Nanos end = monotonic_now() + 10 * kSecond; monotonic_now() < end;) {
      (void)device->read(monotonic_now());
      device->write({force, Vec3::Zero()});
      if (until()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  bool acts(double x, double y) {
    const auto is = kernel.push();
    return std::abs(is[0] - x) < 1e-4 && std::abs(is[1] - y) < 1e-4;
  }
  std::function<bool()> acting(double x, double y) {
    return [this, x, y] { return acts(x, y); };
  }

  FakeForceStick kernel;
  ForceStickOptions options;
  std::unique_ptr<ForceStick> device;
};

TEST_F(StickForceTest, ComesToItsShareOfFullScaleAndEndsWithTheLastWord) {
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_TRUE(kernel.effects().empty());
  ASSERT_TRUE(while_pushed({2.0, -2.0, 9.0}, acting(0.5, -0.25)));
  EXPECT_EQ(kernel.effects().size(), 2u) << "one an axis";
  for (const auto& [id, effect] : kernel.effects()) {
    EXPECT_EQ(effect.lasts, StickPusher::kStickForceLasts) << "should this program end here";
  }
  ASSERT_TRUE(while_pushed({-1.0, 0.0, 0.0}, acting(-0.25, 0.0)));
  ASSERT_TRUE(while_pushed({0.0, 0.0, 0.0}, acting(0.0, 0.0)));
  for (const auto& [id, effect] : kernel.effects()) {
    EXPECT_EQ(effect.level, 0);
    EXPECT_FALSE(effect.on);
  }
  EXPECT_EQ(kernel.was_set(FF_GAIN), 0xFFFF);
  EXPECT_EQ(kernel.was_set(FF_AUTOCENTER), 0);
  EXPECT_EQ(kernel.written_path(), "/dev/input/event5");
}

TEST_F(StickForceTest, ComesWithinHalfASecondAndNotAtOnce) {
  ASSERT_NO_FATAL_FAILURE(open());
  const Nanos began = monotonic_now();
  double least_time = 0.0;
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, [&] {
    // The most that can have come by now.
    const double most = to_seconds(monotonic_now() - began) / 0.5 + 0.02;
    EXPECT_LE(kernel.push()[0], most + 0.02);
    least_time = to_seconds(monotonic_now() - began);
    return acts(1.0, 0.0);
  }));
  EXPECT_GE(least_time, 0.45);
}

TEST_F(StickForceTest, WhatGoesOnIsPlayedAnewBeforeTheKernelEndsIt) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, acting(1.0, 0.0)));
  const auto plays = [this] { return kernel.effects().begin()->second.plays; };
  const int before = plays();
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, [&] { return plays() >= before + 4; }));
}

TEST_F(StickForceTest, ALoopThatStandsStillLeavesNoForceAndItBeginsAnew) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, acting(1.0, 0.0)));
  ASSERT_TRUE(comes(acting(0.0, 0.0)));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_TRUE(acts(0.0, 0.0)) << "it stays off";
  const Nanos began = monotonic_now();
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, acting(1.0, 0.0)));
  EXPECT_GE(to_seconds(monotonic_now() - began), 0.45);
}

TEST_F(StickForceTest, AForceThatIsNoNumberIsNone) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, acting(1.0, 0.0)));
  ASSERT_TRUE(while_pushed({std::nan(""), 1.0, 0.0}, acting(0.0, 0.0)));
}

TEST_F(StickForceTest, ClosingEndsItAndGivesTheSlotsBack) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(while_pushed({4.0, 8.0, 0.0}, acting(1.0, 1.0)));
  device->close();
  EXPECT_TRUE(kernel.effects().empty());
  EXPECT_EQ(kernel.erased(), 2);
  device->close();
  // Again and again, with no more slots than one device needs.
  kernel.slots(2);
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(device->open());
    ASSERT_TRUE(while_pushed({1.0, 1.0, 0.0}, [this] { return kernel.push()[1] > 0.0; })) << i;
    device->close();
  }
  EXPECT_EQ(device->pushed().refused, 0u);
}

TEST_F(StickForceTest, ASlowUploadKeepsNobodyWaiting) {
  kernel.slow(std::chrono::milliseconds(300));
  ASSERT_NO_FATAL_FAILURE(open());
  int turns = 0;
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, [&] { return ++turns, kernel.push()[0] > 0.0; }));
  // Far more turns than there would be with an upload in each.
  EXPECT_GT(turns, 20);
  const test::NoAllocation none("force stick");
  for (int i = 0; i < 1000; ++i) {
    (void)device->read(monotonic_now());
    device->write({Vec3(0.001 * i, 0.0, 0.0), Vec3::Zero()});
    (void)device->pushed();
  }
}

// It comes back when nobody is there any more, pushes nobody then, and gives the slot back.
TEST_F(StickForceTest, ClosingDoesNotWaitForAnUploadThatTheKernelHoldsUp) {
  kernel.slow(std::chrono::seconds(2));
  ASSERT_NO_FATAL_FAILURE(open());
  int turns = 0;
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, [&] { return ++turns > 100; }));
  device->close();
  EXPECT_EQ(kernel.erased(), 0) << "it is held up";
  // Opened again it is as ever, whatever becomes of the one before.
  kernel.slow(std::chrono::milliseconds(0));
  ASSERT_TRUE(device->open());
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, acting(1.0, 0.0)));
  device.reset();
  const int plays = kernel.plays();
  ASSERT_TRUE(comes([this] { return kernel.erased() == 2; }));
  EXPECT_EQ(kernel.plays(), plays);
  EXPECT_TRUE(kernel.effects().empty());
}

TEST_F(StickForceTest, AnUploadThatIsLaterThanIsReckonedWithLetsGo) {
  options.most_upload = 0.1;
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, acting(1.0, 0.0)));
  const auto late = device->pushed().late;
  kernel.slow(std::chrono::milliseconds(150));
  // The next change is late; the force begins anew after it, and is late again.
  ASSERT_TRUE(while_pushed({3.0, 0.0, 0.0}, [&] { return device->pushed().late >= late + 2; }));
  EXPECT_LT(kernel.push()[0], 0.5);
  kernel.slow(std::chrono::milliseconds(0));
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, acting(1.0, 0.0)));
}

TEST_F(StickForceTest, AnUploadThatWasRefusedIsTriedAgain) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, acting(1.0, 0.0)));
  kernel.refuse_uploads(1);
  ASSERT_TRUE(while_pushed({2.0, 0.0, 0.0}, [&] { return device->pushed().refused == 1; }));
  ASSERT_TRUE(while_pushed({2.0, 0.0, 0.0}, acting(0.5, 0.0)));
  EXPECT_EQ(device->pushed().refused, 1u);
  EXPECT_TRUE(device->pushed().there);
}

TEST_F(StickForceTest, AnEndThatWasRefusedAsALevelIsAnEndAndToldAgain) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, acting(1.0, 0.0)));
  kernel.refuse_uploads(1);
  ASSERT_TRUE(comes(acting(0.0, 0.0)));
  ASSERT_TRUE(comes([this] { return kernel.effects().begin()->second.level == 0; }));
  EXPECT_EQ(device->pushed().refused, 1u);
}

TEST_F(StickForceTest, AnUploadThatTookLongerThanItMayIsOneThatWasMade) {
  options.most_upload = 1e-9;  // none is in time
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, [this] { return device->pushed().late >= 3; }));
  EXPECT_LT(kernel.push()[0], 0.1);
  ASSERT_TRUE(comes(acting(0.0, 0.0)));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const StickPushed quiet = device->pushed();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(device->pushed().late, quiet.late) << "where nothing is uploaded nothing is late";
}

TEST_F(StickForceTest, PulledOutAndPluggedInAHundredTimes) {
  options.reopen_pause = kMillisecond;
  options.upload_period = 1e-3;
  ASSERT_NO_FATAL_FAILURE(open());
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, [this] { return kernel.push()[0] > 0.01; })) << i;
    kernel.pull_out();
    ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, [this] {
      return !device->read(monotonic_now()).valid;
    })) << i;
    EXPECT_TRUE(kernel.effects().empty()) << i;
    kernel.plug_in();
    bool began = false;
    ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, [&] {
      const double pushes = kernel.push()[0];
      if (pushes > 0.0 && !began) {
        began = true;
        EXPECT_LT(pushes, 0.5) << "it begins anew " << i;
      }
      return began;
    })) << i;
  }
  ASSERT_TRUE(while_pushed({4.0, 0.0, 0.0}, acting(1.0, 0.0)));
}

TEST_F(StickForceTest, WithoutANumberOrPermissionItMakesNoneAndReads) {
  const auto none = [this] {
    return while_pushed({4.0, 4.0, 0.0},
                        [this, until = monotonic_now() + 200 * kMillisecond] {
                          return !kernel.effects().empty() || monotonic_now() > until;
                        }) &&
           kernel.effects().empty();
  };
  options.full = {};
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_EQ(device->capabilities().max_force, 0.0);
  EXPECT_STREQ(device->capabilities().dynamics.source, "none: it makes no force");
  EXPECT_TRUE(none());
  EXPECT_EQ(kernel.was_set(FF_AUTOCENTER), -1) << "its centring is left as it is";
  options.full = {4.0, 8.0};
  kernel.make_motors(false);
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_TRUE(none());
  EXPECT_FALSE(device->pushed().there);
  kernel.make_motors();
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_FALSE(none());
}

}  // namespace
}  // namespace handrail
