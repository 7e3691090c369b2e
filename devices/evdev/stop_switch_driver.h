// The foot switch for `handrail devices`.
#pragma once

#include <string>

#include "devices/driver.h"
#include "devices/evdev/stop_switch.h"

namespace handrail {

class StopSwitchDriver final : public Driver {
 public:
  // `options.path` may be empty: none is configured.
  explicit StopSwitchDriver(const StopSwitchOptions& options,
                            std::string input_folder = kInputFolder,
                            EvdevKernel& kernel = evdev_kernel())
      : options_(options), input_folder_(std::move(input_folder)), kernel_(kernel) {}

  std::string what() const override { return "foot switch or key that stops the arm"; }
  std::string daemon() const override { return "handrail-slave"; }
  // The configured one, else whatever has keys: which of them is a foot switch the kernel does not
  // say.
  std::vector<Sighting> probe() override;
  // Grabs nothing, so that the keyboard at which this is typed goes on.
  StartedTest test(const TestWishes& wishes) override;
  // Learns the key.
  StartedTest calibrate() override;

 private:
  std::vector<std::string> candidates() const;
  Result<std::string> one_path() const;
  Sighting look_at(const std::string& path) const;

  StopSwitchOptions options_;
  std::string input_folder_;
  EvdevKernel& kernel_;
};

}  // namespace handrail
