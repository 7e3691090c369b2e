// Any haptic device, looked at: readings, directions, buttons and, on request, force.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/driver.h"
#include "devices/haptic_device.h"

namespace handrail {

// Asks for one thing after the other: leave it alone, move it right, up and toward you, turn it the
// same three ways, press each button; with a force, hold it loosely while it is pushed the three
// ways, up to that force in a second and back. What is not done within 15 s is not seen. A
// simulated hand does it all by itself; a recording cannot be asked.
//
// The force is at most what the device sustains, and ends at once when it has been pushed half of
// its work space, or is faster than 0.5 m/s. Deterministic for the same readings.
class HandTest final : public SelfTest {
 public:
  // `device` is open. `block`: what block() is to say. `turns`: about which axes it can be turned,
  // if it senses that.
  HandTest(std::unique_ptr<HapticDevice> device, const TestWishes& wishes, std::string block,
           const std::array<bool, 3>& turns = {true, true, true});
  ~HandTest() override { device_->close(); }

  bool turn(Nanos now) override;
  std::string asks() const override;
  std::vector<TestItem> items() const override;
  std::string block() const override { return block_; }

 private:
  enum class Kind : std::uint8_t { kStill, kMove, kTurn, kButton, kForce };
  struct Step {
    Kind kind;
    int which;  // axis 0 to 2, or the button's number from 0 on
  };

  void plan(const TestWishes& wishes, const std::array<bool, 3>& turns);
  void note(const HapticSample& sample, Nanos now);
  bool settled(const HapticSample& sample, Nanos now);
  void begin_step(const HapticSample& sample, Nanos now);
  void steer_hand();
  void step(const HapticSample& sample, Nanos now);
  std::string request() const;
  void step_still(const HapticSample& sample, Nanos now);
  void step_way(const HapticSample& sample, Nanos now);
  void step_button(const HapticSample& sample);
  void step_force(const HapticSample& sample, Nanos now);
  void end_step(Verdict verdict, std::string fact, std::string next);
  TestItem readings() const;
  TestItem rate() const;

  std::unique_ptr<HapticDevice> device_;
  std::string block_;
  double force_ = 0.0;  // asked for, and sustained [N]
  std::vector<Step> steps_;
  std::size_t now_at_ = 0;  // of steps_
  std::vector<TestItem> done_;
  std::string lost_;  // why it ended early; empty: it did not

  // Readings.
  bool started_ = false;
  Nanos last_ = 0, valid_at_ = 0;
  std::uint64_t all_ = 0, invalid_ = 0;
  HapticSample before_;
  double moving_s_ = 0.0;  // for how long it moved [s]
  std::uint64_t while_moving_ = 0, new_ones_ = 0;

  // Of the present step.
  bool armed_ = false;  // the device has come to rest
  Nanos step_began_ = 0, quiet_since_ = 0;
  Pose origin_;
  Vec3 least_ = Vec3::Zero(), most_ = Vec3::Zero();  // of the place while left alone [m]
  Vec3 pushed_ = Vec3::Zero();                       // what is written [N]
  Nanos push_ended_ = kForever;                      // when it began to fade
  double last_push_ = 0.0;                           // what fades [N]
  Vec3 gave_way_ = Vec3::Zero();                     // by how much, when the push was over [m]
};

}  // namespace handrail
