// The Touch and a loop that turns as it does.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "devices/touch/touch_device.h"
#include "server/base/units.h"
#include "tests/unit/touch/touch_bench.h"

namespace handrail {
namespace {

using test::HdState;

// As the master's loop, which pushes by 0.1 N for a millimetre to the right.
class TouchLoopTest : public test::TouchBench {
 protected:
  void open() {
    device = std::make_unique<TouchDevice>(options);
    const Status opened = device->open();
    ASSERT_TRUE(opened) << opened.message();
  }
  void TearDown() override {
    device.reset();
    TouchBench::TearDown();
  }
  // Returns how often the force came too late, as the device says.
  int run(int ticks, Nanos step_takes = 0) {
    int missed = 0;
    Nanos due = monotonic_now();
    for (int i = 0; i < ticks; ++i) {
      due = device->wait(due) + kMillisecond;
      last_ = monotonic_now();
      const HapticSample sample = device->read(last_);
      missed += sample.force_missed ? 1 : 0;
      own_clock_ += device->tick().ticks == seen_ ? 1 : 0;
      skipped_ += device->tick().ticks > seen_ + 1 ? device->tick().ticks - seen_ - 1 : 0;
      seen_ = device->tick().ticks;
      const double x = sample.valid ? sample.X_MH.p.x() / kMm : 0.0;
      if (step_takes > 0) sleep_until(monotonic_now() + step_takes);
      device->write({Vec3(0.1 * x, 0.0, 0.0), Vec3::Zero()});
      hd([&](HdState& s) { s.target[0] = std::sin(0.05 * i); });
    }
    return missed;
  }
  void begin_count() {
    hd([](HdState& s) { s.answered = s.answered_late = s.unanswered = 0; });
    own_clock_ = 0;
    skipped_ = 0;
  }
  struct Count {
    std::uint64_t in_turn, late, other;
  };
  Count count() {
    return hd([](HdState& s) { return Count{s.answered, s.answered_late, s.unanswered}; });
  }

  std::unique_ptr<TouchDevice> device;
  Nanos last_ = 0;
  int own_clock_ = 0;
  std::uint64_t seen_ = 0, skipped_ = 0;  // turns, as this thread had to wait
};

TEST_F(TouchLoopTest, AForceActsInTheTurnOfItsReading) {
  ASSERT_NO_FATAL_FAILURE(open());
  (void)run(100);
  begin_count();
  const int missed = run(1000);
  const Count of = count();
  EXPECT_GT(of.in_turn, 0u);
  // None came late that was not counted; the newest is not known yet.
  EXPECT_LE(of.late + of.other, static_cast<std::uint64_t>(missed + own_clock_) + skipped_ + 2);
  RecordProperty("in_turn", static_cast<int>(of.in_turn));
}

TEST_F(TouchLoopTest, AStepThatTakesTooLongPushesATurnLateAndIsCounted) {
  ASSERT_NO_FATAL_FAILURE(open());
  (void)run(100, 500 * kMicrosecond);
  begin_count();
  const int missed = run(500, 500 * kMicrosecond);
  const Count of = count();
  EXPECT_GT(of.late, 0u);
  EXPECT_LT(of.in_turn, of.late);
  EXPECT_GT(missed, 0);
}

TEST_F(TouchLoopTest, WhileTheDevicePausesTheLoopGoesOn) {
  ASSERT_NO_FATAL_FAILURE(open());
  hd([](HdState& s) { s.stalls = 50; });
  (void)run(1000);
  EXPECT_GT(own_clock_, 20);  // some 18 of each pause
  hd([](HdState& s) { s.stalls = 0, s.turns = false; });
  ASSERT_TRUE(becomes([&] { return !device->read(monotonic_now()).valid; }));
  const int before = own_clock_;
  (void)run(100);
  EXPECT_GE(own_clock_ - before, 100);
  EXPECT_EQ(hd([](HdState& s) { return s.most_force > 3.3 + 1e-9; }), false);
}

}  // namespace
}  // namespace handrail
