// The 2-DOF joystick, over a stand-in for libcomedi, as its tests reach it.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "devices/comedi/comedi_joystick.h"
#include "devices/driver.h"
#include "tests/unit/comedi/comedi_bench.h"

namespace handrail::test {

class JoystickBench : public ComediBench {
 protected:
  void SetUp() override {
    ComediBench::SetUp();
    options.place = place;
    options.homing = StickHoming::kCentre;
    card([](ComediState& s) {
      s.driver = "s626";
      s.board = "s626";
      s.subdevices = multi();
    });
  }
  void TearDown() override {
    device.reset();
    test.reset();
    // Whatever became of it, nothing pushes.
    if (opened) {
      EXPECT_EQ(volts(0), 0.0);
      EXPECT_EQ(volts(1), 0.0);
    }
    ComediBench::TearDown();
  }
  void open() {
    device = std::make_unique<ComediJoystick>(options);
    const Status done = device->open();
    ASSERT_TRUE(done) << done.message();
    opened = true;
  }
  std::string open_error() {
    ComediJoystick fails(options);
    return fails.open().message();
  }
  HapticSample read() { return device->read(monotonic_now()); }
  bool valid(bool wanted = true) {
    return becomes([&] { return read().valid == wanted; });
  }
  // All at once. 2122 counts are 200 mm at the tip.
  void leap(int motor, int counts) {
    card([&](ComediState& s) {
      s.subdevices[3].values[static_cast<std::size_t>(motor)] =
          static_cast<unsigned int>(counts) & 0xffffff;
    });
    at_[static_cast<std::size_t>(motor)] = counts;
  }
  // Whether a leap from the centre loses the card at once. If it does not, the tip is back there.
  bool leap_is_seen(int motor, int counts) {
    leap(motor, counts);
    for (int i = 0; i < 100; ++i) {
      (void)read();
      if (device->tick().losses == 1) return true;
      sleep_until(monotonic_now() + kMillisecond);
    }
    turn(motor, 0);
    return false;
  }
  // As a hand does, which passes each count: one in 0.1 ms or more is 0.94 m/s or less.
  void turn(int motor, int counts) {
    int& at = at_[static_cast<std::size_t>(motor)];
    while (at != counts) {
      leap(motor, at + (at < counts ? 1 : -1));
      sleep_until(monotonic_now() + 100 * kMicrosecond);
    }
  }
  bool comes_to(const Vec3& p_M) {
    return becomes([&] { return read().X_MH.p.isApprox(p_M, 1e-5); });
  }
  std::string trouble() { return std::string(text_of(device->trouble())); }
  // At the output, to the nearest of its 65536 steps.
  double volts(std::size_t channel) {
    const unsigned int raw = card([&](ComediState& s) { return s.subdevices[1].values[channel]; });
    return raw == 32768 ? 0.0 : -10.0 + 20.0 * raw / 65535.0;
  }
  // Keeps writing until the output is so.
  bool pushes(std::size_t channel, double wanted, const Vec3& written) {
    return becomes([&] {
      device->write({written, Vec3::Zero()});
      return std::abs(volts(channel) - wanted) < 2e-4;
    });
  }

  ComediJoystickOptions options;
  std::unique_ptr<ComediJoystick> device;
  std::unique_ptr<SelfTest> test;
  bool opened = false;

 private:
  std::array<int, 2> at_{};
};

}  // namespace handrail::test
