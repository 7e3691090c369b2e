// A Touch, homed and then looked at as any haptic device.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/driver.h"
#include "devices/self_test/hand_test.h"
#include "devices/touch/touch_device.h"

namespace handrail {

// Waits up to 60 s until the device is homed, saying what the person has to do for it; then a
// HandTest, unless it is only to be homed. Besides, what the vendor's library tells: rate of its
// servo thread, heat of the motors, errors.
class TouchTrial final : public SelfTest {
 public:
  // `device` is open. No `wishes`: it is only homed.
  TouchTrial(std::unique_ptr<TouchDevice> device, const std::optional<TestWishes>& wishes,
             std::string block);

  bool turn(Nanos now) override;
  std::string asks() const override;
  std::vector<TestItem> items() const override;
  std::string block() const override { return block_; }

 private:
  const TouchTick& tick() const { return device_->tick(); }
  bool homed(Nanos now);
  TestItem homing() const;
  std::optional<TestItem> servo() const;
  bool frozen(const std::vector<TestItem>& seen) const;
  TestItem heat() const;
  TestItem errors() const;

  std::unique_ptr<TouchDevice> own_;  // until it is homed
  TouchDevice* device_;
  std::unique_ptr<HandTest> test_;  // owns it then
  std::optional<TestWishes> wishes_;
  std::string block_;
  std::string identity_;
  bool started_ = false, gave_up_ = false;
  Nanos began_ = 0;
  TouchTick first_;
  HdError worst_;  // the newest that was not none
  double hottest_ = 0.0;
  std::uint64_t most_frozen_ = 0;
};

}  // namespace handrail
