// The Touch for `handrail devices`.
#pragma once

#include <string>
#include <utility>

#include "devices/driver.h"
#include "devices/input/usb_scan.h"
#include "devices/touch/touch_device.h"

namespace handrail {

class TouchDriver final : public Driver {
 public:
  // `dev_folder`: where the kernel has its serial ports.
  explicit TouchDriver(const TouchOptions& options, std::string usb_folder = kUsbFolder,
                       std::string dev_folder = "/dev")
      : options_(options), usb_folder_(std::move(usb_folder)), dev_folder_(std::move(dev_folder)) {}

  std::string what() const override { return "Touch or Phantom Omni of 3D Systems, by libHD"; }
  std::string daemon() const override { return "handrail-master"; }
  // Looks for one on USB, for its port's permission, and for the vendor's library, which is loaded.
  std::vector<Sighting> probe() override;
  StartedTest test(const TestWishes& wishes) override;
  // Homes it.
  StartedTest calibrate() override;

 private:
  StartedTest start(const std::optional<TestWishes>& wishes) const;
  Sighting on_usb() const;

  TouchOptions options_;
  std::string usb_folder_, dev_folder_;
};

}  // namespace handrail
