// The stand-in for libHD, as the tests of the Touch reach it.
#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <functional>

#include "devices/touch/touch_device.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/support/touch/hd_stand_in.h"

namespace handrail::test {

class TouchBench : public ::testing::Test {
 protected:
  void SetUp() override {
    void* const library = ::dlopen(HANDRAIL_HD_STAND_IN, RTLD_NOW | RTLD_LOCAL);
    ASSERT_NE(library, nullptr) << ::dlerror();
    HdStandInOf of = nullptr;
    void* const found = ::dlsym(library, "hd_stand_in");
    std::memcpy(&of, &found, sizeof of);
    ASSERT_NE(of, nullptr);
    hd_ = of();
    hd_->reset();
    options.library = HANDRAIL_HD_STAND_IN;
  }
  // Whatever was done, it was done as the vendor's documentation allows.
  void TearDown() override {
    if (hd_ == nullptr) return;
    const std::lock_guard lock(hd_->mutex);
    EXPECT_EQ(hd_->misuses, std::vector<std::string>());
    EXPECT_EQ(hd_->open_devices, 0);
  }

  // Says something to the stand-in, or asks it.
  template <typename F>
  auto hd(F f) {
    const std::lock_guard lock(hd_->mutex);
    return f(static_cast<HdState&>(*hd_));
  }
  // Within ten seconds, a millisecond at a time.
  static bool becomes(const std::function<bool()>& what) {
    for (int i = 0; i < 10'000; ++i) {
      if (what()) return true;
      sleep_until(monotonic_now() + kMillisecond);
    }
    return false;
  }

  TouchOptions options;

 private:
  HdStandIn* hd_ = nullptr;
};

}  // namespace handrail::test
