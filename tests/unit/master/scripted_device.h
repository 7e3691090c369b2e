// A haptic device that says what the test wants and remembers what it was told.
#pragma once

#include <functional>

#include "devices/haptic_device.h"

namespace handrail {

class ScriptedDevice : public HapticDevice {
 public:
  class Hand : public SteerableHand {
   public:
    void steer(const HandIntent& intent) noexcept override {
      last = intent;
      ++orders;
    }
    bool moving() const noexcept override {
      if (on_moving) on_moving();
      return is_moving;
    }

    HandIntent last;
    int orders = 0;
    bool is_moving = false;
    std::function<void()> on_moving;
  };

  ScriptedDevice() {
    capabilities_.name = "scripted device";
    capabilities_.max_force = 3.3;
    capabilities_.continuous_force = 0.88;
    sample.valid = true;
  }
  const HapticCapabilities& capabilities() const override { return capabilities_; }
  Status open() override { return Status::ok(); }
  HapticSample read(Nanos now) noexcept override {
    read_at = now;
    ++reads;
    return sample;
  }
  DeviceTrouble trouble() const noexcept override { return its_trouble; }
  void lead(const CursorSample& cursor) noexcept override { led_to = cursor; }
  void write(const Wrench& f_H_M) noexcept override {
    written = f_H_M;
    ++writes;
  }
  void feel(const HapticCue& cue) noexcept override {
    felt = cue;
    ++feels;
  }
  void close() noexcept override {}
  void simulate(const DeviceEffects&, const Vec3& start) noexcept override {
    simulated_from = start;
    ++simulations;
  }
  SteerableHand* hand() noexcept override { return has_hand ? &its_hand : nullptr; }

  HapticSample sample;
  DeviceTrouble its_trouble{};
  CursorSample led_to;
  Hand its_hand;
  bool has_hand = true;
  Nanos read_at = -1;
  int reads = 0;
  int writes = 0;
  Wrench written;
  HapticCue felt;
  int feels = 0;
  int simulations = 0;
  Vec3 simulated_from = Vec3::Zero();

  void set_led_by_cursor() { capabilities_.led_by_cursor = true; }

 private:
  HapticCapabilities capabilities_;
};

}  // namespace handrail
