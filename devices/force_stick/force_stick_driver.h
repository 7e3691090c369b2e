// The force-feedback joystick or wheel for `handrail devices`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "devices/driver.h"
#include "devices/force_stick/force_stick.h"
#include "devices/self_test/hand_test.h"

namespace handrail {

class ForceStickDriver final : public Driver {
 public:
  explicit ForceStickDriver(const ForceStickOptions& options, EvdevKernel& kernel = evdev_kernel())
      : options_(options), kernel_(kernel) {}

  std::string what() const override { return "force-feedback joystick or wheel, by the kernel"; }
  std::string daemon() const override { return "handrail-master"; }
  // The configured one, else all that take constant forces.
  std::vector<Sighting> probe() override;
  StartedTest test(const TestWishes& wishes) override;
  // Finds how long an upload takes. Nothing of it is felt.
  StartedTest calibrate() override;

 private:
  ForceStickOptions options_;
  EvdevKernel& kernel_;
};

// Looked at as any haptic device, and how long its uploads took.
class ForceStickTest final : public SelfTest {
 public:
  // `device` is open.
  ForceStickTest(std::unique_ptr<ForceStick> device, const TestWishes& wishes,
                 const ForceStickOptions& options);

  bool turn(Nanos now) override;
  std::string asks() const override { return test_.asks(); }
  std::vector<TestItem> items() const override;
  std::string block() const override { return test_.block(); }

 private:
  ForceStick* device_;  // test_ owns it
  HandTest test_;
  ForceStickOptions options_;
  StickPushed pushed_;
};

// Uploads a force that is none, a few hundred times.
class ForceStickTiming final : public SelfTest {
 public:
  // `device` is closed by it.
  ForceStickTiming(const EvdevOpened& device, const ForceStickOptions& options,
                   EvdevKernel& kernel);
  ~ForceStickTiming() override;

  Nanos period() const override { return from_seconds(options_.upload_period); }
  bool turn(Nanos now) override;
  std::string asks() const override { return {}; }
  std::vector<TestItem> items() const override;
  std::string block() const override;

 private:
  Nanos longest() const;  // but for one in a hundred

  ForceStickOptions options_;
  EvdevOpened device_;
  ForceFeedback motors_;
  std::array<ff_effect, 2> effects_{};
  bool may_write_ = false, refused_ = false;
  std::vector<Nanos> took_;
};

}  // namespace handrail
