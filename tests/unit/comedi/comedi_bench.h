// The stand-in for libcomedi, as the tests of its devices reach it.
#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "devices/comedi/comedi_card.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/support/comedi/comedi_stand_in.h"

namespace handrail::test {

class ComediBench : public ::testing::Test {
 protected:
  void SetUp() override {
    void* const library = ::dlopen(HANDRAIL_COMEDI_STAND_IN, RTLD_NOW | RTLD_LOCAL);
    ASSERT_NE(library, nullptr) << ::dlerror();
    ComediStandInOf of = nullptr;
    void* const found = ::dlsym(library, "comedi_stand_in");
    std::memcpy(&of, &found, sizeof of);
    ASSERT_NE(of, nullptr);
    card_ = of();
    card_->reset();
    place.library = HANDRAIL_COMEDI_STAND_IN;
  }
  // Whatever was done, it was done as libcomedi and the kernel allow.
  void TearDown() override {
    if (card_ == nullptr) return;
    const std::lock_guard lock(card_->mutex);
    EXPECT_EQ(card_->misuses, std::vector<std::string>());
    EXPECT_EQ(card_->open_devices, 0);
    EXPECT_EQ(card_->locks, 0);
  }

  // Says something to the stand-in, or asks it.
  template <typename F>
  auto card(F f) {
    const std::lock_guard lock(card_->mutex);
    return f(static_cast<ComediState&>(*card_));
  }
  // Within ten seconds, a millisecond at a time.
  static bool becomes(const std::function<bool()>& what) {
    for (int i = 0; i < 10'000; ++i) {
      if (what()) return true;
      sleep_until(monotonic_now() + kMillisecond);
    }
    return false;
  }

  // A JR3 as jr3_pci has it: full scales 200, 200, 400 N and 12, 12, 10 N m; forces in kN, moments
  // in kN m. Nothing pushes.
  static StandInSubdevice jr3(double force_x = 0.2) {
    StandInSubdevice out;
    out.type = 1;
    out.max_data = 0x7fff;
    out.unit = 2;
    out.values.assign(58, 16384);
    const double full[8] = {force_x, 0.2, 0.4, 0.012, 0.012, 0.01, 1.0, 1.0};
    for (unsigned int i = 0; i < 56; ++i) out.channel_max[i] = full[i % 8];
    return out;
  }
  // A card such as the joystick's: 16 bits analog in and out, 24-bit counters, digital inputs.
  static std::vector<StandInSubdevice> multi() {
    StandInSubdevice in, out, digital, counter;
    in.type = 1;
    in.values.assign(8, 32768);
    out.type = 2;
    out.values.assign(4, 50000);  // what was left there
    digital.type = 5;
    digital.max_data = 1;
    digital.values.assign(8, 1);
    counter.type = 6;
    counter.max_data = 0xffffff;
    counter.values.assign(6, 0);
    return {in, out, digital, counter};
  }

  ComediPlace place;

 private:
  ComediStandIn* card_ = nullptr;
};

}  // namespace handrail::test
