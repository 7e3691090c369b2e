// A haptic device that a test reads, by a clock of its own.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <thread>

#include "devices/haptic_device.h"

namespace handrail::test {

class ReadBench : public ::testing::Test {
 protected:
  // The one that is read.
  virtual HapticDevice& read_device() = 0;

  // A millisecond later.
  HapticSample read() { return read_device().read(now += kMillisecond); }
  HapticSample after(double seconds) {
    HapticSample out;
    for (const Nanos until = now + from_seconds(seconds); now < until;) out = read();
    return out;
  }
  // Valid or not, for at most ten seconds of real time.
  bool becomes(bool valid) {
    return comes([this, valid] { return read().valid == valid; });
  }
  // The same of anything else, looked at each millisecond.
  static bool comes(const std::function<bool()>& condition) {
    for (int i = 0; i < 10'000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  Nanos now = kSecond;
};

}  // namespace handrail::test
