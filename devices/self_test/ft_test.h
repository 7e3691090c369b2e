// Any force sensor, looked at: records, noise, load and directions.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "devices/driver.h"
#include "devices/ft_sensor.h"

namespace handrail {

// Two seconds left alone: how many records come, how many the sensor's own counter misses, whether
// it reports a fault, noise and load. Then somebody presses the tip along each axis, with 3 N or
// more; what is not done within 15 s is not seen. Deterministic for the same records.
class FtTest final : public SelfTest {
 public:
  // `sensor` is started. `block`: what block() is to say.
  FtTest(std::unique_ptr<FtSensor> sensor, const TestWishes& wishes, std::string block);
  ~FtTest() override { sensor_->stop(); }

  bool turn(Nanos now) override;
  std::string asks() const override;
  std::vector<TestItem> items() const override;
  std::string block() const override { return block_; }

 private:
  using Six = Eigen::Matrix<double, 6, 1>;

  void rest(const FtSample& sample);
  void press(const FtSample& sample, Nanos now);
  void end_press(Verdict verdict, std::string fact, std::string next, Nanos now);
  TestItem records() const;
  TestItem status() const;
  TestItem at_rest() const;
  Six mean() const { return sum_ / static_cast<double>(resting_); }

  std::unique_ptr<FtSensor> sensor_;
  std::string block_;
  bool alone_ = false;
  bool started_ = false;
  bool silent_ = false;  // no record came
  Nanos began_ = 0, phase_began_ = 0;
  int phase_ = 0;       // 0: at rest; 1 to 3: pressed along an axis; 4: over
  bool let_go_ = true;  // since the last press
  // At rest.
  std::uint64_t resting_ = 0, missed_ = 0;
  std::uint32_t newest_ = 0;
  Nanos first_at_ = 0, last_at_ = 0;
  Six sum_ = Six::Zero(), squares_ = Six::Zero();  // [N, N m]
  // Ever.
  std::uint64_t faults_ = 0;
  std::uint32_t fault_ = 0;
  std::vector<TestItem> done_;
};

}  // namespace handrail
