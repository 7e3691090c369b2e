// A force sensor at a card for `handrail devices`.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "devices/comedi/comedi_ft_sensor.h"
#include "devices/driver.h"
#include "devices/ft_role.h"
#include "devices/self_test/ft_test.h"

namespace handrail {

class ComediFtDriver final : public Driver {
 public:
  explicit ComediFtDriver(const ComediFtOptions& options, FtRole role = {})
      : options_(options), role_(std::move(role)) {}

  std::string what() const override {
    return role_.driver.empty() ? "force sensor at a card (JR3, or six voltages)"
                                : "force sensor on the handle (RDT, JR3, or six voltages)";
  }
  std::string daemon() const override { return role_.daemon(); }
  // Opens the card, and waits for a reading for 0.3 s.
  std::vector<Sighting> probe() override;
  StartedTest test(const TestWishes& wishes) override;
  // JR3: reads its full scale. Six voltages: what they are without any force.
  StartedTest calibrate() override;

 private:
  ComediFtOptions options_;
  FtRole role_;
};

// Waits up to 25 s until the sensor has settled; then an FtTest.
class ComediFtTrial final : public SelfTest {
 public:
  // `sensor` is started.
  ComediFtTrial(std::unique_ptr<ComediFtSensor> sensor, const TestWishes& wishes,
                std::string block);

  bool turn(Nanos now) override;
  std::string asks() const override;
  std::vector<TestItem> items() const override;
  std::string block() const override { return block_; }

 private:
  std::unique_ptr<ComediFtSensor> own_;  // until it has settled
  ComediFtSensor* sensor_;
  std::unique_ptr<FtTest> test_;  // owns it then
  TestWishes wishes_;
  std::string block_;
  bool started_ = false, gave_up_ = false;
  Nanos began_ = 0;
};

// What a card tells about its sensor.
class ComediFtCalibration final : public SelfTest {
 public:
  // `sensor` is started: of a JR3; or one whose readings are the voltages themselves.
  ComediFtCalibration(std::unique_ptr<ComediFtSensor> sensor, const ComediFtOptions& options,
                      const FtRole& role = {})
      : sensor_(std::move(sensor)), options_(options), role_(role) {}

  bool turn(Nanos now) override;
  std::string asks() const override;
  std::vector<TestItem> items() const override;
  std::string block() const override;

 private:
  bool enough() const;

  std::unique_ptr<ComediFtSensor> sensor_;
  ComediFtOptions options_;
  FtRole role_;
  bool started_ = false, gave_up_ = false;
  Nanos began_ = 0;
  int count_ = 0;
  FtSix sum_ = FtSix::Zero();
  FtSix least_ = FtSix::Zero(), most_ = FtSix::Zero();
};

}  // namespace handrail
