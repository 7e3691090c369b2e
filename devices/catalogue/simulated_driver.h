// A simulated device for `handrail devices`: nothing is plugged in, and a simulated hand holds it.
#pragma once

#include <string>

#include "devices/driver.h"
#include "devices/registry.h"

namespace handrail {

class SimulatedDriver final : public Driver {
 public:
  // `kind` as the master's configuration calls it, "SIM_OMNI".
  SimulatedDriver(HapticDeviceOptions options, std::string kind, std::string what)
      : options_(std::move(options)), kind_(std::move(kind)), what_(std::move(what)) {}

  std::string what() const override { return what_; }
  std::string daemon() const override { return "handrail-master"; }
  std::vector<Sighting> probe() override;
  StartedTest test(const TestWishes& wishes) override;
  StartedTest calibrate() override;

 private:
  std::string block() const;

  HapticDeviceOptions options_;
  std::string kind_, what_;
};

}  // namespace handrail
